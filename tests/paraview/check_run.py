"""Opens a run folder with ParaView's own Python, as a user of ParaView would.

    xvfb-run -a pvpython check_run.py RUN [PICTURES]

Shows that every frame of design/iterations.pvd, design/fields.pvd, design/components.pvd and
motion/motion.pvd can be read, as far as the run has them: a design where there is a history.csv, a motion where there is a
motion.csv, a path of equilibria where there is a path.csv. The design has one frame per row of
history.csv, the motion starts and ends with its table; fields have their names, finite values, and
densities in [0, 1]; and both can be drawn: PICTURES/design.png and PICTURES/motion.png (default:
RUN_pictures, beside the run: a folder in it would keep the next run from taking its place).

Exit code 0 when all of that holds; 1, with every defect named, when not. run.sh beside this file
gets ParaView and calls it.
"""

import csv
import os
import sys
from collections import Counter
from xml.etree import ElementTree

import numpy
from paraview import servermanager, simple
from paraview.vtk.numpy_interface import dataset_adapter

DESIGN = {"CellData": {"density"}, "PointData": {"tdf"}}
FIELDS = {"CellData": {"stiffness_factor", "strain_energy"}, "PointData": {"displacement"}}
OUTLINES = {"CellData": {"component"}}
MOTION = {
    "CellData": {"density", "strain_energy_per_area", "von_mises", "body"},
    "PointData": {"displacement", "motion"},
}
FULL_MOTION = {
    "CellData": {"strain_energy_per_area", "von_mises", "body"},
    "PointData": {"displacement", "motion"},
}
RIGID_MOTION = {"CellData": {"body"}}

ROUND_OFF = 1e-6  # for the Float32 numbers in the files
LEAST_GREY = 0.1  # of a picture, shows density: a plate fills 0.8, and 0.2 turned by 45 degrees

defects = []


def expect(condition, defect):
    if not condition:
        defects.append(defect)
        print("DEFECT " + defect)
    return condition


def column(path, name):
    """A column of a CSV file, as text; None and a defect when there is no such file or column."""
    if not expect(os.path.exists(path), path + " is missing"):
        return None
    with open(path, newline="") as table:
        rows = csv.DictReader(table)
        if not expect(name in rows.fieldnames, "%s has no column %s" % (path, name)):
            return None
        return [row[name] for row in rows]


def parts_of(run):
    """What there is to look at in a run: its design (or None), and of its motion the fields of the
    frames, the table and the column of their times (or None)."""
    there = lambda name: os.path.exists(os.path.join(run, name))
    design = DESIGN if there("history.csv") else None
    with open(os.path.join(run, "case.toml")) as case:
        bends = any(line.strip() == "[[body]]" for line in case)
    fields = MOTION if design else FULL_MOTION if bends else RIGID_MOTION
    for table, times in ("motion.csv", "time"), ("path.csv", "step"):
        if there(table):
            return design, (fields, table, times)
    return design, None


def pieces(data):
    """The data sets with points in a data set or a (nested) collection of them."""
    if data is None:
        return []
    if not data.IsA("vtkCompositeDataSet"):
        return [data] if data.GetNumberOfPoints() else []
    iterator = data.NewIterator()
    found = []
    while not iterator.IsDoneWithTraversal():
        found += pieces(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return found


def check_frame(label, read, fields):
    """Checks names and values of the fields of one frame; returns the names."""
    seen = {"CellData": set(), "PointData": set()}
    for piece in read:
        wrapped = dataset_adapter.WrapDataObject(piece)
        for kind in seen:
            attributes = getattr(wrapped, kind)
            for name in attributes.keys():
                values = numpy.asarray(attributes[name])
                seen[kind].add(name)
                expect(numpy.isfinite(values).all(), "%s: %s is not finite" % (label, name))
                if name == "density" and values.size:
                    inside = values.min() >= -ROUND_OFF and values.max() <= 1 + ROUND_OFF
                    expect(inside, "%s: density in [%g, %g]" % (label, values.min(), values.max()))
    for kind, names in fields.items():
        for name in sorted(names - seen[kind]):
            expect(False, "%s: no %s '%s'" % (label, kind, name))
    return seen


def open_series(run, name, fields):
    """Reads every frame of a .pvd file; returns its reader and its times."""
    path = os.path.join(run, name)
    if not expect(os.path.exists(path), path + " is missing"):
        return None, []
    reader = simple.PVDReader(FileName=path)
    reader.UpdatePipelineInformation()
    times = list(numpy.atleast_1d(reader.TimestepValues))
    expect(times and all(numpy.diff(times) > 0), "%s: times do not increase" % name)
    listed = Counter(float(e.get("timestep")) for e in ElementTree.parse(path).iter("DataSet"))
    seen = {}
    for time in times:
        reader.UpdatePipeline(time)
        label = "%s at %g" % (name, time)
        read = pieces(servermanager.Fetch(reader))
        expect(len(read) == listed[time], "%s: %d of %d files" % (label, len(read), listed[time]))
        seen = check_frame(label, read, fields)
    print("%s: %d frames, last with %s" % (name, len(times), seen))
    return reader, times


def draw(layers, time, path):
    """Draws (source, field or colour) layers in the plane at a time; checks that they show."""
    view = simple.CreateView("RenderView")
    view.OrientationAxesVisibility = 0
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.ViewTime = time
    view.InteractionMode = "2D"
    for source, paint in layers:
        shown = simple.Show(source, view)
        shown.SetRepresentationType("Surface")
        if isinstance(paint, str):
            simple.ColorBy(shown, ("CELLS", paint))
            colours = simple.GetColorTransferFunction(paint)
            colours.RGBPoints = [0, 0.9, 0.9, 0.9, 1, 0.1, 0.1, 0.1]
            shown.SetScalarBarVisibility(view, False)
        else:
            shown.ColorArrayName = ["POINTS", ""]
            shown.AmbientColor = shown.DiffuseColor = paint
            shown.LineWidth = 2
    simple.Render(view)
    bounds = layers[0][0].GetDataInformation().GetBounds()
    width, height = bounds[1] - bounds[0], bounds[3] - bounds[2]
    size = [1400, max(200, min(1400, int(1400 * 1.1 * height / max(1.1 * width, 1e-12))))]
    view.ViewSize = size
    simple.ResetCamera(view)
    view.CameraParallelProjection = 1
    view.CameraParallelScale = 0.55 * max(height, width * size[1] / size[0])
    simple.SaveScreenshot(path, view, ImageResolution=size)
    simple.Delete(view)  # otherwise ParaView ends with an X error

    picture = simple.PNGSeriesReader(FileNames=[path])
    colours = dataset_adapter.WrapDataObject(servermanager.Fetch(picture)).PointData[0]
    colours = numpy.asarray(colours, dtype=int)[:, :3]
    coloured = numpy.ptp(colours, axis=1) > 60
    grey = ~coloured & (colours.max(axis=1) < 245)
    # A slender body fills little of its picture.
    least = LEAST_GREY if isinstance(layers[0][1], str) else 0
    expect(grey.mean() > least, "%s shows no body" % path)
    expect(len(layers) == 1 or coloured.any(), "%s shows no outlines" % path)
    print("%s: time %g, %d x %d, %.1f %% density, %.1f %% outlines"
          % (path, time, *size, 100 * grey.mean(), 100 * coloured.mean()))


def check_design(run, pictures, fields):
    design, iterations = open_series(run, "design/iterations.pvd", fields)
    _, field_times = open_series(run, "design/fields.pvd", FIELDS)
    outlines, outline_times = open_series(run, "design/components.pvd", OUTLINES)
    history = column(os.path.join(run, "history.csv"), "iteration")
    if history is not None:
        rows = len(history)
        expect(len(iterations) == rows, "%d designs, %d rows" % (len(iterations), rows))
    expect(outline_times == field_times, "outlines and fields have different times")
    expect(set(field_times) <= set(iterations), "fields have times without a design")
    last = field_times and iterations and field_times[-1] == iterations[-1]
    expect(last, "the last design has no fields")
    if design and outlines and iterations:
        layers = [(design, "density"), (outlines, [0.8, 0.1, 0.1])]
        draw(layers, iterations[-1], os.path.join(pictures, "design.png"))


def check_motion(run, pictures, fields, table, name):
    motion, times = open_series(run, "motion/motion.pvd", fields)
    moments = column(os.path.join(run, table), name)
    if moments and times:
        first, last = float(moments[0]), float(moments[-1])
        step = (last - first) / len(moments) if len(moments) > 1 else 1
        expect(abs(times[0] - first) <= step, "motion starts at %g, not %g" % (times[0], first))
        expect(abs(times[-1] - last) < step, "motion ends at %g, not %g" % (times[-1], last))
    if motion and times:
        paint = "density" if fields is MOTION else [0.4, 0.4, 0.4]
        draw([(motion, paint)], times[-1], os.path.join(pictures, "motion.png"))


def main(run, pictures):
    simple._DisableFirstRenderCameraReset()
    os.makedirs(pictures, exist_ok=True)
    design, motion = parts_of(run)
    expect(design or motion, run + " holds neither a design nor a motion")
    if design:
        check_design(run, pictures, design)
    if motion:
        check_motion(run, pictures, *motion)

    version = simple.GetParaViewVersion()
    print("ParaView %s: %s" % (version, "%d defects" % len(defects) if defects else "all is well"))
    return 1 if defects else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = sys.argv[1].rstrip("/")
    sys.exit(main(folder, sys.argv[2] if len(sys.argv) == 3 else folder + "_pictures"))

"""Opens a run folder with ParaView's own Python, as a user of ParaView would.

    xvfb-run -a pvpython check_run.py RUN [PICTURES]

Shows that every frame of design/iterations.pvd, design/fields.pvd, design/components.pvd and
motion/motion.pvd can be read, as far as the run has them: a design where there is a history.csv, a
motion where there is a motion.csv, a path of equilibria where there is a path.csv. Every frame of the
design has a row of history.csv, the first and the last row have a frame, and the motion starts and
ends with its table; fields have their names, finite values, and densities in [0, 1]; and both can be
drawn: PICTURES/design.png and PICTURES/motion.png (default: RUN_pictures, beside the run, because a
folder in it that no run has written would block the next run). The
stresses at three times, on bodies that are warped by their displacement, are drawn to
PICTURES/stress_1.png to stress_3.png, and the view that RUN/paraview.py opens to PICTURES/script.png.

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


def drawn_part(path):
    """The part of a picture that is not white."""
    picture = simple.PNGSeriesReader(FileNames=[path])
    colours = dataset_adapter.WrapDataObject(servermanager.Fetch(picture)).PointData[0]
    return (numpy.asarray(colours, dtype=int)[:, :3].min(axis=1) < 245).mean()


def largest(source, time, kind, name):
    """The largest absolute value of an array at a time; vectors have their length."""
    source.UpdatePipeline(time)
    found = 0
    for piece in pieces(servermanager.Fetch(source)):
        arrays = getattr(dataset_adapter.WrapDataObject(piece), kind)
        if name in arrays.keys():
            values = numpy.asarray(arrays[name], dtype=float)
            values = values if values.ndim == 1 else numpy.linalg.norm(values, axis=1)
            found = max(found, numpy.nanmax(numpy.abs(values), initial=0))
    return found


def draw_stresses(motion, times, pictures):
    """Draws the stresses at three times on bodies that are warped by their displacement."""
    chosen = [times[round(part * (len(times) - 1))] for part in (0.25, 0.5, 1)]
    stress = max(largest(motion, time, "CellData", "von_mises") for time in chosen)
    moved = max(largest(motion, time, "PointData", "displacement") for time in chosen)
    if not expect(stress > 0 and moved > 0, "the motion has no stresses or no displacements"):
        return
    bounds = motion.GetDataInformation().GetBounds()
    size = max(bounds[1] - bounds[0], bounds[3] - bounds[2])
    warped = simple.WarpByVector(Input=motion)
    warped.Vectors = ["POINTS", "displacement"]
    warped.ScaleFactor = 0.05 * size / moved
    view = simple.CreateView("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.ViewSize = [1200, 700]
    shown = simple.Show(warped, view)
    simple.ColorBy(shown, ("CELLS", "von_mises"))
    colours = simple.GetColorTransferFunction("von_mises")
    colours.ApplyPreset("Viridis (matplotlib)", True)
    colours.RescaleTransferFunction(0, 0.5 * stress)
    shown.SetScalarBarVisibility(view, True)
    bar = simple.GetScalarBar(colours, view)
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    for number, time in enumerate(chosen, 1):
        view.ViewTime = time
        simple.Render(view)
        simple.ResetCamera(view)
        path = os.path.join(pictures, "stress_%d.png" % number)
        simple.SaveScreenshot(path, view, ImageResolution=[1200, 700])
        part = drawn_part(path)
        expect(part > 0.02, path + " shows no stresses")
        print("%s: time %g, displacements times %.3g, stresses on %.1f %%"
              % (path, time, 1 + warped.ScaleFactor, 100 * part))
    simple.Delete(view)


def check_script(run, pictures):
    """Executes the script of the run as ParaView does, and draws the view that it opens."""
    script = os.path.join(run, "paraview.py")
    if not expect(os.path.exists(script), script + " is missing"):
        return
    with open(script) as text:
        exec(compile(text.read(), script, "exec"), {"__file__": script, "__name__": "script"})
    view = simple.GetActiveView()
    path = os.path.join(pictures, "script.png")
    view.ViewSize = [1200, 700]
    simple.SaveScreenshot(path, view, ImageResolution=[1200, 700])
    expect(drawn_part(path) > 0.01, path + " shows nothing")
    print(path + ": what " + os.path.basename(script) + " opens")
    simple.Delete(view)


def check_design(run, pictures, fields):
    design, iterations = open_series(run, "design/iterations.pvd", fields)
    _, field_times = open_series(run, "design/fields.pvd", FIELDS)
    outlines, outline_times = open_series(run, "design/components.pvd", OUTLINES)
    history = column(os.path.join(run, "history.csv"), "iteration")
    if history is not None:
        rows = [float(row) for row in history]
        expect(set(iterations) <= set(rows), "designs have iterations without a row")
        ends = iterations and iterations[0] == rows[0] and iterations[-1] == rows[-1]
        expect(ends, "the first or the last iteration has no design")
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
        if fields is not RIGID_MOTION:
            draw_stresses(motion, times, pictures)


def main(run, pictures):
    simple._DisableFirstRenderCameraReset()
    os.makedirs(pictures, exist_ok=True)
    design, motion = parts_of(run)
    expect(design or motion, run + " holds neither a design nor a motion")
    if design:
        check_design(run, pictures, design)
    if motion:
        check_motion(run, pictures, *motion)
    check_script(run, pictures)

    version = simple.GetParaViewVersion()
    print("ParaView %s: %s" % (version, "%d defects" % len(defects) if defects else "all is well"))
    return 1 if defects else 0


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = sys.argv[1].rstrip("/")
    sys.exit(main(folder, sys.argv[2] if len(sys.argv) == 3 else folder + "_pictures"))

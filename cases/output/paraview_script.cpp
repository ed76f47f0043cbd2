#include "cases/output/paraview_script.h"

namespace flexmorph::cases {

const char* const kParaViewScript =
    R"py("""Opens the results of this run in ParaView and colours them.

Start the script in the run folder with

    paraview --script=paraview.py

or select View > Python Shell > Run Script in ParaView. The script loads the motion, the history of
the design and the stresses on the verified outline, if the run has them. The motion is coloured by
the density of the designs, or by the strain energy per area if the case has no designs. The eye
symbols in the pipeline browser show and hide the sources.
"""

import glob
import os

from paraview import simple

try:
    run = os.path.dirname(os.path.abspath(__file__))
except NameError:  # ParaView executes the text of the script without a file
    run = os.getcwd()

GREY = [0, 0.92, 0.92, 0.92, 1, 0.15, 0.2, 0.35]

view = simple.GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
seen = []


def show(source, name, field, where, visible):
    """Adds a source with the colours of a field and hides it unless it is visible at first."""
    simple.RenameSource(name, source)
    source.UpdatePipeline()
    display = simple.Show(source, view)
    display.SetRepresentationType("Surface")
    arrays = source.PointData if where == "POINTS" else source.CellData
    if arrays.GetArray(field):
        colour(display, field, where, visible)
    if visible:
        seen.append(source)
    else:
        simple.Hide(source, view)


def colour(display, field, where, visible):
    simple.ColorBy(display, (where, field))
    colours = simple.GetColorTransferFunction(field)
    if field == "density":
        colours.RGBPoints = GREY
        colours.NanColor = [0.8, 0.3, 0.2]  # rigid bodies, hubs, point masses: no density
    else:
        colours.ApplyPreset("Viridis (matplotlib)", True)
        display.RescaleTransferFunctionToDataRange(False, True)
    display.SetScalarBarVisibility(view, visible)


def path_of(name):
    path = os.path.join(run, name)
    return path if os.path.exists(path) else None


motion = path_of("motion/motion.pvd")
designed = path_of("history.csv") is not None
if motion:
    field = "density" if designed else "strain_energy_per_area"
    show(simple.PVDReader(FileName=motion), "motion", field, "CELLS", True)
verified = sorted(glob.glob(os.path.join(run, "design*.vtu")))
for path in verified:
    reader = simple.XMLUnstructuredGridReader(FileName=[path])
    name = os.path.basename(path)
    show(reader, name, "von_mises", "POINTS", not motion)
history = path_of("design/iterations.pvd")
if history:
    reader = simple.PVDReader(FileName=history)
    show(reader, "design by iteration", "density", "CELLS", not motion and not verified)
fields = path_of("design/fields.pvd")
if fields:
    reader = simple.PVDReader(FileName=fields)
    show(reader, "fields of the design by iteration", "strain_energy", "CELLS", False)

if seen:
    bounds = seen[0].GetDataInformation().GetBounds()
    if bounds[5] - bounds[4] == 0:
        view.InteractionMode = "2D"
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    simple.ResetCamera(view)
    simple.Render(view)
else:
    print("The folder " + run + " contains no results that ParaView can show.")
)py";

}  // namespace flexmorph::cases

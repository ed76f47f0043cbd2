#include "cases/output/paraview_script.h"

namespace flexmorph::cases {

const char* const kParaViewScript = R"py("""Opens this run in ParaView, coloured.

    paraview --script=paraview.py

in the run folder; or, in ParaView, View > Python Shell > Run Script. What there is: the motion
with the density of its designs (without designs: strain energy per area), the history of the
design, and stresses on the judged outline. The eyes in the pipeline browser choose what is seen.
"""

import glob
import os

from paraview import simple

try:
    run = os.path.dirname(os.path.abspath(__file__))
except NameError:  # ParaView ran the text, not the file
    run = os.getcwd()

GREY = [0, 0.92, 0.92, 0.92, 1, 0.15, 0.2, 0.35]

view = simple.GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
seen = []


def show(source, name, field, where, visible):
    """Shows a source in the colours of a field, if it is to be seen at first."""
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
        colours.NanColor = [0.8, 0.3, 0.2]  # rigid bodies, hubs and point masses have none
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
    field = "density" if designed else "strain_energy"
    show(simple.PVDReader(FileName=motion), "motion", field, "CELLS", True)
judged = sorted(glob.glob(os.path.join(run, "design*.vtu")))
for path in judged:
    reader = simple.XMLUnstructuredGridReader(FileName=[path])
    name = os.path.basename(path)
    show(reader, name, "von_mises", "POINTS", not motion)
history = path_of("design/iterations.pvd")
if history:
    reader = simple.PVDReader(FileName=history)
    show(reader, "design by iteration", "density", "CELLS", not motion and not judged)

if seen:
    bounds = seen[0].GetDataInformation().GetBounds()
    if bounds[5] - bounds[4] == 0:
        view.InteractionMode = "2D"
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    simple.ResetCamera(view)
    simple.Render(view)
else:
    print("nothing in " + run + " can be shown")
)py";

}  // namespace flexmorph::cases

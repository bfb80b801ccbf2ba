"""Real PrusaSlicer slices a cube now; our reader must find its filament, layers and size."""

import os
import re
import tempfile

from run_tools import check, convert, run

# A 12 mm cube as ASCII STL: two triangles a face.
CORNERS = [(x, y, z) for x in (0, 12) for y in (0, 12) for z in (0, 12)]
FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
stl = "solid cube\n"
for a, b, c, d in FACES:
    for triangle in ((a, b, c), (a, c, d)):
        stl += "facet normal 0 0 0\nouter loop\n"
        for corner in triangle:
            stl += "vertex %g %g %g\n" % CORNERS[corner]
        stl += "endloop\nendfacet\n"
stl += "endsolid cube\n"

folder = tempfile.mkdtemp(prefix="stratum_slicer_")
model = os.path.join(folder, "cube.stl")
sliced = os.path.join(folder, "cube.gcode")
with open(model, "w", encoding="ascii") as file:
    file.write(stl)
run("prusa-slicer", "--export-gcode", "--layer-height", "0.2", "--first-layer-height", "0.2", "--skirts", "0",
    "--filament-diameter", "1.75", "-o", sliced, model)
with open(sliced, encoding="utf-8") as file:
    footer = float(re.search(r"; filament used \[mm\] = ([\d.]+)", file.read()).group(1))

_, report = convert(sliced, "--voxel-size", "0.1")
toolpath = report["toolpath"]
check(abs(toolpath["filament_mm"] / footer - 1) < 1e-3,
      f"filament {toolpath['filament_mm']:.2f} mm, the slicer says {footer:.2f}")
check(toolpath["layers"] == 60, f"{toolpath['layers']} layers of 0.2 mm in 12 mm")
low, high = toolpath["selected_bbox_mm"]
for axis in range(3):
    check(abs(high[axis] - low[axis] - 12) < 0.15, f"axis {'xyz'[axis]} spans {high[axis] - low[axis]:.3f} mm")
# Neighbouring beads overlap and crossing infill lines do so wholly, so the union is smaller than what was extruded.
share = report["grid"]["volume_mm3"] / toolpath["volume_mm3"]
check(0.8 < share <= 1, f"the level set encloses {share:.3f} of the extruded volume")

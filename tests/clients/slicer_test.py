"""Real PrusaSlicer slices a cube now; our reader must find its filament, layers and size."""

import os
import re
import tempfile

from run_tools import check, convert, run, write_box

folder = tempfile.mkdtemp(prefix="stratum_slicer_")
model = os.path.join(folder, "cube.stl")
sliced = os.path.join(folder, "cube.gcode")
write_box(model, 12, 12, 12)
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

"""Real Blender, headless, loads our .vdb and meshes it: one float grid `surface`, the print's bounding box."""

import json
import os
import subprocess
import sys

from run_tools import check, convert, gcode

INSIDE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "blender_inside.py")

vdb, report = convert(gcode("tile.gcode"), "--voxel-size", "0.1", "--features", "-skirt,-brim,-custom")
done = subprocess.run(
    ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", INSIDE, "--", vdb],
    capture_output=True,
    text=True,
)
lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT ")]
if done.returncode != 0 or not lines:
    sys.exit(f"blender ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
result = json.loads(lines[0][len("RESULT ") :])

check(result["grids"] == [["surface", "FLOAT"]], f"one float grid named surface: {result['grids']}")
low, high = report["toolpath"]["selected_bbox_mm"]
voxel = report["grid"]["voxel_size_mm"]
# Blender 3.4 takes a voxel's value to lie at its centre, half a voxel from OpenVDB's lattice point, so its mesh is
# shifted by up to half a voxel a side against the solid; the mesher's own rounding of edges is below a voxel.
for axis in range(3):
    shift_low = (result["min"][axis] - low[axis]) / voxel
    shift_high = (result["max"][axis] - high[axis]) / voxel
    print(f"axis {'xyz'[axis]}: solid {low[axis]:.3f} .. {high[axis]:.3f} mm, mesh {result['min'][axis]:.3f} .. "
          f"{result['max'][axis]:.3f}; shifted by {shift_low:+.2f} and {shift_high:+.2f} voxel")
    check(abs(shift_low) < 1 and abs(shift_high) < 1, "the mesh has the print's box within a voxel")
check(result["vertices"] > 1000, f"the mesh has {result['vertices']} vertices")

"""Real Blender, headless, loads our .vdb in meters and meshes it by hand: one float grid `surface`, the print's box."""

import json
import os
import subprocess
import sys

from run_tools import check, convert, gcode

INSIDE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "blender_inside.py")

vdb, report = convert(gcode("tile.gcode"), "--voxel-size", "0.1", "--features", "-skirt,-brim,-custom", "--interior", "cull",
                      "--unit", "m", "--origin", "center")
voxel = report["grid"]["voxel_size_mm"]
done = subprocess.run(
    ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", INSIDE, "--", vdb, str(voxel * 1e-3)],
    capture_output=True,
    text=True,
)
lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT ")]
if done.returncode != 0 or not lines:
    sys.exit(f"blender ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
result = json.loads(lines[0][len("RESULT ") :])

check(result["grids"] == [["surface", "FLOAT"]], f"one float grid named surface: {result['grids']}")
low, high = report["toolpath"]["selected_bbox_mm"]
start = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]]
# Blender 3.4 takes a voxel's value to lie at its center, half a voxel from OpenVDB's lattice point, so its mesh is
# shifted by up to half a voxel a side against the solid; the mesher's own rounding of edges is below a voxel.
for axis in range(3):
    for end, exact in (("min", low), ("max", high)):
        shifts = [(1e3 * result[step][end][axis] + start[axis] - exact[axis]) / voxel for step in ("there", "moved")]
        check(abs(shifts[0]) < 1, f"{end} {'xyz'[axis]}: the mesh is {shifts[0]:+.2f} voxel off")
        check(abs(shifts[1] - shifts[0] + 0.5) < 1e-3 and abs(shifts[1]) < 0.55,
              f"  {shifts[1]:+.2f} when it is moved back by half a voxel")
check(result["there"]["vertices"] > 1000, f"the mesh has {result['there']['vertices']} vertices")

"""The Blender add-on in real Blender, headless: import, materials, a sequence, a Cycles render, and what goes wrong."""

import json
import os
import signal
import subprocess
import sys
import tempfile

from run_tools import SOURCE, check, convert, gcode

FOLDER = tempfile.mkdtemp(prefix="stratum_addon_")
PICTURE = os.path.join(FOLDER, "tile.png")
here = os.path.dirname(os.path.abspath(__file__))
# Blender's settings, where add-ons are installed, are the test's own.
environment = dict(os.environ, BLENDER_USER_SCRIPTS=os.path.join(FOLDER, "scripts"), BLENDER_USER_CONFIG=FOLDER)
done = subprocess.run(
    ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
     os.path.join(here, "addon_inside.py"), "--", os.path.join(SOURCE, "tools", "blender", "stratum_import.py"),
     gcode("tile.gcode"), gcode("hull.gcode"), PICTURE],
    capture_output=True, text=True, env=environment)
lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT ")]
if done.returncode != 0 or not lines:
    sys.exit(f"blender ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
result = json.loads(lines[0][len("RESULT ") :])
print(json.dumps(result, indent=1))

_, report = convert(gcode("tile.gcode"), "--voxel-size", "0.1", "--features", "-skirt,-brim,-custom")
check(result["import"] == "FINISHED", "imports")
check(result["grids"] == ["layer", "surface"], "with the grids asked for")
low, high = report["toolpath"]["selected_bbox_mm"]
for axis in range(3):
    for end, exact in (("min", low), ("max", high)):
        off = result["mesh"][end][axis] - exact[axis]
        # Half a voxel: the shift is undone. Edges are rounded by the mesher.
        check(abs(off) < 0.06, f"{end} {'xyz'[axis]} is off by {off:+.3f} mm")
volume = report["grid"]["volume_mm3"]
check(abs(result["mesh"]["volume"] / volume - 1) < 0.03, f"volume {result['mesh']['volume']:.1f}, level set {volume:.1f} mm3")
check(result["mesh"]["smooth"], "smooth normals")
check(len(result["materials"]) >= 1, "a material for each tool")
check(result["lit"] > 1000, f"Cycles shows the print in {result['lit']} of {160 * 120} pixels")
check(result["sequence"] == "FINISHED" and result["end"] == 20, "a sequence of ten steps")
check(result["seen"] == [1] * 10, "one step is seen at a time")
check(all(a < b for a, b in zip(result["volumes"], result["volumes"][1:])), "each has more plastic than the one before")
check("bad.gcode" in result["bad"], f"a bad file: {result['bad'].strip()}")
check("/nowhere/print.gcode" in result["absent"], f"no file: {result['absent'].strip()}")
check("preferences" in result["no_binary"], f"no program: {result['no_binary'].strip()}")
check(result["objects_left"] == 0, "failed imports leave no objects")
check(result["was_running"] and result["cancelled"] == -signal.SIGTERM, "cancel ends the conversion")
check(not result["left"], "and leaves no files")

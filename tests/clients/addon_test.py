"""The Blender add-on in real Blender, headless: installed from its zip, three kinds of import, colors, names, several
files at once, a sequence, a Cycles render, and what goes wrong."""

import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import zipfile

from run_tools import BIN, SOURCE, check, convert, gcode

FOLDER = tempfile.mkdtemp(prefix="stratum_addon_")
HERE = os.path.dirname(os.path.abspath(__file__))
ADDON = os.path.join(SOURCE, "tools", "blender", "stratum_import")
# Blender's settings, where add-ons are installed, are the test's own. Its Python takes the modules of the first python3
# on PATH, which must be the one beside it.
ENVIRONMENT = dict(os.environ, BLENDER_USER_SCRIPTS=os.path.join(FOLDER, "scripts"), BLENDER_USER_CONFIG=FOLDER,
                   PATH=os.path.dirname(shutil.which("blender") or "") + os.pathsep + os.environ["PATH"])


# --- the zip: an add-on for Blender 3.4, an extension for 4.2 -----------------------------------------------------------
# A build folder may hold one of an older version, too.
ZIP = max(glob.glob(os.path.join(os.path.dirname(BIN), "stratum_import-*.zip")), key=os.path.getmtime)
with zipfile.ZipFile(ZIP) as archive:
    held = {name: archive.read(name) for name in archive.namelist()}
source = {"stratum_import/" + name for name in os.listdir(ADDON) if name.endswith((".py", ".toml"))}
check(set(held) == source, f"the zip holds the add-on's files, no others: {sorted(held)}")
for name, content in held.items():
    with open(os.path.join(os.path.dirname(ADDON), name), "rb") as file:
        check(file.read() == content, f"  {name} is of today")
manifest = dict(re.findall(r'^(\w+) = "(.*)"$', held["stratum_import/blender_manifest.toml"].decode(), re.MULTILINE))
check({"schema_version", "id", "version", "name", "tagline", "maintainer", "type", "blender_version_min"} <= set(manifest),
      "the manifest has what Blender asks for")
check(manifest["id"] == "stratum_import" and len(manifest["tagline"]) <= 64 and manifest["tagline"][-1].isalnum(), "  as it asks for it")
permission = re.search(r'^files = "(.*)"$', held["stratum_import/blender_manifest.toml"].decode(), re.MULTILINE).group(1)
check(len(permission) <= 64 and permission[-1].isalnum(), "  and its permission")
version = ", ".join(manifest["version"].split("."))
check(f'"version": ({version})' in held["stratum_import/__init__.py"].decode(), f"  and bl_info's version, {manifest['version']}")
check(ZIP.endswith(f"-{manifest['version']}.zip"), "  which is the project's")

# --- in Blender ---------------------------------------------------------------------------------------------------------
done = subprocess.run(
    ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python",
     os.path.join(HERE, "addon_inside.py"), "--", ZIP, os.path.dirname(gcode("tile.gcode")), FOLDER],
    capture_output=True, text=True, env=ENVIRONMENT, timeout=500)
lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT ")]
if done.returncode != 0 or not lines:
    sys.exit(f"blender ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
result = json.loads(lines[0][len("RESULT ") :])
print(json.dumps(result, indent=1))

# --- one print, three ways ---------------------------------------------------------------------------------------------
_, report = convert(gcode("tile.gcode"), "--voxel-size", "0.1", "--features", "-skirt,-brim,-custom")
low, high = report["toolpath"]["selected_bbox_mm"]
volume = report["grid"]["volume_mm3"]
for kind in ("mesh", "modifier"):
    done, measured = result[kind][:2]
    check(done == "FINISHED", f"{kind}: imports")
    for axis in range(3):
        for end, exact in (("min", low), ("max", high)):
            off = measured[end][axis] - exact[axis]
            # Half a voxel: the shift is undone, edges are rounded by the mesher. And a little for merged faces.
            check(abs(off) < 0.08, f"  {end} {'xyz'[axis]} is off by {off:+.3f} mm")
    check(abs(measured["volume"] / volume - 1) < 0.03, f"  volume {measured['volume']:.1f}, level set {volume:.1f} mm3")
    check(measured["smooth"], "  smooth normals")
check(not result["mesh"][2], "the mesh is valid")
check(result["adapted"] < result["modifier"][1]["faces"], f"adaptivity: {result['modifier'][1]['faces']} -> {result['adapted']} faces")
check(abs(result["moved"] - low[0] - 100) < 0.06, "a mesh with a modifier moves with its object")
check(result["volume"] == ["FINISHED", ["layer", "surface"]], f"a volume with the grids asked for: {result['volume']}")

# --- as it comes ---------------------------------------------------------------------------------------------------------
check(result["default"] == "FINISHED", "imports with defaults")
check(result["name"] == "tile" and result["selected"] == ["tile"], f"the print is selected and active: {result['selected']}")
(low, high), cube = result["box"], result["cube"]
_, report = convert(gcode("tile.gcode"), "--voxel-size", "0.4", "--features", "-skirt,-custom")  # a mesh is of the part
exact = [0.1 * (b - a) for a, b in zip(*report["toolpath"]["selected_bbox_mm"])]
check(all(abs(b - a - e) < 0.02 for a, b, e in zip(low, high, exact)), f"a unit is a centimetre: {exact}")
check(abs(low[2]) < 0.01 and abs(low[1] + high[1]) < 0.02, "it stands on the ground, in the middle of y")
check(high[0] < cube[0][0], f"clear of the default cube: {high[0]:.2f} < {cube[0][0]:.2f}")
check(20e3 < result["faces"] < 1.5e6, f"{result['faces']} faces")
check(result["orange"][0] > 1500 and result["orange"][1] == 0,
      f"the camera that was aimed sees all of it: {result['orange'][0]} of {160 * 120} pixels, {result['orange'][1]} at the edges")
check(json.loads(result["remembered"])["aim"] is True, "the settings are remembered")
check(result["limited"][0] == "FINISHED" and result["limited"][1] < 75000, f"at most about 60000 faces: {result['limited'][1]}")
check(result["limited"][1] > 30000, f"and no fewer than half of them: {result['limited'][1]}")
check(result["after_volume"] == ["FINISHED", ["BSDF_PRINCIPLED"]], f"a mesh while a volume is active: {result['after_volume']}")
check(result["scene_unit"][0] == "FINISHED" and all(abs(a) < 0.03 for a in result["scene_unit"][1][0])
      and abs(result["scene_unit"][1][1][0] - exact[0]) < 0.04, f"in the scene's unit, from the corner: {result['scene_unit'][1]}")
check(result["names"] == {"part.v2.gcode": "part.v2", "a.b.c.gcode.3mf": "a.b.c", "noise.gz": "noise", "x.GCODE": "x"},
      f"names end at their endings: {result['names']}")
check(result["named"] == ["FINISHED", "part.v2"], f"so do objects': {result['named']}")

# --- colors --------------------------------------------------------------------------------------------------------------
check(result["painted"] == [["p tool 1", "p #c81e14"], [1, 1, 0, 0]],
      f"faces have the material that most of their corners name: {result['painted']}")
check(all(abs(a - b) < 1e-3 for a, b in zip(result["painted_colors"][0][:3], (0.0137, 0.0762, 0.1470))), "in linear colors")
check(result["painted_valid"], "triangles and quads make a valid mesh")
done, measured, names = result["two"]
check(done == "FINISHED" and sorted(names) == ["two_tone tool 1", "two_tone tool 2"], f"two filaments, two materials: {names}")
share = measured["area_by_material"][names.index("two_tone tool 2")]
check(0.1 < share < 0.5, f"{100 * share:.0f} % of the surface is of the second")

# --- several ---------------------------------------------------------------------------------------------------------------
check("bad.gcode" in result["batch"] and "part.v2" not in result["batch"], f"of three files, the bad one is named: {result['batch']}")
boxes = result["batch_boxes"]
check(sorted(boxes) == ["part.v2", "two_tone"], f"the others are there: {sorted(boxes)}")
check(boxes["two_tone"][1][0] < boxes["part.v2"][0][0], "side by side")
check(result["still_there"] == ["kept"], f"what was removed meanwhile is not selected: {result['still_there']}")
check(result["sequence"] == "FINISHED" and result["end"] == 20, "a sequence of ten steps")
check(result["seen"] == [1] * 10, "one step is seen at a time")
check(all(a < b for a, b in zip(result["volumes"], result["volumes"][1:])), "each has more plastic than the one before")
check(result["sequence_materials"] == 1, "they share their material")
check(result["kept"] == [["FINISHED", "//tile.vdb"], ["FINISHED", "//tile.001.vdb"]], f"volumes lie beside the .blend: {result['kept']}")

# --- what goes wrong ---------------------------------------------------------------------------------------------------------
check("bad.gcode" in result["bad"], f"a bad file: {result['bad'].strip()}")
check("/nowhere/print.gcode" in result["absent"], f"no file: {result['absent'].strip()}")
check("preferences" in result["no_binary"], f"no program: {result['no_binary'].strip()}")
check("the disk is füll" in result["failing"], f"what gcode2vdb said last: {result['failing'].strip()}")
check(result["objects_left"] == 0, "failed imports leave no objects")
check(result["chatty"] == "FINISHED", "600 kB of messages stop nothing")
check(result["heard"][:2] == ["voxelizing", 0.4], f"progress is heard: {result['heard']}")
check(result["cancelled"] == -signal.SIGTERM, "cancel ends the conversion")
check(result["status"] == ["tile.gcode: measuring", 0.4], f"an import of two files tells what it does: {result['status']}")
check(result["after_cancel"] == [False, 0, [], 0], "cancelled, it begins nothing more and has failed in nothing")
check(result["left"] == [], f"nothing is left of any of them: {result['left']}")
check(result["disabled"], "and the add-on can be switched off")
shutil.rmtree(FOLDER)

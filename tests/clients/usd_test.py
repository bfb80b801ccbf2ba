"""The .usda beside a .vdb: names every grid, by a relative path, with units and axes; and others read the .vdb."""

import re
import subprocess

from run_tools import check, convert, gcode, run

GRIDS = ("surface", "layer", "time", "feature", "tool", "object", "width", "speed", "color")

for options, unit, up in (([], "0.001", "Z"), (["--unit", "m", "--up", "y"], "1", "Y"), (["--unit", "cm"], "0.01", "Z")):
    vdb, report = convert(gcode("tile.gcode"), "--layers", "1:4", "--usda", "--grids", ",".join(GRIDS[1:]), *options)
    with open(vdb[:-4] + ".usda", encoding="utf-8") as file:
        text = file.read()
    check(text.startswith("#usda 1.0\n"), "a .usda")
    check(all(text.count(a) == text.count(b) for a, b in ("{}", "()", "[]")), "  whose brackets close")
    check(f"metersPerUnit = {unit}\n" in text and f'upAxis = "{up}"' in text, f"  {unit} m a unit, {up} up")
    check(set(re.findall(r"asset filePath = @(.*?)@", text)) == {"./print.vdb"}, "  names the .vdb beside it")
    check(tuple(re.findall(r'token fieldName = "(\w+)"', text)) == GRIDS, "  with all its grids")
    check(tuple(re.findall(r"rel field:(\w+) = </print/\1>", text)) == GRIDS, "  as fields")
    low, high = re.search(r"extent = \[\((.*?)\), \((.*?)\)\]", text).groups()
    scale = {"0.001": 1, "0.01": 0.1, "1": 0.001}[unit]
    for word, exact in zip((low + ", " + high).split(", "), [x for end in report["grid"]["bbox_mm"] for x in end]):
        check(abs(float(word) - exact * scale) < 1e-6, f"  extent {word}")

listing = run("vdb_print", "-l", vdb)
check(all(name in listing for name in GRIDS), "vdb_print lists the grids")
check("surface" in run("vdb_print", "-m", vdb), "vdb_print -m reads them")

# Debian's module belongs to Debian's Python, and knows no grids of whole numbers.
KNOWN = ("surface", "time", "width", "speed", "color")
script = """
import sys
import pyopenvdb
for name in sys.argv[2:]:
    grid = pyopenvdb.read(sys.argv[1], name)
    print(grid.name, grid.valueTypeName, grid.activeVoxelCount())
"""
done = subprocess.run(["/usr/bin/python3", "-c", script, vdb, *KNOWN], capture_output=True, text=True)
if "ModuleNotFoundError" in done.stderr:
    print("skipped: python3-openvdb is not installed")
else:
    check(done.returncode == 0, f"python3-openvdb reads it: {done.stderr}")
    found = {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines()}
    check(sorted(found) == sorted(KNOWN), f"  what it knows of them: {found}")
    check(len({count for _, count in found.values()}) == 1, "  of the same voxels")
    check(int(found["surface"][1]) == report["grid"]["active_voxels"], "  as many as we counted")

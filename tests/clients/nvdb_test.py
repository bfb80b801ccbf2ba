"""gcode2vdb -o part.nvdb: what OpenVDB's own NanoVDB tools say of it, and the same level set as in the .vdb."""

import os
import re
import shutil
import subprocess

from run_tools import BIN, Scratch, check, gcode, run, skip_without

skip_without(("nanovdb_validate", "nanovdb_print", "nanovdb_convert"))

SCRATCH = Scratch("nvdb")
FOLDER, path = SCRATCH.folder, SCRATCH.path
GCODE2VDB = os.path.join(BIN, "gcode2vdb")


def grids(name):
    """{name: (type, class, active voxels)} as nanovdb_print has them."""
    rows = re.findall(r"^\d+\s+(\S+)\s+(\S+)\s+(\S+)\s+[\d.]+\s+\w+\s+[\d.]+ \w+\s+[\d.]+ \w+\s+\S+\s+(\d+)", run("nanovdb_print", path(name)),
                      re.M)
    return {row[0]: (row[1], row[2], int(row[3])) for row in rows}


def convert(name, *options, source="tile.gcode"):
    run(GCODE2VDB, gcode(source), "-o", path(name), "--quiet", "--voxel-size", "0.1", "--force", *options)


convert("print.vdb", "--grids", "layer,width")
run("nanovdb_convert", path("print.vdb"), path("theirs.nvdb"))
for compression in ("blosc", "zip", "none"):
    convert("print.nvdb", "--grids", "layer,width", "--compression", compression)
    told = run("nanovdb_validate", "-v", path("print.nvdb"))
    check(told.count(": passed") == 3 and "fail" not in told.lower(), f"{compression}: nanovdb_validate passes three grids")
    check(grids("print.nvdb") == grids("theirs.nvdb"), f"  as nanovdb_convert makes them of the .vdb: {grids('print.nvdb')}")

SCRATCH.does(GCODE2VDB, gcode("tile.gcode"), "-o", "print.nvdb", "--quiet", "--voxel-size", "0.1")  # replaces its own without --force

convert("half.nvdb", "--precision", "half")
check(run("nanovdb_validate", "-v", path("half.nvdb")).count(": passed") == 1, "half: passes")
check(grids("half.nvdb")["surface"] == ("Float16", "SDF", grids("print.nvdb")["surface"][2]), f"  {grids('half.nvdb')}")
convert("float.nvdb")
check(os.path.getsize(path("half.nvdb")) < 0.7 * os.path.getsize(path("float.nvdb")), "  and is smaller")

# Back in OpenVDB, the values are those of the .vdb.
run("nanovdb_convert", path("float.nvdb"), path("back.vdb"))
compare = """
import sys
import pyopenvdb as vdb
ours, back = (vdb.read(name, "surface") for name in sys.argv[1:])
assert ours.activeVoxelCount() == back.activeVoxelCount() > 1000
assert ours.background == back.background
values = back.getConstAccessor()
step = max(1, ours.activeVoxelCount() // 20000)
for n, item in enumerate(ours.citerOnValues()):
    if n % step == 0 and item.count == 1:
        assert values.getValue(item.min) == item.value, item
low, high = ours.transform.indexToWorld((3, 4, 5)), back.transform.indexToWorld((3, 4, 5))
assert max(abs(a - b) for a, b in zip(low, high)) < 1e-6, (low, high)
"""
done = subprocess.run(["/usr/bin/python3", "-c", compare, path("print.vdb"), path("back.vdb")], capture_output=True, text=True)
check(done.returncode == 0, f"the values are those of the .vdb {done.stderr.strip()[-300:]}")

convert("parts.nvdb", "--snapshots", "50%")
check(run("nanovdb_validate", "-v", path("parts_050pct.nvdb")).count(": passed") == 1, "snapshots are .nvdb, too")
convert("many.nvdb", "--threads", "2")
convert("one.nvdb", "--threads", "1")
with open(path("many.nvdb"), "rb") as many, open(path("one.nvdb"), "rb") as one:
    check(many.read() == one.read(), "the same bytes for any number of threads")

for options in (["--usda"],):
    done = subprocess.run([GCODE2VDB, gcode("tile.gcode"), "-o", path("refused.nvdb"), *options], capture_output=True, text=True)
    check(done.returncode == 2 and options[0] in done.stderr, done.stderr.strip())
done = subprocess.run([GCODE2VDB, gcode("tile.gcode"), "-o", "-.nvdb"], capture_output=True, text=True)
check(done.returncode == 2 and "can't be a stream" in done.stderr, done.stderr.strip())
check(not os.path.exists(path("refused.nvdb")), "nothing is left of what was refused")
shutil.rmtree(FOLDER)

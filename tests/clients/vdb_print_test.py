"""OpenVDB's own vdb_print reads our file: grid, class, metadata, counts."""

import re

from run_tools import check, convert, gcode, run

vdb, report = convert(gcode("tile.gcode"), "--voxel-size", "0.1")
listing = run("vdb_print", "-l", vdb)
print(listing)
check("surface" in listing and "level set" in listing, "a level set named surface")
check(report["input"]["sha256"] in listing, "the hash of the source file")
count = re.search(r"file_voxel_count: (\d+)", listing)
check(count and int(count.group(1)) == report["grid"]["active_voxels"], "the number of active voxels")
check('unit: mm' in listing, "the unit")

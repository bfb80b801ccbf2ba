#!/usr/bin/env python3
"""Voxelizing from Python beside the tool, in turns: bench/python_voxelize.py BUILD_FOLDER PRINT.gcode [SIZE [TURNS]]

Processor time (user and system), which other programs of the machine disturb least: of gcode2vdb, from its start to its
end, and of read() and write_vdb(), which do the same work. A dense block is compared with the level set and a NumPy array
of its size filled with a number, because touching gigabytes for the first time takes longer than all voxels. Prints the
median ratio of a turn, and the least and the largest.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile

build, source = sys.argv[1:3]
size = float(sys.argv[3]) if len(sys.argv) > 3 else 0.1
turns = int(sys.argv[4]) if len(sys.argv) > 4 else 9
sys.path.insert(0, os.path.join(build, "python"))
import numpy as np  # noqa: E402
import stratum  # noqa: E402

folder = tempfile.mkdtemp(prefix="stratum_bench_")


def processor_seconds(call, who=resource.RUSAGE_SELF):
    def used():
        usage = resource.getrusage(who)
        return usage.ru_utime + usage.ru_stime

    before = used()
    call()
    return used() - before


def tool():
    subprocess.run([os.path.join(build, "bin", "gcode2vdb"), source, "-o", os.path.join(folder, "tool.vdb"), "--voxel-size",
                    str(size), "--grids", "surface", "--quiet"], check=True)


def module():
    stratum.write_vdb(stratum.read(source), os.path.join(folder, "module.vdb"), voxel_size=size, grids="surface")


toolpath = stratum.read(source)
shape = stratum.voxelize_block(toolpath, voxel_size=size).values.shape
files, blocks = [], []
for turn in range(turns):
    files.append(processor_seconds(module) / processor_seconds(tool, resource.RUSAGE_CHILDREN))
    # Fresh memory may be slow for whoever comes first: in either order.
    times = {}
    steps = {"block": lambda: stratum.voxelize_block(toolpath, voxel_size=size),
             "grid": lambda: stratum.voxelize(toolpath, voxel_size=size, grids="surface"),
             "full": lambda: np.full(shape, 0.3, np.float32)}
    for name in sorted(steps, reverse=turn % 2 == 1):
        times[name] = processor_seconds(steps[name])
    blocks.append(times["block"] / (times["grid"] + times["full"]))
print(f"{os.path.basename(source)} at {size:g} mm, {turns} turns; block of {np.prod(shape) * 4e-9:.2f} GB")
for name, row in (("read() and write_vdb() / gcode2vdb", files), ("voxelize_block() / voxelize() and numpy.full()", blocks)):
    print(f"{name}: {statistics.median(row):.3f} ({min(row):.3f} to {max(row):.3f})")

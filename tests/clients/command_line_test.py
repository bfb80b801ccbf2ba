"""The tools on good and bad input: exit status, a message with place and remedy, no file left behind."""

import filecmp
import json
import os
import signal
import subprocess
import time

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("cli")
FOLDER, path, call = SCRATCH.folder, SCRATCH.path, SCRATCH.call
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
TILE = gcode("tile.gcode")


def make(name, content):
    with open(path(name), "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path(name)


def refused(command, status, *fragments):
    """The command ends with `status`, one line that has the fragments, and leaves no file."""
    before = set(os.listdir(FOLDER))
    done = call(*command)
    text = done.stderr.strip()
    label = " ".join(os.path.basename(part) for part in command)
    expected = (status,) if isinstance(status, int) else status
    check(done.returncode in expected, f"{label}: exit {done.returncode}: {text}")
    for fragment in fragments:
        check(fragment in text, f"  says {fragment!r}")
    check(set(os.listdir(FOLDER)) == before, "  leaves no file behind")


# --- greeting -----------------------------------------------------------------------------------------------------
for tool in (GCODE2VDB, VDBTRACE):
    done = call(tool, "-h")
    check(done.returncode == 0 and "Examples:" in done.stdout, f"{os.path.basename(tool)} -h has examples")
    check(call(tool, "--version").stdout.split()[0] == os.path.basename(tool), "--version names the tool")

# --- input that is no print ---------------------------------------------------------------------------------------
OUT = path("out.vdb")
refused([GCODE2VDB, "missing.gcode", "-o", OUT], 3, "missing.gcode")
refused([GCODE2VDB, make("empty.gcode", ""), "-o", OUT], 3, "empty")
refused([GCODE2VDB, FOLDER, "-o", OUT], 3, "regular file")
refused([GCODE2VDB, make("binary.gcode", bytes(range(256)) * 40), "-o", OUT], 3, "binary.gcode")
refused([GCODE2VDB, make("packed.gcode", b"\x1f\x8b\x08\x00" + bytes(100)), "-o", OUT], 3, "gzip")
refused([GCODE2VDB, make("model.stl", "solid part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"), "-o", OUT], 3, "STL")
refused([GCODE2VDB, make("binary.stl", b"exported model".ljust(80) + (12).to_bytes(4, "little") + bytes(600)), "-o", OUT], 3)
refused([GCODE2VDB, make("travel.gcode", "G28\nG1 X10 Y10 F3000\nG1 X20\n"), "-o", OUT], 3, "travel.gcode")
refused([GCODE2VDB, make("prose.gcode", "Dear printer, please print a boat.\n"), "-o", OUT], 3, "prose.gcode")
refused([GCODE2VDB, make("nan.gcode", "G1 X0 Y0 Z0.2\nG1 XNaN E1\n"), "-o", OUT], 3, "nan.gcode")
refused([GCODE2VDB, make("absurd.gcode", "G1 X0 Y0 Z0.2\nG1 X1e9 E1\nG1 X1000000000 E2\n"), "-o", OUT], 3, "absurd.gcode:")

# --- options that make no sense -------------------------------------------------------------------------------------
for size in ("0", "-1", "1e-9", "500", "nan", "inf", "small"):
    refused([GCODE2VDB, TILE, "-o", OUT, f"--voxel-size={size}"], 2, "voxel")
refused([GCODE2VDB, TILE, "-o", OUT, "--voxel-size", "0.0001"], 2, "GB")
refused([GCODE2VDB, TILE, "-o", OUT, "--voxel-size", "0.1", "--voxels-per-layer", "2"], 2)
refused([GCODE2VDB, TILE, "-o", OUT, "--layers", "900:"], 3, "layers 1 to")
refused([GCODE2VDB, TILE, "-o", OUT, "--features", "+nonsense"], 2, "external-perimeter")
refused([GCODE2VDB, TILE, "-o", OUT, "--snapshots", "sometimes"], 2, "every:N")
refused([GCODE2VDB, TILE, "-o", path("out.abc")], 2, ".vdb", ".stl")
refused([GCODE2VDB, TILE, "-o", path("out.obj"), "--grids", "layer"], 2, "no voxels")
refused([GCODE2VDB, TILE, "-o", path("nowhere/out.vdb")], 1, "does not exist")
refused([GCODE2VDB, TILE, "-o", OUT, "--nonsense"], 2, "-h")
refused([GCODE2VDB], 2)

# --- a good run: only what was asked for, and the old file survives a failure ---------------------------------------
done = call(GCODE2VDB, TILE, "-o", OUT, "--voxel-size", "0.1", "--stats", path("stats.json"))
check(done.returncode == 0, "converts the tile")
with open(path("stats.json"), encoding="utf-8") as file:
    stats = json.load(file)
for key in ("input", "toolpath", "grid", "files", "skipped", "seconds", "peak_rss_bytes", "threads"):
    check(key in stats, f"the report has {key}")
check(not [name for name in os.listdir(FOLDER) if name.endswith(".part")], "nothing unfinished is left")
with open(OUT, "rb") as file:
    before = file.read()
refused([GCODE2VDB, make("bad.gcode", "G1 XNaN E1\n"), "-o", OUT], 3)
with open(OUT, "rb") as file:
    check(file.read() == before, "a failed run leaves the old file")

# A run that is ended in the middle leaves the old file and nothing else.
process = subprocess.Popen([GCODE2VDB, gcode("hull.gcode"), "-o", OUT, "--voxel-size", "0.04"], cwd=FOLDER,
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
time.sleep(0.3)
process.send_signal(signal.SIGTERM)
process.wait()
check(process.returncode == -signal.SIGTERM, f"the signal ends it ({process.returncode})")
with open(OUT, "rb") as file:
    check(file.read() == before, "a killed run leaves the old file")
check(not [name for name in os.listdir(FOLDER) if name.endswith(".part")], "and nothing unfinished")

# --- the same bytes for one thread and two ----------------------------------------------------------------------------
for threads in ("1", "2"):
    call(GCODE2VDB, TILE, "-o", path(f"t{threads}.vdb"), "--voxel-size", "0.1", "--threads", threads)
    call(VDBTRACE, OUT, "-o", path(f"t{threads}.png"), "--size", "160x120", "--spp", "4", "--threads", threads)
    call(VDBTRACE, OUT, "-o", path(f"t{threads}.exr"), "--size", "160x120", "--spp", "4", "--threads", threads)
check(filecmp.cmp(path("t1.png"), path("t2.png"), shallow=False), "the same PNG for one thread and two")
check(filecmp.cmp(path("t1.exr"), path("t2.exr"), shallow=False), "the same EXR for one thread and two")
# OpenVDB writes a fresh random identifier into the header of every file: 36 characters, the rest must be equal.
with open(path("t1.vdb"), "rb") as one, open(path("t2.vdb"), "rb") as two:
    first, second = one.read(), two.read()
    differing = [n for n in range(len(first)) if first[n] != second[n]] if len(first) == len(second) else [-1]
check(differing == [] or (0 <= differing[0] and differing[-1] - differing[0] < 36), "the same .vdb but for its identifier")

# --- vdbtrace on bad input ---------------------------------------------------------------------------------------------
PNG = path("out.png")
refused([VDBTRACE, "missing.vdb", "-o", PNG], 3, "missing.vdb")
refused([VDBTRACE, path("empty.gcode"), "-o", PNG], 3, "empty")
refused([VDBTRACE, TILE, "-o", PNG, "--march", "vdb"], 2, "gcode2vdb")
refused([VDBTRACE, make("cut.vdb", before[: len(before) // 2]), "-o", PNG], 3, "cut.vdb")
refused([VDBTRACE, make("text.vdb", "solid\n"), "-o", PNG], 3, "text.vdb")
refused([VDBTRACE, OUT, "-o", path("out.gif")], 2, ".png")
refused([VDBTRACE, OUT, "-o", path("nowhere/out.png")], 1, "does not exist")
refused([VDBTRACE, OUT, "-o", PNG, "--size", "0x0"], 2)
refused([VDBTRACE, OUT, "-o", PNG, "--size", "huge"], 2, "WxH")
refused([VDBTRACE, OUT, "-o", PNG, "--spp", "0"], 2)
refused([VDBTRACE, OUT, "-o", PNG, "--brdf", "nougatine"], 2, "plastic")
refused([VDBTRACE, OUT, "-o", PNG, "--env", "disco"], 2, "studio")
refused([VDBTRACE, OUT, "-o", PNG, "--brdf", OUT], 3, "is no BRDF")
refused([VDBTRACE, OUT, "-o", PNG, "--env", OUT], 3, "no environment map")
refused([VDBTRACE, OUT, "-o", PNG, "--light", "lamp:1"], 2, "rectangle")
refused([VDBTRACE, OUT, "-o", PNG, "--aov", "normal"], 2, ".exr")
SCENE = path("scene.json")
with open(SCENE, "w", encoding="utf-8") as file:
    file.write('{"print": "out.vdb", "enviroment": {}}')
refused([VDBTRACE, SCENE, "-o", PNG], 3, "did you mean 'environment'")
refused([VDBTRACE, OUT, "-o", PNG, "--integrator", "magic"], 2, "path")
refused([VDBTRACE, OUT, "-o", PNG, "--view", "inside"], 2, "iso")
refused([VDBTRACE, OUT, "-o", PNG, "--fov", "0"], 2)
refused([VDBTRACE, OUT, "-o", PNG, "--crop", "0,0,9999,9999"], 2)

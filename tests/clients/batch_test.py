"""Several inputs: names that sort and that a pattern finds, one bad file that stops nobody, and streams for files."""

import glob
import json
import os
import shutil
import subprocess

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("batch")
FOLDER, path, call, does = SCRATCH.folder, SCRATCH.path, SCRATCH.call, SCRATCH.does
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
SMALL = ["--size", "32x24", "--spp", "1"]
COARSE = ["--voxel-size", "0.2"]
PNG = b"\x89PNG"
EXR = b"\x76\x2f\x31\x01"


def names(pattern):
    return sorted(os.path.relpath(name, FOLDER) for name in glob.glob(path(pattern)))


def copies(*where):
    for name in where:
        os.makedirs(os.path.dirname(path(name)), exist_ok=True)
        shutil.copy(gcode("tile.gcode"), path(name))


# --- names ---------------------------------------------------------------------------------------------------------------
copies("part.gcode")
does(GCODE2VDB, "part.gcode", *COARSE, "--snapshots", "25%,50%,100%,every:20", "--usda")
check(names("part_*pct.vdb") == ["part_025pct.vdb", "part_050pct.vdb", "part_100pct.vdb"], f"shares: {names('part_*')}")
check("part_layer0020.vdb" in names("part_*.vdb") and "part_layer0020.usda" in names("*.usda"), "layers")
shares = names("part_*pct.vdb")
does(VDBTRACE, *shares, *SMALL, "--turntable", "2")
check(names("part_*.png") == [f"part_{n:03}.png" for n in range(6)], f"frames of a series: {names('*.png')}")
copies("x/one.gcode", "x/two.gcode")
does(VDBTRACE, "x/one.gcode", "x/two.gcode", *SMALL, *COARSE)
check(names("series_*.png") == ["series_000.png", "series_001.png"], "frames of inputs that have no beginning in common")

# --- where they go ------------------------------------------------------------------------------------------------------
copies("in/a.gcode", "in/b.gcode.gcode", "other/a.gcode")
does(GCODE2VDB, "in/a.gcode", "other/a.gcode", *COARSE)
check(names("*/a.vdb") == ["in/a.vdb", "other/a.vdb"], "several inputs: beside each")
does(GCODE2VDB, "in/a.gcode", "in/b.gcode.gcode", *COARSE, "-o", "new/deep")
check(names("new/deep/*") == ["new/deep/a.vdb", "new/deep/b.gcode.vdb"], "or in a folder, which is made")
does(GCODE2VDB, "in/a.gcode", *COARSE, "-o", "single/")
check(names("single/*") == ["single/a.vdb"], "also of one input")
does(GCODE2VDB, "in/a.gcode", *COARSE)
check(os.path.exists(path("a.vdb")), "one input: here")
done = call(GCODE2VDB, "in/a.gcode", "other/a.gcode", *COARSE, "-o", "clash")
check(done.returncode == 2 and "clash/a.vdb" in done.stderr and not os.path.exists(path("clash")),
      f"two inputs of one name: {done.stderr.strip()}")
done = call(GCODE2VDB, "in/a.gcode", "in/b.gcode.gcode", *COARSE, "-o", "all.vdb")
check(done.returncode == 2 and "folder" in done.stderr, f"a file for two: {done.stderr.strip()}")
does(VDBTRACE, "in/a.gcode", "in/b.gcode.gcode", "--each", *SMALL, *COARSE)
check(names("in/*.png") == ["in/a.png", "in/b.gcode.png"], "--each: beside each")
does(VDBTRACE, "in/a.gcode", "x/one.gcode", "--each", "-o", "pictures", *SMALL, *COARSE, "--turntable", "2")
check(names("pictures/*") == ["pictures/a_000.png", "pictures/a_001.png", "pictures/one_000.png", "pictures/one_001.png"],
      "--each: in a folder")

# A camera of its own: the same bytes as alone, though the other print is larger.
shutil.copy(gcode("gear.gcode"), path("in/gear.gcode"))
does(VDBTRACE, "in/a.gcode", "in/gear.gcode", "--each", "-o", "each", *SMALL, "--voxel-size", "0.3", "--quiet")
for name in ("a", "gear"):
    does(VDBTRACE, f"in/{name}.gcode", "-o", "alone.png", *SMALL, "--voxel-size", "0.3", "--quiet")
    with open(path("alone.png"), "rb") as alone, open(path(f"each/{name}.png"), "rb") as each:
        check(alone.read() == each.read(), f"--each: {name} as alone")

# --- one bad file ----------------------------------------------------------------------------------------------------------
with open(path("in/bad.gcode"), "w", encoding="utf-8") as file:
    file.write("G1 X0 Y0 Z0.2\nG1 X1000000000 E1\n")
for tool, more, kind in ((GCODE2VDB, [], "vdb"), (VDBTRACE, [*SMALL, "--each"], "png")):
    out = "kept_" + kind
    done = call(tool, "in/bad.gcode", "in/a.gcode", "in/missing.gcode", "in/gear.gcode", "-o", out, "--voxel-size", "0.3",
                "--stats", "kept.json", *more)
    check(done.returncode == 3, f"{os.path.basename(tool)}: the worst status, {done.returncode}")
    check(names(out + "/*") == [f"{out}/a.{kind}", f"{out}/gear.{kind}"], "  the good ones are made")
    last = done.stderr.strip().splitlines()[-1]
    check("2 of 4 inputs failed: " in last and "in/bad.gcode" in last and "in/missing.gcode" in last, f"  the end names them: {last}")
    check("bad.gcode:2" in done.stderr and "missing.gcode" in done.stderr, "  and why was said")
    with open(path("kept.json"), encoding="utf-8") as file:
        reports = json.load(file)
    check(len(reports) == 4 and sorted(r["exit_status"] for r in reports if "error" in r) == [3, 3], "  --stats has them, too")
done = call(VDBTRACE, "in/a.gcode", "in/gear.gcode", "in/bad.gcode", *SMALL, "--voxel-size", "0.3", "-o", "film.png")
check(done.returncode == 3 and names("film_*.png") == ["film_000.png", "film_001.png"], f"a series goes on: {done.stderr.strip()}")
done = call(VDBTRACE, "in/a.gcode", "in/gear.gcode", *SMALL, "--voxel-size", "0.3", "--brdf", "nougatine")
check(done.returncode == 2 and done.stderr.count("nougatine: is neither") <= 2, f"what is wrong for all is said once: {done.stderr}")

# --- streams -----------------------------------------------------------------------------------------------------------------
def fed(*command, text=False):
    with open(gcode("tile.gcode"), "rb") as file:
        return subprocess.run(command, stdin=file, capture_output=True, text=text, timeout=300, cwd=FOLDER)


done = fed(VDBTRACE, "-", "-o", "-", *SMALL, *COARSE)
check(done.returncode == 0 and done.stdout.startswith(PNG), f"G-code in, PNG out: {done.stderr.decode().strip()}")
check(b"standard input: " in done.stderr, "  what is said goes to stderr")
does(VDBTRACE, "part.gcode", "-o", "p.exr", *SMALL, *COARSE)
done = call(VDBTRACE, "part.gcode", "-o", "-.exr", *SMALL, *COARSE, text=False)
with open(path("p.exr"), "rb") as file:
    check(done.stdout == file.read() and done.stdout.startswith(EXR), "an EXR, byte for byte the file")
done = fed(GCODE2VDB, "-", "-o", "-", *COARSE)
check(done.returncode == 0 and done.stdout[:4] == b" BDV", "a .vdb")
done = fed(GCODE2VDB, "-", "-o", "-.stl", *COARSE)
check(done.returncode == 0 and len(done.stdout) == 84 + 50 * int.from_bytes(done.stdout[80:84], "little"), "a mesh")
check(not names("-*"), "no file of that name")
for command, words in (([VDBTRACE, "-", *SMALL], "standard input has no name"), ([GCODE2VDB, "-"], "standard input has no name"),
                       ([VDBTRACE, "part.gcode", "-o", "-", "--stats", "-", *SMALL], "standard output"),
                       ([VDBTRACE, "part.gcode", "-o", "-", "--turntable", "3", *SMALL], "only one picture"),
                       ([GCODE2VDB, "part.gcode", "-o", "-", "--snapshots", "50%"], "is a stream"),
                       ([GCODE2VDB, "part.gcode", "-o", "-", "--dump-toolpath", "-"], "standard output")):
    done = fed(*command, text=True)
    check(done.returncode == 2 and words in done.stderr and done.stdout == "", f"{' '.join(command[1:])}: {done.stderr.strip()}")
with open(path("part.vdb"), "rb") as file:
    done = subprocess.run([VDBTRACE, "-", "-o", "s.png"], stdin=file, capture_output=True, text=True, cwd=FOLDER)
check(done.returncode == 3 and "can't be read from a stream" in done.stderr, f"a .vdb from a stream: {done.stderr.strip()}")

# --- one output of a run is no other one, also after it was written ---------------------------------------------------------------
for name in ("one.gcode", "one_050pct.gcode"):
    shutil.copy(gcode("tile.gcode"), path(name))
for inputs in (["one_050pct.gcode", "one.gcode"], ["one.gcode", "one_050pct.gcode"]):
    shutil.rmtree(path("both"), ignore_errors=True)
    done = call(GCODE2VDB, *inputs, *COARSE, "-o", "both/", "--snapshots", "50%")
    check(done.returncode == 2 and "is written already" in done.stderr, f"{inputs}: {done.returncode} {done.stderr.strip()}")
# --- a series of what is selected grows from its first picture on ------------------------------------------------------------------
does(VDBTRACE, "part.gcode", "-o", "grow.png", *SMALL, "--progress-series", "4", "--layers", "20:24", "--no-bed", "--integrator", "layer")
pictures = {open(path(name), "rb").read() for name in names("grow_*.png")}
check(len(pictures) == 4, f"{len(pictures)} different pictures of 4")
done = call(VDBTRACE, "part.gcode", "-o", "none.png", *SMALL, "--printed", "time:0.0001")
check(done.returncode == 2 and "nothing of what is selected is printed by then" in done.stderr, done.stderr.strip())

# --- a full disk behind standard output ------------------------------------------------------------------------------------------
for command in ([GCODE2VDB, "part.gcode", *COARSE, "-o", "full.vdb", "--stats", "-"], [VDBTRACE, "part.vdb", *SMALL, "-o", "-"],
                [VDBTRACE, "part.vdb", *SMALL, "-o", "full.png", "--stats", "-"], [GCODE2VDB, "part.gcode", *COARSE, "-o", "full.vdb"],
                [GCODE2VDB, "part.gcode", *COARSE, "-o", "-"], [GCODE2VDB, "--help-all"], [VDBTRACE, "--version"]):
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=FOLDER)
    check(done.returncode == 1 and "disk full" in done.stderr,
          f"{' '.join(map(os.path.basename, command))} > /dev/full: {done.returncode} {done.stderr.strip()}")
does(GCODE2VDB, "part.gcode", *COARSE, "-o", "n.vdb", "--stats", "/dev/null")
check(not os.path.isfile("/dev/null"), "a device stays one")
shutil.rmtree(FOLDER)

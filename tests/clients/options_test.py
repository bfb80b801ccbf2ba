"""Options: each takes its own words alone, is refused where it would be ignored, and destroys no file that is read."""

import os
import shutil

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("options")
FOLDER, path, call, does, contents = SCRATCH.folder, SCRATCH.path, SCRATCH.call, SCRATCH.does, SCRATCH.contents
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
VDBSTUDY = os.path.join(BIN, "vdbstudy")
SMALL = ["--size", "32x24", "--spp", "1"]
COARSE = ["--voxel-size", "0.2"]


def refused(command, status, *fragments):
    before = contents()
    done = call(*command)
    text = done.stderr.strip()
    check(done.returncode == status, f"{' '.join(map(os.path.basename, command))}: exit {done.returncode}: {text}")
    for fragment in fragments:
        check(fragment in text, f"  says {fragment!r}")
    check(contents() == before, "  and every file is as it was")


shutil.copy(gcode("tile.gcode"), path("t.gcode"))
shutil.copy(gcode("tile.gcode"), path("u.gcode"))
does(GCODE2VDB, "t.gcode", "-o", "t.vdb", *COARSE)

# --- a summary writes nothing but itself, unless an output is named -----------------------------------------------------
os.remove(path("u.gcode"))
before = contents()
for words in ([], ["--beads", "settled"], ["--beads", "settled", "--stats", "-"]):
    text = does(GCODE2VDB, "t.gcode", "--summary", *words).stdout
    check("nan" not in text.lower(), f"  and {words} prints no NaN")
    check("settled: 0.00 of" not in text and ("mm^3" in text or '"laid_mm3"' in text), f"  and {words} states volumes")
check(contents() == before, "a summary alone writes no file")
with open(path("klipper.gcode"), "w", encoding="utf-8") as file:
    file.write("; gcode_flavor = klipper\nM83\nG1 Z.2\nG1 X10 E.4\n")
told = does(GCODE2VDB, "klipper.gcode", "--summary")
check(told.stdout.count("Klipper's limits") == 1 and "Klipper's limits" not in told.stderr, "a warning is told once")
check(told.stdout.count("minimum_cruise_ratio") == 1, "and each of the assumed limits, too")
os.remove(path("klipper.gcode"))
does(GCODE2VDB, "t.gcode", "--summary", "-o", "summary.vdb", *COARSE)
check("summary.vdb" in contents(), "with -o it is written")
shutil.copy(gcode("tile.gcode"), path("u.gcode"))

# --- a report that can't be written is found before the work ------------------------------------------------------------
for tool, source, words in ((GCODE2VDB, "t.gcode", ["--stats", "none/s.json"]), (GCODE2VDB, "t.gcode", ["--dump-toolpath", "none/t.csv"]),
                            (GCODE2VDB, "t.gcode", ["--report", "none/r.md"]), (VDBTRACE, "t.vdb", ["--stats", "none/s.json"])):
    refused([tool, source, "-o", "late.png" if tool == VDBTRACE else "late.vdb", *words], 1, words[1], "does not exist")
check(not any(name.startswith("late") for name in contents()), "nothing was made")
told = does(GCODE2VDB, "t.gcode", *COARSE, "--layers", "10:", "--snapshots", "layer:2,layer:12", "-o", "steps.vdb")
check("nothing is printed by then" in told.stdout + told.stderr and len([name for name in contents() if name.startswith("steps")]) == 2,
      "a snapshot of nothing is said")

# --- each takes its own words, so that the input may come last ---------------------------------------------------------
for words in (["--light", "ambient:1,1,1"], ["--eye", "60,-60,30"], ["--focus", "100", "--f-number", "4"],
              ["--eye", "-60,-60,30", "--look-at", "10,10,1"], ["--integrator", "phong", "--phong", "1,1,1,500,0"],
              ["--light", "ambient:1,1,1", "--light", "point:0,0,90,9,9,9"], ["--up", "0,1,0"],
              ["--focus", "10,10,1", "--f-number", "4"], ["--aov", "normal", "-o", "own.exr"]):
    does(VDBTRACE, *SMALL, *words, "t.vdb")
does(GCODE2VDB, *COARSE, "--filament-diameter", "1.75,1.75", "--features", "-skirt", "--grids", "layer", "t.gcode", "-o", "w.vdb")
refused([VDBTRACE, "t.vdb", *SMALL, "--eye", "1,2"], 2, "--eye 1,2", "X,Y,Z")
refused([VDBTRACE, "t.vdb", *SMALL, "--eye", "1,2,x"], 2, "X,Y,Z")
refused([VDBTRACE, "t.vdb", *SMALL, "--focus", "1,2", "--f-number", "4"], 2, "--focus 1,2", "distance")
refused([VDBTRACE, "t.vdb", *SMALL, "--phong", "1,2"], 2, "SHININESS")
refused([VDBTRACE, "t.gcode", *SMALL, "--tool-offsets", "0,18"], 2, "--tool-offsets 0,18", "0x0,18x0")

# --- what is for G-code alone is not ignored ------------------------------------------------------------------------------
for words in (["--printed", "50%"], ["--layers", "1:2"], ["--features", "-skirt"], ["--object", "1"], ["--voxel-size", "0.1"],
              ["--voxels-per-layer", "2"], ["--tolerance", "0.1"], ["--memory-budget", "1GB"], ["--half-width", "3"],
              ["--plate", "1"], ["--filament-diameter", "1.75"], ["--layer-height", "0.2"], ["--e-mode", "auto"], ["--tool-offsets", "0x0,18x0"],
              ["--firmware", "marlin"], ["--progress-series", "3"]):
    refused([VDBTRACE, "t.vdb", *SMALL, *words], 2, words[0] + ": needs G-code", "t.vdb is a level set", "the print itself")
refused([VDBTRACE, "t.vdb", "--printed", "50%"], 2, "gcode2vdb --snapshots")
refused([VDBTRACE, "t.vdb", "--brick-picture", "b.png"], 2, "--brick-picture: is no option any more", "--stats")
with open(path("scene.json"), "w", encoding="utf-8") as file:
    file.write('{"print": "t.vdb", "spp": 1, "size": [32, 24]}')
refused([VDBTRACE, "scene.json", "--layers", "1:2"], 2, "--layers: needs G-code")
does(VDBTRACE, "t.gcode", *SMALL, *COARSE, "--printed", "50%", "-o", "half.png")

# --- what only one integrator, printer or kind of output uses -----------------------------------------------------------
for words, user in ((["--phong", "1,1,1,500,0"], "phong"), (["--ao-distance", "2"], "ao"), (["--bounces", "2"], "path"),
                    (["--exact-translucency"], "path")):
    for integrator in ("path", "direct", "phong", "ao", "normal", "depth"):
        command = [VDBTRACE, "t.vdb", *SMALL, "--integrator", integrator, *words]
        if integrator == user:
            does(*command)
        else:
            refused(command, 2, words[0], f"expected integrator {user}; {integrator} does not use it")
with open(path("scene.json"), "w", encoding="utf-8") as file:
    file.write('{"print": "t.vdb", "spp": 1, "size": [32, 24], "integrator": {"name": "path", "ao_distance": 3}}')
does(VDBTRACE, "scene.json")
does(VDBTRACE, "scene.json", "--integrator", "ao")
refused([VDBTRACE, "t.gcode", *SMALL, *COARSE, "--grid", "surface"], 2, "t.gcode: is G-code, which has no grid surface")
for words in (["--pressure-advance", "0.05"], ["--strings"]):
    refused([GCODE2VDB, "t.gcode", *COARSE, *words], 2, words[0], "printer typical, or a flow_lag")
    does(GCODE2VDB, "t.gcode", *COARSE, *words, "--flow-lag", "0.05")
for output in ("p.vdb", "p.nvdb", "p.inp"):
    for words in (["--faces", "1000"], ["--mesh-error", "0.5"]):
        refused([GCODE2VDB, "t.gcode", *COARSE, "-o", output, *words], 2, f"{words[0]}: is for meshes: .stl")
for output in ("p.stl", "p.inp"):
    for words in (["--precision", "half"], ["--compression", "zip"], ["--usda"]):
        refused([GCODE2VDB, "t.gcode", *COARSE, "-o", output, *words], 2, f"{words[0]}: is for volumes: a .vdb")
refused([GCODE2VDB, "t.gcode", *COARSE, "-o", "p.nvdb", "--usda"], 2, "--usda: is for a .vdb")
refused([GCODE2VDB, "t.gcode", *COARSE, "--forecast"], 2, "--forecast", "--stats")
refused([GCODE2VDB, "t.gcode", *COARSE, "--forecast", "--stats", "s.json", "--interior", "cull"], 2, "--forecast: is of a level set")

# --- no output is an input, nor another output ---------------------------------------------------------------------------
os.link(path("t.gcode"), path("hard.csv"))
os.symlink("t.gcode", path("soft.csv"))
refused([VDBTRACE, "t.gcode", "u.gcode", "--stats", "t.gcode", *SMALL], 2, "--stats t.gcode: is an input")
refused([VDBTRACE, "--stats", "t.gcode", "u.gcode", *SMALL], 2, "t.gcode: is there already", "--force")
refused([GCODE2VDB, "t.gcode", "--dump-toolpath", "./t.gcode"], 2, "--dump-toolpath ./t.gcode", "the input t.gcode")
for name in ("hard.csv", "soft.csv"):
    refused([GCODE2VDB, "t.gcode", *COARSE, "-o", "n.vdb", "--dump-toolpath", name], 2, f"--dump-toolpath {name}", "the input t.gcode")
refused([GCODE2VDB, "t.gcode", *COARSE, "--stats", path("t.gcode")], 2, "--stats", "the input t.gcode")
refused([GCODE2VDB, "t.gcode", *COARSE, "-o", "n.vdb", "--stats", "n.vdb"], 2, "--stats n.vdb", "different names")
refused([GCODE2VDB, "t.gcode", *COARSE, "-o", "n.vdb", "--stats", "x.json", "--dump-toolpath", "./x.json"], 2, "x.json", "different names")
os.link(path("t.vdb"), path("also.vdb"))
refused([GCODE2VDB, "also.vdb", "-o", "t.vdb"], 2, "-o t.vdb", "the input also.vdb")
for option in ("--stats", "--checkpoint"):
    refused([VDBTRACE, "t.vdb", *SMALL, option, "t.vdb"], 2, f"{option} t.vdb: is an input")
refused([VDBTRACE, "t.vdb", *SMALL, "-o", "p.png", "--stats", "p.png"], 2, "different names")
refused([VDBTRACE, "t.vdb", *SMALL, "-o", "p.exr", "--write-brdf", "p.exr"], 2, "different names")
refused([VDBTRACE, "t.vdb", *SMALL, "-o", "p.png", "--turntable", "2", "--stats", "p_001.png"], 2, "different names")
refused([VDBTRACE, "scene.json", "--stats", "t.vdb"], 2, "--stats t.vdb: is an input")
refused([VDBTRACE, "scene.json", "--stats", "scene.json", "--force"], 2, "--stats scene.json: is an input")
shutil.copy(gcode("tile.gcode"), path("s_050pct.vdb"))  # G-code by its content
refused([GCODE2VDB, "s_050pct.vdb", "-o", "s.vdb", *COARSE, "--snapshots", "50%"], 2, "s_050pct.vdb", "is an input")
refused([VDBSTUDY, "memory", "t.gcode", "-o", "studies", "--stats", "t.gcode"], 2, "--stats t.gcode: is an input")
check(not os.path.exists(path("studies")), "  no folder is made either")

# --- presets come before files of their names --------------------------------------------------------------------------------
os.mkdir(path("studio"))
for name in ("sky", "pla-blue", "constant:1,1,1"):
    with open(path(name), "w", encoding="utf-8") as file:
        file.write("neither light nor material")
does(VDBTRACE, "t.vdb", *SMALL)
for words in (["--env", "sky"], ["--brdf", "pla-blue"], ["--env", "constant:1,1,1"]):
    does(VDBTRACE, "t.vdb", *SMALL, *words)
refused([VDBTRACE, "t.vdb", *SMALL, "--env", "./sky"], 3, "sky")
with open(path("presets.json"), "w", encoding="utf-8") as file:
    file.write('{"print": "t.vdb", "spp": 1, "size": [32, 24], "material": "pla-blue", "environment": {"map": "sky"}}')
does(VDBTRACE, "presets.json")

# --- slips of the finger -------------------------------------------------------------------------------------------------------
for command, guess in (([VDBTRACE, "t.vdb", "--vew", "front"], "'--view'"), ([VDBTRACE, "t.vdb", "--view", "frnt"], "'front'"),
                       ([VDBTRACE, "t.vdb", "--integrator", "pth"], "'path'"), ([VDBTRACE, "t.vdb", "--env", "studo"], "'studio'"),
                       ([VDBTRACE, "t.vdb", "--brdf", "pla-bleu"], "'pla-blue'"), ([VDBTRACE, "t.vdb", "--march", "brik"], "'brick'"),
                       ([VDBTRACE, "t.vdb", "--light", "pont:1,1,1,1,1,1"], "'point'"),
                       ([VDBTRACE, "t.vdb", "-o", "p.exr", "--aov", "normals"], "'normal'"),
                       ([GCODE2VDB, "t.gcode", "--voxelsize=0.2"], "'--voxel-size'"),
                       ([GCODE2VDB, "t.gcode", "--features", "-skrt"], "'skirt'"), ([GCODE2VDB, "t.gcode", "--grids", "layr"], "'layer'"),
                       ([GCODE2VDB, "t.gcode", "--firmware", "klippr"], "'klipper'"), ([GCODE2VDB, "t.gcode", "--unit", "mmm"], "'mm'"),
                       ([VDBSTUDY, "memry", "t.gcode", "-o", "x"], "'memory'"),
                       ([VDBSTUDY, "memory", "t.gcode", "-o", "x", "--quik"], "'--quick'")):
    refused(command, 2, f"did you mean {guess}?")
refused([VDBTRACE, "t.vdb", "-o=a.png"], 2, "-o a.png", "--output=a.png")
refused([VDBSTUDY, "memory", "t.gcode", "-o=x"], 2, "--output=x")
does(GCODE2VDB, "t.gcode", "-o", "iec.vdb", "--memory-budget", "64MiB")

# --- greeting ---------------------------------------------------------------------------------------------------------------------
for tool in (GCODE2VDB, VDBTRACE, VDBSTUDY):
    name = os.path.basename(tool)
    done = call(tool)
    check(done.returncode == 2 and done.stdout == "" and len(done.stderr.splitlines()) <= 20, f"{name} alone: a short usage\n{done.stderr}")
    check("Usage: " + name in done.stderr and f"{name} -h" in done.stderr and done.stderr.count(f"  {name} ") >= 3, "  with examples")
    lines = does(tool, "-h").stdout.splitlines()
    check(len(lines) <= 60, f"{name} -h: {len(lines)} lines")

# --- messages tell the truth -------------------------------------------------------------------------------------------------------
with open(path("prose.vdb"), "w", encoding="utf-8") as file:
    file.write("Dear reader, this is no level set.\n")
refused([VDBTRACE, "prose.vdb", *SMALL], 3, "prose.vdb: is no OpenVDB file")
done = call(VDBTRACE, "s_050pct.vdb", *SMALL, *COARSE, "-o", "named.png")
check(done.returncode == 0, f"G-code under the name of a level set is G-code all the same: {done.stderr.strip()}")
shutil.rmtree(FOLDER)

"""Pictures and films in shards: the bytes of one process, whatever is killed, and no half of a picture."""

import os
import re
import shutil
import signal
import subprocess
import time

from run_tools import BIN, SOURCE, Scratch, check, gcode

SCRATCH = Scratch("shard")
FOLDER, path, call, does, contents, same = SCRATCH.folder, SCRATCH.path, SCRATCH.call, SCRATCH.does, SCRATCH.contents, SCRATCH.same
VDBTRACE = os.path.join(BIN, "vdbtrace")
VDBMERGE = os.path.join(BIN, "vdbmerge")
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
SCRIPTS = os.path.join(SOURCE, "scripts", "slurm")
TILE = gcode("tile.gcode")
SMALL = ["--size", "160x120", "--voxels-per-layer", "2", "--quiet"]
# For the default material and light, the denoiser and an exposure that fits the light, each process makes tables, which
# take longer than a shard of a small picture.
PLAIN = ["--brdf", "lambert:0.8,0.5,0.3", "--env", "constant:1,1,1"]
NOISY = [*PLAIN, "--no-denoise", "--exposure", "1"]
# Of every kind of picture with STRATUM_LONG=1, else of the first.
COUNTS = (1, 2, 7)
LONG_RUN = "STRATUM_LONG" in os.environ
SLURM = {name: value for name, value in os.environ.items() if not name.startswith("SLURM_")}


def refused(status, fragments, *command, env=None):
    before = contents()
    done = call(*command, env=env)
    text = done.stderr.strip()
    label = " ".join(map(os.path.basename, command[:4]))
    check(done.returncode == status, f"{label} ...: exit {done.returncode}: {text}")
    for fragment in fragments:
        check(fragment in text, f"  says {fragment!r}")
    check(contents() == before, "  and every file is as it was")


def parts(stem, count, ending="exr"):
    return [f"{stem}.{n}of{count}.{ending}" for n in range(count)]


def trace(output, *options, shard=None, env=None):
    return does(VDBTRACE, TILE, *SMALL, "-o", output, *options, *(["--shard", shard] if shard else []), env=env)


# --- pieces of a picture: the table of docs/many_machines.md --------------------------------------------------------------
PICTURES = (
    ("path, denoised", "path.png", ["--spp", "2"]),
    ("ambient occlusion", "ao.exr", ["--integrator", "ao", "--spp", "2"]),
    ("layers", "layers.exr", [*PLAIN, "--spp", "2", "--aov", "normal,depth,albedo,mask,variance,samples,layer,feature"]),
    ("denoised, with layers", "clean.exr", [*PLAIN, "--spp", "2", "--denoise", "--aov", "samples"]),
    ("depth of field", "lens.png", [*NOISY, "--spp", "2", "--f-number", "2", "--view", "front"]),
    ("adaptive samples", "noise.exr", [*PLAIN, "--spp", "32", "--noise", "0.1", "--integrator", "direct", "--aov", "samples"]),
    ("a crop, denoised", "crop.png", [*PLAIN, "--spp", "2", "--crop", "30,20,130,100"]),
    ("a crop, adaptive", "some.png", [*NOISY, "--spp", "32", "--noise", "0.1", "--crop", "40,40,120,100"]),
    ("a legend", "legend.png", ["--no-denoise", "--exposure", "1", "--spp", "2", "--color-by", "feature", "--legend"]),
    ("depth", "depth.png", ["--spp", "2", "--integrator", "depth"]),
    ("a given exposure", "bright.png", [*PLAIN, "--spp", "2", "--exposure", "0.7", "--seed", "3"]),
)
for n, (what, name, options) in enumerate(PICTURES):
    whole = "whole_" + name
    trace(whole, *options)
    for count in COUNTS if n == 0 or LONG_RUN else COUNTS[-1:]:
        stem, ending = os.path.splitext(name)
        for index in range(count):
            trace(name, *options, shard=f"{index}/{count}")
        check(not os.path.exists(path(name)), "a shard writes its part alone")
        does(VDBMERGE, name, *reversed(parts(stem, count)), "--quiet")
        check(same(name, whole), f"| {what} | {name} | {count} | the same bytes |")
        os.remove(path(name))
        for part in parts(stem, count):
            os.remove(path(part))

# --- many pieces: one tile each -------------------------------------------------------------------------------------------
SIDE = 8 if LONG_RUN else 4  # tiles of 32 x 32 pixels
MANY = [VDBTRACE, TILE, "--size", f"{32 * SIDE}x{32 * SIDE}", "--voxels-per-layer", "2", *NOISY, "--spp", "2", "--quiet"]
does(*MANY, "-o", "whole_many.png")
for index in range(SIDE * SIDE):
    does(*MANY, "-o", "many.png", "--shard", f"{index}/{SIDE * SIDE}")
does(VDBMERGE, "many.png", *parts("many", SIDE * SIDE), "--quiet")
check(same("many.png", "whole_many.png"), f"| path | many.png | {SIDE * SIDE} | the same bytes |")

# --- pieces of every picture of a series ----------------------------------------------------------------------------------
TURN = [*NOISY, "--spp", "2", "--turntable", "2"]
trace("turn.png", *TURN)
for index in range(3):
    trace("cut.png", *TURN, "--shard-by", "tiles", shard=f"{index}/3")
for n in range(2):
    does(VDBMERGE, "merged.png", *parts(f"cut_00{n}", 3), "--quiet")
    check(same("merged.png", f"turn_00{n}.png"), f"picture {n} of a series in pieces")
refused(3, ["cut_001.1of3.exr", "another scene"], VDBMERGE, "no.png", "cut_000.0of3.exr", "cut_001.1of3.exr", "cut_000.2of3.exr")

# --- what a merge refuses -------------------------------------------------------------------------------------------------
BASE = [*NOISY, "--spp", "2"]
for index in range(3):
    trace("p.png", *BASE, shard=f"{index}/3")
    trace("linear.exr", *BASE, shard=f"{index}/3")
trace("other.png", *BASE, "--seed", "1", shard="1/3")
for index in range(2):
    trace("p.png", *BASE, shard=f"{index}/2")
P = parts("p", 3)
refused(3, ["shard 1 of 3 is missing", "--shard 1/3"], VDBMERGE, "no.png", P[0], P[2])
refused(3, ["shard 0 of 3 is missing", "shard 2 of 3 is missing"], VDBMERGE, "no.png", P[1])
refused(3, ["p.0of3.exr: is shard 0 of 3", "name each once"], VDBMERGE, "no.png", *P, P[0])
refused(3, ["other.1of3.exr: is of another scene", "shard 1 of 3 is missing"], VDBMERGE, "no.png", P[0], "other.1of3.exr", P[2])
refused(3, ["p.1of2.exr: is one of 2 shards, not of 3"], VDBMERGE, "no.png", *P, "p.1of2.exr")
refused(3, ["linear.1of3.exr: is of another scene"], VDBMERGE, "no.png", P[0], "linear.1of3.exr", P[2])
refused(3, ["gone.exr"], VDBMERGE, "no.png", *P[:2], "gone.exr")
trace("plain.exr", *BASE)
refused(3, ["plain.exr: is no part of a picture"], VDBMERGE, "no.png", *P, "plain.exr")
refused(3, ["tile.gcode: is no OpenEXR"], VDBMERGE, "no.png", *P, TILE)
with open(path(P[1]), "rb") as file:
    part = file.read()
for name, damaged in (("cut.exr", part[: len(part) * 2 // 3]), ("end.exr", part[:-1]), ("head.exr", part[:300]),
                      ("crc.exr", re.sub(rb'"crc":(.)', lambda found: b'"crc":' + (b"2" if found[1] == b"1" else b"1"), part)),
                      ("place.exr", part.replace(b'"index":1', b'"index":2', 1)),
                      ("text.exr", part.replace(b'"format"', b'"farmot"', 1)),
                      ("version.exr", part.replace(b'"version":"0', b'"version":"9', 1))):
    with open(path(name), "wb") as file:
        file.write(damaged)
    refused(3, [name], VDBMERGE, "no.png", P[0], name, P[2])
refused(2, ["the parts are of a picture to look at"], VDBMERGE, "no.exr", *P)
refused(2, ["the parts are of an .exr"], VDBMERGE, "no.png", *parts("linear", 3))
refused(2, ["no.gif"], VDBMERGE, "no.gif", *P)
refused(2, ["is an input"], VDBMERGE, P[0], *P)

# --- what a shard refuses ---------------------------------------------------------------------------------------------------
for shard, fragment in (("3/3", "must be from 0 to 2"), ("-1/3", "must be from 0 to 2"), ("0/0", "N must be from 1"),
                        ("1", "expected I/N"), ("a/b", "expected I/N"), ("0/3x", "expected I/N"), ("0/21", "has 20 tiles")):
    refused(2, [fragment], VDBTRACE, TILE, *SMALL, "-o", "no.png", f"--shard={shard}")
refused(2, ["series has 5 pictures"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--turntable", "5", "--shard", "0/6")
refused(2, ["standard output"], VDBTRACE, TILE, *SMALL, "-o", "-", "--shard", "0/2")
refused(2, ["--time"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--time", "1", "--shard", "0/2")
refused(2, ["samples are no longer shared; use tiles"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--shard", "0/4", "--shard-by", "samples")
refused(2, ["--resume requires --shard"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--resume")
refused(2, ["SLURM_ARRAY_TASK_ID"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--shard", "slurm", env=SLURM)
GAPS = dict(SLURM, SLURM_ARRAY_TASK_ID="5", SLURM_ARRAY_TASK_MIN="1", SLURM_ARRAY_TASK_MAX="9", SLURM_ARRAY_TASK_COUNT="3")
refused(2, ["has gaps"], VDBTRACE, TILE, *SMALL, "-o", "no.png", "--shard", "slurm", env=GAPS)
does(VDBTRACE, TILE, *SMALL, *NOISY, "-o", "gap.png", "--shard", "slurm/6", env=GAPS)
check(any(name.startswith("gap.5of6") for name in os.listdir(FOLDER)), "an array with gaps makes some of N shards by slurm/N")

# --- an array of Slurm ------------------------------------------------------------------------------------------------------
trace("whole.png", *BASE)
for task in range(4, 7):
    array = dict(SLURM, SLURM_ARRAY_TASK_ID=str(task), SLURM_ARRAY_TASK_MIN="4", SLURM_ARRAY_TASK_MAX="6", SLURM_ARRAY_TASK_COUNT="3")
    does("bash", os.path.join(SCRIPTS, "picture.sh"), TILE, *SMALL[:-1], "-o", "slurm.png", *BASE, env=array)
    does("bash", os.path.join(SCRIPTS, "film.sh"), TILE, *SMALL[:-1], "-o", "film.png", *NOISY, "--spp", "1", "--turntable", "3", env=array)
check(sorted(name for name in os.listdir(FOLDER) if name.startswith("film_")) == [f"film_00{n}.png" for n in range(3)], "film.sh")
does(VDBMERGE, "slurm.png", *parts("slurm", 3), "--quiet")
check(same("slurm.png", "whole.png"), "tasks 4 to 6 of an array are the shards 0 to 2")

# --- resumed: only what is there, whole, and of this scene is skipped -----------------------------------------------------
def resumed(*options, shard="1/3"):
    done = does(VDBTRACE, TILE, *SMALL[:-1], "-o", "p.png", *BASE, *options, "--shard", shard, "--resume")
    return "skipped" in done.stdout


def age():
    return os.stat(path(P[1])).st_ino


before = age()
check(resumed() and age() == before, "a part that is there is skipped")
check(resumed("--threads", "1") and age() == before, "  for any number of threads")
for name in ("cut.exr", "crc.exr", "version.exr", "place.exr"):
    shutil.copy(path(name), path(P[1]))
    check(not resumed(), f"{name}: another or damaged part is traced again")
    with open(path(P[1]), "rb") as file:
        check(file.read() == part, "  to the same bytes")
check(not resumed("--seed", "9"), "another seed is traced again")
check(not resumed(), "and the first one, too")
with open(path("tile.gcode"), "wb") as target, open(TILE, "rb") as source:
    target.write(source.read() + b"\n; the same print\n")
done = does(VDBTRACE, "tile.gcode", *SMALL[:-1], "-o", "p.png", *BASE, "--shard", "1/3", "--resume")
check("skipped" not in done.stdout, "another file of the same name is traced")
check(not resumed(), "and the first one again")

# --- killed at any moment, and repeated -----------------------------------------------------------------------------------
LONG = [VDBTRACE, TILE, *SMALL, "-o", "killed.png", *NOISY, "--spp", "64", "--resume", "--shard"]
trace("long.png", *NOISY, "--spp", "64")
kills = 0
for index in range(3):
    for delay in (0.05, 0.1, 0.2, 0.3):
        process = subprocess.Popen([*LONG, f"{index}/3"], cwd=FOLDER)
        time.sleep(delay)
        process.send_signal(signal.SIGKILL)
        kills += process.wait() == -signal.SIGKILL
        if os.path.exists(path(parts("killed", 3)[index])):
            break
    does(*LONG, f"{index}/3")
does(VDBMERGE, "killed.png", *parts("killed", 3), "--quiet")
check(kills > 0 and same("killed.png", "long.png"), f"{kills} kills, the same picture")

# --- a checkpoint each ------------------------------------------------------------------------------------------------------
for index in range(2):
    trace("kept.png", *BASE, "--checkpoint", path("kept.state"), shard=f"{index}/2")
does(VDBMERGE, "kept.png", *parts("kept", 2), "--quiet")
check(same("kept.png", "whole.png") and not any("state" in name for name in os.listdir(FOLDER)), "--checkpoint in shards")

# --- frames of a film -------------------------------------------------------------------------------------------------------
def film(stem, count, shards, inputs, *options):
    """A series by one process, and in shards: the same names and bytes."""
    for index in [None, *range(shards)]:
        folder = path(f"{stem}_whole" if index is None else f"{stem}_shards")
        os.makedirs(folder, exist_ok=True)
        before = len(os.listdir(folder))
        share = [] if index is None else ["--shard", f"{index}/{shards}"]
        output = folder if "--each" in options else os.path.join(folder, "f.png")
        does(VDBTRACE, *inputs, "--size", "64x48", "--spp", "2", "--quiet", "-o", output, *options, *share)
        made = len(os.listdir(folder)) - before
        expected = count if index is None else count * (index + 1) // shards - count * index // shards
        check(made == expected, f"{stem}, shard {index} of {shards}: {made} pictures")
    names = sorted(os.listdir(path(f"{stem}_whole")))
    check(names == sorted(os.listdir(path(f"{stem}_shards"))), f"{stem}: {', '.join(names)}")
    check(all(same(f"{stem}_whole/{name}", f"{stem}_shards/{name}") for name in names), f"{stem} in {shards} shards: the same bytes")
    shutil.rmtree(path(f"{stem}_whole"))
    shutil.rmtree(path(f"{stem}_shards"))


COARSE = ["--voxels-per-layer", "2", *NOISY]
film("turntable", 5, 2, [TILE], "--turntable", "5", *COARSE)
film("growing", 4, 3, [TILE], "--progress-series", "4", *COARSE)
film("grown", 6, 4, [TILE], "--progress-series", "3", "--turntable", "2", *COARSE)
OTHERS = [TILE, gcode("tile_arcs.gcode"), gcode("tile_absolute.gcode")]
film("inputs", 3, 3, OTHERS, *COARSE)
film("each", 3, 2, OTHERS, "--each", *COARSE)

# --- a film that is killed and resumed --------------------------------------------------------------------------------------
FILM = [TILE, "--size", "96x72", "--spp", "8", "--turntable", "6", *COARSE]
does(VDBTRACE, *FILM, "-o", "film.png", "--quiet")
SHARDS = [[VDBTRACE, *FILM, "-o", "again.png", "--resume", "--shard", f"{index}/2"] for index in range(2)]
kills = 0
for index, first in ((0, 0), (1, 3)):
    process = subprocess.Popen(SHARDS[index], cwd=FOLDER, stdout=subprocess.DEVNULL)
    while process.poll() is None and not os.path.exists(path(f"again_00{first + 1}.png")):
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    kills += process.wait() == -signal.SIGKILL
    done = does(*SHARDS[index])
    check("again_00" in done.stdout and done.stdout.count("skipped") in (1, 2, 3), f"shard {index}: {done.stdout.count('skipped')} skipped")
    check(does(*SHARDS[index]).stdout.count("skipped") == 3, "  all of it, the third time")
check(kills > 0 and all(same(f"film_00{n}.png", f"again_00{n}.png") for n in range(6)), f"{kills} kills, the same film")
with open(path("again_004.png"), "wb") as file:
    file.write(b"something else")
check(call(*SHARDS[1]).returncode == 2, "a picture of somebody else is not made again")
check(does(*SHARDS[1], "--force").stdout.count("skipped") == 2 and same("film_004.png", "again_004.png"), "  unless it may be")
check(does(*SHARDS[1], "--seed", "4").stdout.count("skipped") == 0, "another scene is made again")

# --- what had shards before ------------------------------------------------------------------------------------------------
refused(2, ["--shard: is no option any more", "one process"], GCODE2VDB, TILE, "-o", "no.vdb", "--shard", "0/2", "--resume")
refused(2, ["no.vdb: a level set has no parts"], VDBMERGE, "no.vdb", *P)

shutil.rmtree(FOLDER)

"""What a picture shows when nobody asks: the colours that the file states, and the part without what is beside it."""

import json
import os
import shutil
import subprocess

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("defaults")
FOLDER, path, call = SCRATCH.folder, SCRATCH.path, SCRATCH.call
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
SMALL = ["--size", "64x48", "--spp", "1", "--quiet"]


def report(source, *options, output="p.png"):
    done = call(VDBTRACE, source, "-o", path(output), *SMALL, "--stats", "-", *options)
    check(done.returncode == 0, f"{os.path.basename(source)} {' '.join(options)}: exit {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def colors(stats):
    return [entry["color"] for entry in stats["material"].get("colors", [])]


def skips_lookup(stats):
    return any(entry["what"] == "colour of each place" for entry in stats["skipped"])


# --- one colour in the file: a plain material, and nothing to look up ---------------------------------------------------
G = ["--voxels-per-layer", "2"]
tile = report(gcode("tile.gcode"), *G)
check(colors(tile) == ["#d8563b"] and tile["material"]["brdf"] == "#d8563b", f"one colour: {tile['material']}")
check("settings" in tile["material"]["colors"][0]["from"] and skips_lookup(tile), "where it is from, and no lookup")

# --- samples: a small picture gets more, an .exr is not denoised ---------------------------------------------------------
def samples(size, output="p.png"):
    done = call(VDBTRACE, gcode("tile.gcode"), *G, "-o", path(output), "--size", size, "--crop", "16,16,48,40", "--integrator",
                "direct", "--stats", "-", "--quiet")
    return json.loads(done.stdout)["image"]["spp"]


for size, spp in (("1280x960", 8), ("640x480", 12), ("64x48", 25)):
    check(samples(size) == spp, f"{size}: {spp} samples a pixel")
check(samples("64x48", "p.exr") == 16, "an .exr has 16")

# --- two of them: by place ------------------------------------------------------------------------------------------------
for name in ("two_tone.gcode", "two_tone_mmu.gcode"):
    two = report(gcode(name), *G)
    check(sorted(colors(two)) == ["#1f4e6b", "#f2b33d"] and not skips_lookup(two), f"{name}: two colours: {two['material']}")
    names = [entry["name"] for entry in two["material"]["legend"][0]["colors"]]
    check(names == sorted(colors(two)), f"{name}: the legend names them: {names}")

# --- who asks for a material gets it --------------------------------------------------------------------------------------
for options, brdf in ((["--brdf", "pla-blue"], "pla-blue"), (["--brdf", "red"], "red"), (["--color", "#ff6600"], "#ff6600"),
                      (["--brdf", "lambert:1,1,1"], "lambert:1,1,1")):
    asked = report(gcode("two_tone.gcode"), *G, *options)
    check(asked["material"]["brdf"] == brdf and not colors(asked), f"{' '.join(options)}: {asked['material']}")
check(report(gcode("two_tone.gcode"), *G, "--color-by", "feature")["material"]["legend"][0]["attribute"] == "feature", "--color-by wins")
with open(path("own.json"), "w", encoding="utf-8") as scene:
    json.dump({"print": gcode("two_tone.gcode"), "material": "lambert:1,1,1"}, scene)
check(not colors(report(path("own.json"), *G)), "a scene's material wins")
check(not colors(report(gcode("two_tone.gcode"), *G, "--integrator", "ao")), "who shows no material asks for none")
with open(gcode("tile.gcode"), encoding="utf-8") as source, open(path("silent.gcode"), "w", encoding="utf-8") as target:
    target.writelines(line for line in source if "_colour" not in line)
silent = report(path("silent.gcode"), *G)
check(silent["material"]["brdf"].startswith("plastic:") and not colors(silent), "a file that says nothing is orange")
for options in (["--color", "reddish"], ["--color", "red", "--brdf", "blue"], ["--brdf", "#12"], ["--legend", "-o", path("l.exr")]):
    done = call(VDBTRACE, gcode("tile.gcode"), "-o", path("refused.png"), *SMALL, *G, *options) if "-o" not in options else \
        call(VDBTRACE, gcode("tile.gcode"), *SMALL, *G, *options)
    check(done.returncode == 2, f"{' '.join(options)}: exit {done.returncode}: {done.stderr.strip()}")

# --- level sets: a grid of colours ----------------------------------------------------------------------------------------
done = call(GCODE2VDB, gcode("two_tone.gcode"), "-o", path("two.vdb"), "--quiet", *G, "--grids", "color")
check(done.returncode == 0, f"gcode2vdb: {done.stderr.strip()}")
two = report(path("two.vdb"))
check(sorted(colors(two)) == ["#1f4e6b", "#f2b33d"], f"the grid color: {two['material']}")
done = call(GCODE2VDB, gcode("tile.gcode"), "-o", path("tile.vdb"), "--quiet", *G, "--grids", "color")
one = report(path("tile.vdb"))
check(colors(one) == ["#d8563b"] and skips_lookup(one), f"a grid of one colour is not asked at each place: {one['material']}")

# --- the frame is the part's: a skirt far away changes nothing but itself ------------------------------------------------
def eye_of(*options):
    """A picture of depths: the same one only from the same place."""
    report(gcode("hull.gcode"), *G, "--integrator", "depth", "--no-bed", *options, output="depth.exr")
    with open(path("depth.exr"), "rb") as file:
        return file.read()


ALONE = ["--features", "-skirt,-brim"]
check(eye_of(*ALONE) == eye_of(*ALONE, "--zoom", "1"), "the same camera")
check(eye_of("--view", "top") != eye_of("--view", "top", "--frame", "all"), "--frame all takes the skirt in")
done = call(GCODE2VDB, gcode("hull.gcode"), "-o", path("hull.vdb"), "--quiet", *G)
check(done.returncode == 0, f"gcode2vdb: {done.stderr.strip()}")
report(path("hull.vdb"), "--integrator", "depth", "--no-bed", output="from_vdb.exr")
report(gcode("hull.gcode"), *G, "--integrator", "depth", "--no-bed", output="from_gcode.exr")


def pixels(name):
    with open(path(name), "rb") as file:
        data = file.read()
    return data[-1000:]


check(pixels("from_vdb.exr") == pixels("from_gcode.exr"), "the level set's frame is that of its G-code")

# --- a checkpoint of another file is refused, however alike both look -----------------------------------------------------
with open(gcode("tile.gcode"), "rb") as source:
    text = source.read()
with open(path("again.gcode"), "wb") as target:
    target.write(text)
with open(path("other.gcode"), "wb") as target:
    target.write(text + b"\n; the same print\n")
KEPT = ["--size", "96x64", "--spp", "256", "--quiet", *G, "--checkpoint", path("kept")]
process = subprocess.Popen([VDBTRACE, path("again.gcode"), "-o", path("c.png"), *KEPT], stdout=subprocess.DEVNULL)
while process.poll() is None and not os.path.exists(path("kept")):
    pass
process.kill()
process.wait()
check(os.path.exists(path("kept")), "a checkpoint is there")
done = call(VDBTRACE, path("other.gcode"), "-o", path("c.png"), *KEPT)
check(done.returncode == 3 and "another picture" in done.stderr, f"another file: exit {done.returncode}: {done.stderr.strip()}")
done = call(VDBTRACE, path("again.gcode"), "-o", path("c.png"), *KEPT, "--threads", "1")
check(done.returncode == 0, f"the same file with other threads goes on: {done.stderr.strip()}")

# --- a legend ---------------------------------------------------------------------------------------------------------------
stats = report(gcode("tile.gcode"), *G, "--color-by", "speed", "--legend")
legend = stats["material"]["legend"][0]
check(legend["unit"] == "mm/s" and legend["least"] < legend["most"] and len(legend["ramp"]) == 3, f"a ramp: {legend}")
with open(path("p.png"), "rb") as file:
    with_legend = file.read()
legend = report(gcode("tile.gcode"), *G, "--color-by", "speed", "--color-range", "10,30.5")["material"]["legend"][0]
check((legend["least"], legend["most"]) == (10, 30.5), f"its ends as they are given: {legend}")
for words, fragment in ((["--color-by", "speed", "--color-range", "30,10"], "MIN"), (["--color-range", "1,2"], "--color-by")):
    done = call(VDBTRACE, gcode("tile.gcode"), "-o", path("r.png"), *G, *words)
    check(done.returncode == 2 and fragment in done.stderr, f"{words}: exit {done.returncode}: {done.stderr.strip()}")
report(gcode("tile.gcode"), *G, "--color-by", "speed")
with open(path("p.png"), "rb") as file:
    check(file.read() != with_legend, "it is in the picture")

shutil.rmtree(FOLDER)

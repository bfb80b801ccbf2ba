"""vdbtrace --background none: alpha in every kind of picture, with the shadow; the same from shards and scenes."""

import json
import os
import shutil
import subprocess

from png_file import png_pixels
from run_tools import BIN, Scratch, check, gcode, run

SCRATCH = Scratch("background")
FOLDER, path, read = SCRATCH.folder, SCRATCH.path, SCRATCH.read
VDBTRACE = os.path.join(BIN, "vdbtrace")
PICTURE = [gcode("tile.gcode"), "--background", "none", "--size", "80x60", "--voxel-size", "0.1", "--quiet"]


def trace(name, *options):
    run(VDBTRACE, *PICTURE, "-o", path(name), *options)
    return read(name)


def rgba_rows(data):
    """Rows of (R, G, B, A)."""
    _, _, rows = png_pixels(data)
    return [[tuple(row[4 * x:4 * x + 4]) for x in range(len(row) // 4)] for row in rows]


def kinds(rows):
    """Pixels of nothing, of shadow, of the print, and at its edge."""
    pixels = [pixel for row in rows for pixel in row]
    return (sum(p[3] == 0 for p in pixels), sum(0 < p[3] < 250 and max(p[:3]) < 20 for p in pixels),
            sum(p[3] == 255 and max(p[:3]) > 60 for p in pixels))


nothing, shadow, part = kinds(rgba_rows(trace("a.png")))
check(nothing > 500 and shadow > 200 and part > 500, f"PNG: {nothing} pixels of nothing, {shadow} of shadow, {part} of the print")
nothing, shadow, part = kinds(rgba_rows(trace("bare.png", "--no-bed")))
check(nothing > 2000 and shadow < 20 and part > 500, f"  without a bed no shadow: {nothing}, {shadow}, {part}")
for integrator in ("ao", "normal", "phong"):
    rows = rgba_rows(trace("other.png", "--integrator", integrator))
    check(rows[0][0] == (0, 0, 0, 0) and rows[30][40][3] == 255, f"  {integrator}: nothing behind the print")
check(trace("one.png", "--threads", "1") == read("a.png"), "  the same bytes on one thread")
rows = rgba_rows(trace("sky.png", "--env", "sky"))
check(rows[0][0][3] == 0, "  a sky isn't seen either")

# Laid over the bare bed by encoded values, as a browser does it, a shadow is as dark as in the picture with the bed.
options = ["--spp", "64", "--exposure", "0"]
over = rgba_rows(trace("over.png", *options))
run(VDBTRACE, *(word for word in PICTURE if word not in ("--background", "none")), "-o", path("whole.png"), *options)
_, _, whole = png_pixels(read("whole.png"))
bare = whole[59][0]
errors = [bare * (255 - pixel[3]) / 255 - row[3 * x] for row, alphas in zip(whole, over) for x, pixel in enumerate(alphas)
          if 60 < pixel[3] < 250 and max(pixel[:3]) < 6]
check(len(errors) > 30 and abs(sum(errors) / len(errors)) < 12, f"  {len(errors)} pixels of shadow over the bed: {sum(errors) / len(errors):.1f} of 255")

webp = trace("a.webp")
check(webp[12:16] == b"VP8X" and webp[20] & 0x10, "WebP says that it has alpha")
exr = trace("a.exr", "--spp", "8")
check(exr[:4] == b"\x76\x2f\x31\x01" and b"A\0" in exr[:400], "EXR has a channel A")

for n in range(3):
    run(VDBTRACE, *PICTURE, "-o", path("shard.png"), "--shard", f"{n}/3")
run(os.path.join(BIN, "vdbmerge"), path("merged.png"), *[path(f"shard.{n}of3.exr") for n in range(3)], "--quiet")
check(rgba_rows(read("merged.png")) == rgba_rows(read("a.png")), "--shard: the same pixels")

with open(path("scene.json"), "w", encoding="utf-8") as file:
    json.dump({"print": gcode("tile.gcode"), "size": [80, 60], "background": "none"}, file)
done = subprocess.run([VDBTRACE, path("scene.json"), "-o", path("scene.png"), "--voxel-size", "0.1", "--quiet"],
                      capture_output=True, text=True)
check(done.returncode == 0 and kinds(rgba_rows(read("scene.png")))[1] > 200, f"a scene: {done.stderr.strip()}")


def refused(status, *arguments, fragments):
    done = subprocess.run([VDBTRACE, *arguments], capture_output=True, text=True)
    check(done.returncode == status and all(text in done.stderr for text in fragments), done.stderr.strip())


refused(2, *PICTURE, "-o", path("refused.jpg"), fragments=("has no alpha", ".png"))
refused(2, *PICTURE, "-o", path("refused.png"), "--color-by", "layer", "--legend", fragments=("--legend", "--background none"))
refused(2, gcode("tile.gcode"), "--background", "noone", "-o", path("refused.png"), fragments=("scene", "none"))
check(not any(name.startswith("refused") for name in os.listdir(FOLDER)), "nothing is left of what was refused")
shutil.rmtree(FOLDER)

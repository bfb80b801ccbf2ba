"""Scenes of several objects, colours by attributes, lenses, turntables and series, through the tool."""

import json
import os
import zlib

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("scene")
FOLDER, path, call, read = SCRATCH.folder, SCRATCH.path, SCRATCH.call, SCRATCH.read
VDBTRACE = os.path.join(BIN, "vdbtrace")
SMALL = ("--size", "64x48", "--spp", "1", "--quiet")


def trace(name, *options):
    done = call(VDBTRACE, *options, *SMALL, "-o", path(name))
    check(done.returncode == 0, f"{name}: {done.stderr.strip() or 'drawn'}")
    return read(name)


def scene(name, **keys):
    with open(path(name), "w", encoding="utf-8") as file:
        json.dump(keys, file)
    return path(name)


check(call(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "--voxel-size", "0.1", "--grids", "layer,tool,feature,speed,color",
           "--quiet", "-o", path("tile.vdb")).returncode == 0, "a tile with attributes")
check(call(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "--voxel-size", "0.1", "--up", "y", "--quiet", "-o",
           path("tile_y.vdb")).returncode == 0, "a tile whose up is y")

def pixels(png):
    """What a .png has besides its texts, which name the input."""
    at, data = 8, b""
    while at < len(png):
        length = int.from_bytes(png[at:at + 4], "big")
        if png[at + 4:at + 8] == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    return data


# One object in its place is the print alone, to the bit.
alone = scene("same.json", objects=[{"vdb": "tile.vdb", "transform": {"rotate": [0, 0, 0]}}])
plain = pixels(trace("plain.png", "tile.vdb"))
check(len(plain) > 1000 and pixels(trace("same.png", alone)) == plain, "a scene of one object in its place")

# A y-up file says so and stands upright; told that its z is up, it lies on its back until a transform turns it.
def apart(a, b):
    """Share of the bytes of two pictures of one size that differ."""
    a, b = zlib.decompress(pixels(a)), zlib.decompress(pixels(b))
    return sum(x != y for x, y in zip(a, b)) / len(a)


mask = ("--integrator", "mask")
standing = trace("mask.png", "tile.vdb", *mask)
check(apart(standing, trace("mask_y.png", "tile_y.vdb", *mask)) < 0.01, "a y-up file stands upright by itself")
check(apart(standing, trace("mask_z.png", "tile_y.vdb", *mask, "--file-up", "z")) > 0.01, "--file-up z lays it down")
upright = scene("upright.json", objects=[{"vdb": "tile_y.vdb", "file_up": "z", "transform": {"rotate": [90, 0, 0]}}])
check(apart(standing, trace("mask_t.png", upright, *mask)) < 0.01, "and a transform sets it upright again")
# Beds have lines and grains of a size in mm, whatever the file's unit and whichever of its axes is up.
on_grid = trace("grid.png", "tile.vdb", "--bed-surface", "grid")
check(apart(on_grid, trace("pei.png", "tile.vdb", "--bed-surface", "pei")) > 0.1, "a grid and a bumpy sheet are two beds")
check(call(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "--voxel-size", "0.1", "--unit", "m", "--up", "y", "--quiet", "-o",
           path("tile_m.vdb")).returncode == 0, "a tile in metres whose up is y")
in_metres = scene("metres.json", print="tile_m.vdb", bed_surface="grid")
check(apart(on_grid, trace("grid_m.png", in_metres)) < 0.02, "the same grid under a y-up file in metres")
trace("upright.exr", upright, "--integrator", "depth")
stats = path("stats.json")
done = call(VDBTRACE, upright, *SMALL, "-o", path("u.png"), "--stats", stats)
with open(stats, encoding="utf-8") as file:
    report = json.load(file)
check(report["input"]["path"].endswith("tile_y.vdb") and report["march"] == "brick", "the report names file and march")

# Two objects, a shape, materials by feature.
both = scene("both.json", objects=[
    {"vdb": "tile.vdb", "color_by": "layer"},
    {"vdb": "tile.vdb", "transform": {"translate": [20, 0, 0]}, "material": {"by": "feature", "infill": "lambert:1,0,0", "other": "lambert:0,0,1"}},
    {"sdf": {"sphere": {"center": [130, 105, 3], "radius": 3}}, "material": "pla-blue"},
    {"sdf": {"torus": {"center": [130, 105, 8], "radius": 3, "tube": 1}}, "voxel_size": 0.1}])
trace("both.png", both)
trace("both_smooth.png", both, "--normals", "smooth")
check(read("both.png") != read("both_smooth.png"), "smooth normals change the picture")
check(trace("t1.exr", both, "--threads", "1") == trace("t2.exr", both, "--threads", "2"), "the same bytes for 1 and 2 threads")

pictures = {trace(f"by_{name}.exr", "tile.vdb", "--color-by", name) for name in ("layer", "feature", "speed", "color")}
check(len(pictures) == 4, "colours by four attributes are four pictures")
trace("labels.exr", "tile.vdb", "--aov", "layer,tool,feature")
trace("feature.png", "tile.vdb", "--integrator", "feature")
check(trace("sharp.exr", "tile.vdb") != trace("lens.exr", "tile.vdb", "--f-number", "1", "--focus", "100,90,4"), "a lens blurs")
trace_all = call(VDBTRACE, "tile.vdb", *SMALL, "--turntable", "3", "-o", path("turn.png"), "--stats", stats)
with open(stats, encoding="utf-8") as file:
    reports = json.load(file)
check([os.path.basename(r["output"]) for r in reports] == [f"turn_00{n}.png" for n in range(3)], "a report of each picture")
check(trace_all.returncode == 0 and all(os.path.exists(path(f"turn_00{n}.png")) for n in range(3)), "a turntable of 3")

check(call(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "--voxel-size", "0.2", "--snapshots", "50%,100%", "--quiet",
           "-o", path("part.vdb")).returncode == 0, "two snapshots")
parts = sorted(name for name in os.listdir(FOLDER) if name.startswith("part") and name.endswith(".vdb"))
series = call(VDBTRACE, *parts, *SMALL, "--turntable", "2", "-o", path("film.png"))
check(series.returncode == 0 and sum(name.startswith("film_") for name in os.listdir(FOLDER)) == 2 * len(parts),
      f"a series of {len(parts)} snapshots from 2 sides: {series.stderr.strip()}")


def refused(status, words, *options):
    before = set(os.listdir(FOLDER))
    done = call(VDBTRACE, *options, *SMALL, "-o", path("refused.png"))
    check(done.returncode == status and words in done.stderr, f"refused ({words}): {done.returncode} {done.stderr.strip()}")
    check(set(os.listdir(FOLDER)) == before, "  leaves no file behind")


refused(3, "gcode2vdb --grids width", "tile.vdb", "--color-by", "width")
# One material is written: not a default that nothing has, and not one of several.
reds = scene("reds.json", objects=[{"sdf": {"sphere": {"radius": 2}}, "material": "lambert:0.8,0.1,0.1"}])
refused(2, "and the objects have 2", scene("several.json", objects=[
    {"sdf": {"sphere": {"radius": 2}}, "material": "lambert:0.8,0.1,0.1"},
    {"sdf": {"sphere": {"center": [6, 0, 0], "radius": 2}}, "material": "lambert:0.1,0.1,0.8"}]),
    "--write-brdf", path("several.binary"))
refused(2, "each place has a colour of its own", "tile.vdb", "--color-by", "layer", "--write-brdf", path("layer.binary"))
trace("reds.png", reds, "--write-brdf", path("reds.binary"))
trace("asked.png", "tile.vdb", "--brdf", "lambert:0.8,0.1,0.1", "--write-brdf", path("asked.binary"))
check(read("reds.binary") == read("asked.binary"), "the only object's material is written")
refused(2, "has a colour of its own", "tile.vdb", "--color-by", "tool", "--brdf", "pla-blue")
refused(2, "--view top: expected no --eye beside it", "tile.vdb", "--view", "top", "--eye", "60,-60,30")
refused(2, "--color red: expected no --color-by beside it", "tile.vdb", "--color", "red", "--color-by", "layer")
refused(2, "--focus needs a lens", "tile.vdb", "--focus", "10")
refused(2, "a scene stands alone", both, "tile.vdb")
refused(3, "did you mean 'objects'", scene("typo.json", print="tile.vdb", objets=[]))
refused(3, "in a plane", scene("flat.json", print="tile.vdb", camera={"photograph": {
    "size": [640, 480], "pairs": [[x * 10.0, y * 10.0, x, y, 0] for x in range(3) for y in range(3)]}}))
refused(2, "endless", scene("endless.json", objects=[{"sdf": {"plane": {"normal": [0, 0, 1]}}}]))
refused(2, "objects[1].sdf: nothing of a shape 2 x 2 x 2 large is left on voxels of 10", scene("coarse.json", objects=[
    {"sdf": {"sphere": {"radius": 2}}}, {"sdf": {"sphere": {"center": [3, 3, 3], "radius": 1}}, "voxel_size": 10}]))

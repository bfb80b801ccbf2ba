"""Pictures straight from G-code are, byte for byte, those of the level set that gcode2vdb writes."""

import gzip
import json
import os
import shutil

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("print_picture")
FOLDER, path, call = SCRATCH.folder, SCRATCH.path, SCRATCH.call
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
GEAR = shutil.copy(gcode("gear.gcode"), os.path.join(FOLDER, "part"))
SMALL = ["--size", "200x150", "--quiet"]


def picture(source, name, *options):
    """The linear values; the same source name, so that the files have the same metadata."""
    done = call(VDBTRACE, source, "-o", path(name), *SMALL, *options)
    check(done.returncode == 0, f"{name}: exit {done.returncode}: {done.stderr.strip()}")
    if done.returncode != 0:
        return None
    with open(path(name), "rb") as file:
        return file.read()


def same(label, print_options, vdb_options, *trace_options):
    """One picture of the print, and one of the level set that stands in the same place under the same name."""
    late = picture("part", "late.exr", *print_options, *trace_options)
    os.rename(path("part"), path("kept"))
    done = call(GCODE2VDB, path("kept"), "-o", path("eager.vdb"), "--quiet", *vdb_options)
    check(done.returncode == 0, f"{label}: {done.stderr.strip()}")
    made = "eager.vdb" if os.path.exists(path("eager.vdb")) else None
    if "--snapshots" in vdb_options:
        made = next(name for name in os.listdir(FOLDER) if name.startswith("eager_") and name.endswith(".vdb"))
    os.rename(path(made), path("part"))
    eager = picture("part", "eager.exr", *trace_options)
    os.rename(path("kept"), path("part"))
    for name in os.listdir(FOLDER):
        if name.startswith("eager") and name.endswith(".vdb"):
            os.remove(path(name))
    check(late is not None and late == eager, f"{label}: the same bytes as from the level set")


TWO = ["--voxels-per-layer", "2"]
CULL = ["--interior", "cull"]
same("ao", TWO, TWO, "--integrator", "ao", "--spp", "2")
same("path, culled", TWO, TWO + CULL, "--spp", "2")
same("odd voxel size, floats", ["--voxel-size", "0.07"], ["--voxel-size", "0.07"], "--spp", "1", "--brick-values", "float")
same("default voxel size", [], [], "--spp", "1")
some = TWO + ["--layers", "5:20", "--features", "-infill,-solid-infill"]
same("layers and features", some, some, "--spp", "1")
same("a cut by volume", TWO + ["--printed", "40%"], TWO + ["--snapshots", "40%"], "--spp", "1")
same("a cut by layer", TWO + ["--printed", "layer:9"], TWO + ["--snapshots", "layer:9"], "--spp", "1")
same("a cut by time", TWO + ["--printed", "time:3"], TWO + ["--snapshots", "time:3"], "--spp", "1")
grids = TWO + ["--grids", "feature,layer,color,speed"]
same("features as colours", TWO, grids, "--color-by", "feature", "--spp", "1")
same("filament's colours", TWO, grids, "--color-by", "color", "--spp", "1")
same("layers beside the picture", TWO, grids, "--aov", "layer,feature", "--spp", "1")
same("smooth normals", TWO, TWO, "--normals", "smooth", "--spp", "1")

# --- any number of threads --------------------------------------------------------------------------------------------
one = picture("part", "one.exr", "--spp", "2", "--threads", "1")
for threads in ("2", "8"):
    check(picture("part", "more.exr", "--spp", "2", "--threads", threads) == one, f"{threads} threads: the same bytes")

# --- any room for bricks ------------------------------------------------------------------------------------------------
for room, threads in (("100kB", "2"), ("100kB", "8"), ("300kB", "1"), ("1MB", "8"), ("9GB", "2")):
    check(picture("part", "more.exr", "--spp", "2", "--threads", threads, "--brick-cache", room) == one,
          f"{room} of bricks, {threads} threads: the same bytes")

# --- a moment after the last one is the whole print -------------------------------------------------------------------------
check(picture("part", "more.exr", "--spp", "2", "--printed", "time:100000") == one, "long after the end: the same bytes")

# --- containers, and a scene that names G-code --------------------------------------------------------------------------
with open(path("part"), "rb") as source, gzip.open(path("packed"), "wb") as packed:
    packed.write(source.read())
os.rename(path("part"), path("plain"))
os.rename(path("packed"), path("part"))
check(picture("part", "packed.exr", "--spp", "2") == one, "from gzip: the same bytes")
os.rename(path("plain"), path("part"))
with open(path("scene.json"), "w", encoding="utf-8") as scene:
    json.dump({"objects": [{"vdb": "part"}, {"vdb": "part", "transform": {"translate": [60, 0, 0]}}]}, scene)
check(picture("scene.json", "scene.png", "--spp", "1") is not None, "two of the same print in a scene")

# --- what it took -------------------------------------------------------------------------------------------------------
done = call(VDBTRACE, "part", "-o", path("s.png"), *SMALL, "--spp", "1", "--integrator", "ao", "--stats", "-")
stats = json.loads(done.stdout)
took = stats["on_demand"][0]
check(set(took["seconds"]) >= {"parse", "bins", "box", "map"}, "--stats has the times")
check(0 < took["bricks_made"] <= took["bricks_listed"], "--stats counts bricks")
check(took["leaves_made"] > 0 and took["brick_bytes"] > 0, "--stats counts leaves and bytes")
check(stats["input"]["voxel_size_mm"] > 0 and stats["input"]["choice"] != "", "--stats has the voxel size and why")

done = call(VDBTRACE, "part", "-o", path("s.png"), *SMALL, "--spp", "1", "--integrator", "ao", "--stats", "-",
            "--brick-cache", "150kB")
cache = json.loads(done.stdout)["on_demand"][0]["brick_cache"]
check(cache["limit_bytes"] == 150000 and 90000 < cache["peak_bytes"] <= 150000, f"bricks stay within bounds: {cache}")
check(cache["made"] > took["bricks_made"] and cache["evicted"] >= cache["made"] - cache["bricks"] and cache["hits"] > 0,
      f"--stats counts what came and went: {cache}")

# --- voxels that follow from the picture ----------------------------------------------------------------------------------
def automatic(label, *options):
    """A picture with --voxel-size auto and what --stats says of its voxels."""
    done = call(VDBTRACE, "part", "-o", path("auto.exr"), *SMALL, "--spp", "1", "--voxel-size", "auto", "--stats", "-", *options)
    check(done.returncode == 0, f"{label}: exit {done.returncode}: {done.stderr.strip()}")
    with open(path("auto.exr"), "rb") as file:
        return file.read(), json.loads(done.stdout)["input"]


LAYER = 0.3  # mm
CLOSE = ["--eye", "100,30,40", "--look-at", "100,100,2"]
AFAR = ["--eye", "100,-900,300", "--look-at", "100,100,5"]
for label, options in (("from afar", AFAR), ("by itself", ["--frame", "all"]), ("close by", CLOSE)):
    auto, found = automatic(label, *options)
    pixel, voxel = found["voxel_auto"]["smallest_pixel_mm"], found["voxel_size_mm"]
    each = round(LAYER / voxel)
    check(2 <= each <= 16 and (voxel <= pixel / 2 or each == 16), f"{label}: voxels of {voxel} mm for pixels of {pixel} mm")
    check(each == 2 or LAYER / (each - 1) > pixel / 2, f"{label}: no finer than it must be")
    check(found["voxel_auto"]["largest_error_mm"] == voxel / 2, f"{label}: --stats bounds the error")
    check(("levels" in found["voxel_auto"]) == (label == "close by"), f"{label}: voxels of several sizes only there")
    if "levels" not in found["voxel_auto"]:
        check(picture("part", "more.exr", "--spp", "1", "--voxels-per-layer", str(each), *options) == auto,
              f"{label}: the picture of {each} voxels a layer")
_, found = automatic("the camera in a bead", "--eye", "100,100,1.1", "--look-at", "101,100,1.1", "--integrator", "depth")
check(found["voxel_auto"]["smallest_pixel_mm"] == 0 and round(LAYER / found["voxel_size_mm"]) == 16, "within: the finest voxels")

# --- voxels of several sizes in one picture -------------------------------------------------------------------------------
AUTO = [*CLOSE, "--voxel-size", "auto", "--spp", "1"]
_, found = automatic("levels", *CLOSE)
levels = found["voxel_auto"]["levels"]
check(levels[0]["from_mm"] == 0 and levels[-1]["to_mm"] is None, f"from the eye to the far end: {levels}")
for near, far in zip(levels, levels[1:]):
    check(near["to_mm"] == far["from_mm"] > near["from_mm"], "one begins where another ends")
    check(far["voxel_size_mm"] >= 1.5 * near["voxel_size_mm"] and far["beads"] >= near["beads"], "outwards, coarser")
    check(far["largest_error_pixels"] <= 0.2500001, f"within a quarter of a pixel: {far}")
several = picture("part", "levels.exr", *AUTO)
for more in (["--threads", "1"], ["--threads", "8"], ["--brick-cache", "600kB"], ["--brick-cache", "600kB", "--threads", "8"]):
    check(picture("part", "more.exr", *AUTO, *more) == several, f"levels, {' '.join(more)}: the same bytes")
for more in (["--color-by", "feature"], ["--aov", "layer,feature"], ["--normals", "smooth"]):
    check(picture("part", "more.exr", *AUTO, *more) not in (None, several), f"levels with {' '.join(more)}")
done = call(VDBTRACE, "part", "-o", path("film.exr"), *SMALL, *AUTO, "--no-bed", "--progress-series", "3", "--stats", "-")
check(done.returncode == 0, f"levels, a series: {done.stderr.strip()}")
took = json.loads(done.stdout)[0]["on_demand"][0]
check(len(took["levels"]) == len(levels) and sum(x["bricks_made"] for x in took["levels"]) == took["bricks_made"] > 0,
      "--stats counts the bricks of each")
with open(path("film_002.exr"), "rb") as file:
    check(file.read() == picture("part", "more.exr", *AUTO, "--no-bed"), "levels: the last of a series is the whole print")
_, found = automatic("a turntable", *CLOSE, "--crop", "0,0,9,9")
done = call(VDBTRACE, "part", "-o", path("turn.png"), *SMALL, *AUTO, "--crop", "0,0,9,9", "--turntable", "2", "--stats", "-")
check(done.returncode == 0 and "levels" not in json.loads(done.stdout)[0]["input"]["voxel_auto"], "a turntable has one size")

# --- a print that grows: the same as each moment alone, under a camera that doesn't depend on it ---------------------------
VIEW = ["--eye", "150,-160,120", "--look-at", "100,100,5", "--no-bed", "--spp", "1", *TWO]
done = call(VDBTRACE, "part", "-o", path("film.png"), *SMALL, *VIEW, "--progress-series", "4", "--stats", "-",
            "--brick-cache", "400kB")
check(done.returncode == 0, f"a series: {done.stderr.strip()}")
frames = json.loads(done.stdout)
check([frame["output"].endswith(f"film_{3 - n:03}.png") for n, frame in enumerate(frames)] == [True] * 4, "numbered")
sizes = [frame["on_demand"][0]["printed_beads"] for frame in frames]
check(sizes == sorted(sizes, reverse=True) and len(set(sizes)) == 4, f"every picture has fewer beads: {sizes}")
for n, cut in enumerate(("25%", "50%", "75%")):
    alone = picture("part", "alone.png", *VIEW, "--printed", cut)
    with open(path(f"film_{n:03}.png"), "rb") as file:
        check(file.read() == alone, f"picture {n} is that of {cut} alone")
refused = call(VDBTRACE, "part", "part", "-o", path("refused.png"), *SMALL, "--progress-series", "4")
check(refused.returncode == 2 and "one print" in refused.stderr, "a series of two prints is refused")

# --- clear refusals -----------------------------------------------------------------------------------------------------
for options, status, text in ((["--printed", "sometimes"], 2, "--printed sometimes: expected"), (["--printed", "10%,20%"], 2, "one moment"),
                              (["--layers", "900:"], 3, "layers 1 to"), (["--half-width", "1"], 2, "half-width"),
                              (["--voxel-size", "0"], 2, "voxel"), (["--color-by", "humidity"], 2, "layer, time"),
                              (["--march", "sphere"], 2, "gcode2vdb"), (["--voxel-size", "0.000001"], 2, "voxel"),
                              (["--brick-cache", "90kB"], 2, "give 93312 bytes"), (["--brick-cache", "much"], 2, "size"),
                              (["--brick-cache", "1MB", "--march", "vdb"], 2, "no bricks"),
                              (["--voxel-size", "small"], 2, "voxel-size"),
                              (["--voxel-size", "auto", "--voxels-per-layer", "2"], 2, "voxel"),
                              (["--printed", "layer:100000"], 2, "layer"), (["--printed", "250%"], 2, "%"), (["--printed", "layer:0"], 2, "nothing|expected one")):
    done = call(VDBTRACE, "part", "-o", path("refused.png"), *SMALL, *options)
    check(done.returncode == status and any(part in done.stderr for part in text.split("|")),
          f"{' '.join(options)}: exit {done.returncode}: {done.stderr.strip()}")
done = call(VDBTRACE, "scene.json", "-o", path("refused.png"), *SMALL, "--voxel-size", "auto")
check(done.returncode == 2 and "stands alone" in done.stderr, f"auto in a scene: {done.stderr.strip()}")
done = call(GCODE2VDB, path("part"), "-o", path("refused.vdb"), "--quiet", "--voxel-size", "auto")
check(done.returncode == 2 and "voxel-size" in done.stderr, f"auto without a picture: {done.stderr.strip()}")
check(not os.path.exists(path("refused.png")), "refusals leave no file behind")
with open(path("prose"), "w", encoding="utf-8") as file:
    file.write("Dear printer, please print a boat.\n")
done = call(VDBTRACE, "prose", "-o", path("refused.png"), *SMALL)
check(done.returncode == 3 and "prose" in done.stderr, f"neither a level set nor G-code: {done.stderr.strip()}")

shutil.rmtree(FOLDER)

"""The voxel that gcode2vdb chooses loses nothing, and what it writes and warns of is what was asked for."""

import json
import os
import resource
import subprocess
import sys
import tempfile

from run_tools import BIN, check, corpus, gcode, run

FOLDER = tempfile.mkdtemp(prefix="stratum_voxels_")


def convert(source, *options):
    """The report, what was said on stderr, and the exit status."""
    done = subprocess.run([os.path.join(BIN, "gcode2vdb"), source, "--stats", "-", *options], capture_output=True, text=True)
    return (json.loads(done.stdout[done.stdout.index("{"):]) if done.returncode == 0 else None), done.stderr, done.returncode


def per_layer(report):
    return report["grid"]["layer_height_mm"] / report["grid"]["voxel_size_mm"]


def held(report):
    return report["grid"]["volume_mm3"] / report["grid"]["deposited_mm3"]


# What the tool chooses by itself has two voxels a layer at least, and holds what was extruded.
sources = [gcode("tile.gcode")]
if cancelled := corpus("preprocess_cancellation-m486.gcode"):
    sources.append(cancelled)
out = os.path.join(FOLDER, "part.vdb")
for source in sources:
    for options in (["--tolerance", "0.1"], ["--tolerance", "5"], ["--memory-budget", "40MB", "--interior", "cull"]):
        report, said, _ = convert(source, "-o", out, *options)
        name = f"{os.path.basename(source)} {' '.join(options)}"
        check(report is not None and per_layer(report) > 1.99, f"{name}: {report and per_layer(report)} voxels a layer")
        check(held(report) > 0.85 and "holds" not in said, f"  holds {held(report):.3f} of what was extruded {said}")
    report, said, status = convert(source, "-o", out, "--memory-budget", "100kB")
    check(status == 2 and "--interior cull" in said, f"too small a budget names a remedy: {said.strip()}")

    # One voxel a layer is as asked, said to be coarse, and loses next to nothing.
    for options in (["--voxels-per-layer", "1"], ["--voxel-size", "0.2"]):
        report, said, _ = convert(source, "-o", out, *options)
        check(held(report) > 0.85, f"{' '.join(options)}: holds {held(report):.3f}")
        check("voxel a layer" in said or "voxels a layer" in said, f"  and is warned of: {said.strip()}")
        check("half a voxel" in report["grid"]["choice"], f"  and shifted: {report['grid']['choice']}")

# A budget holds for what is made beside the surface, and memory that is short is said before it is gone.
PEAK = "import resource, subprocess, sys; status = subprocess.call(sys.argv[1:]); " \
       "print(status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
with_color = ["--grids", "layer,color"]
for options in (with_color, ["--interior", "cull", *with_color], ["--interior-distance"], ["-o", os.path.join(FOLDER, "b.nvdb")],
                ["-o", os.path.join(FOLDER, "b.stl")]):
    if "-o" not in options:
        options = ["-o", out, *options]
    command = [os.path.join(BIN, "gcode2vdb"), gcode("gear.gcode"), "--force", "--quiet", *options]
    done = run(sys.executable, "-c", PEAK, *command, "--memory-budget", "700MB")
    status, peak = (int(word) for word in done.split()[-2:])
    # The program and its toolpath are not the budget's.
    check(status == 0 and 100e3 < peak < 760e3, f"{' '.join(options)} within 700 MB: {status} {peak} kB")
    for megabytes in (300, 500, 1000):
        limit = (megabytes << 20, megabytes << 20)
        done = subprocess.run(command + ["--voxels-per-layer", "5"], capture_output=True, text=True,
                              preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, limit))
        refused = done.returncode == 2 and "are free; choose a larger voxel" in done.stderr
        check(refused or done.returncode == 0 or done.returncode == 1 and "out of memory" in done.stderr,
              f"  of {megabytes} MB: {done.returncode} {done.stderr.strip()}")

# Layers far thinner than a voxel can't be there: that is said.
report, said, _ = convert(gcode("tile.gcode"), "-o", out, "--voxel-size", "1.5")
check("have no solid in their middle" in said and "holds" in said, f"voxels of 1.5 mm: {said.strip()}")
_, said, _ = convert(gcode("tile.gcode"), "-o", out, "--voxel-size", "1.5", "--quiet")
check(said == "", "  not if it is to be quiet")

# What culling would save is counted only if asked for.
report, _, _ = convert(gcode("tile.gcode"), "-o", out)
check("cull_would_save" not in report["grid"] and any("--forecast" in s["why"] for s in report["skipped"]), "no forecast unasked")
report, _, _ = convert(gcode("tile.gcode"), "-o", out, "--forecast")
check(report["grid"]["cull_would_save"]["leaves"] >= 0, "a forecast if asked for")

# Two inputs of one name would be one file.
for folder in ("a", "b"):
    os.mkdir(os.path.join(FOLDER, folder))
    os.symlink(gcode("tile.gcode"), os.path.join(FOLDER, folder, "part.gcode"))
os.mkdir(os.path.join(FOLDER, "out"))
done = subprocess.run([os.path.join(BIN, "gcode2vdb"), "a/part.gcode", "b/part.gcode", "-o", "out"], cwd=FOLDER,
                      capture_output=True, text=True)
check(done.returncode == 2 and "a/part.gcode" in done.stderr and "b/part.gcode" in done.stderr and
      not os.listdir(os.path.join(FOLDER, "out")), f"one name for two: {done.stderr.strip()}")

# Several colors of filament are written unasked; a single, stated one is said.
report, _, _ = convert(gcode("two_tone.gcode"), "-o", out, "--voxel-size", "0.15")
listing = run("vdb_print", "-l", out)
check("color" in listing and "vec3s" in listing, "two colors: a grid of them")
check("filament_color" not in listing, "  and no single one")
convert(gcode("two_tone.gcode"), "-o", out, "--voxel-size", "0.15", "--grids", "surface")
check("vec3s" not in run("vdb_print", "-l", out), "  not with --grids surface")
convert(gcode("tile.gcode"), "-o", out)
listing = run("vdb_print", "-l", out)
check("filament_color: #d8563b" in listing and "vec3s" not in listing, "one color: said of the surface")

# Meshes: color of their points, and nothing else of grids.
ply = os.path.join(FOLDER, "part.ply")
report, said, status = convert(gcode("two_tone.gcode"), "-o", ply, "--grids", "color", "--voxel-size", "0.15")
check(status == 0, f"a mesh with colors {said}")
with open(ply, "rb") as file:
    data = file.read()
header, body = data.split(b"end_header\n", 1)
count = report["files"][0]["mesh"]["vertices"]
check(b"property uchar red" in header, "  has them")
colors = {bytes(body[15 * n + 12: 15 * n + 15]) for n in range(count)}
check(len(colors) == 2, f"  two of them: {colors}")
for name, grids in (("part.ply", "layer"), ("part.stl", "color")):
    _, said, status = convert(gcode("tile.gcode"), "-o", os.path.join(FOLDER, name), "--grids", grids)
    check(status == 2 and "a mesh has no voxels" in said, f"{name} --grids {grids}: {said.strip()}")

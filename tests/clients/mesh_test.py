"""Meshes of prints: watertight by admesh, as much volume as the level set, the same surface in every format."""

import json
import os
import re
import struct
import tempfile

from run_tools import BIN, check, gcode, run

FOLDER = tempfile.mkdtemp(prefix="stratum_mesh_")


def mesh(source, name, *options):
    path = os.path.join(FOLDER, name)
    report = run(os.path.join(BIN, "gcode2vdb"), source, "-o", path, "--stats", "-", *options)
    return path, json.loads(report)


def admesh(path):
    """What admesh finds before it mends anything: the first column of its table."""
    text = run("admesh", path)
    found = {name.strip(): int(value) for name, value in re.findall(r"^([A-Z][A-Za-z0-9 ]+?)\s*:\s+(\d+)", text, re.M)}
    found["Volume"] = float(re.search(r"Volume\s*:\s*([-\d.]+)", text).group(1))
    found["Parts"] = int(re.search(r"Number of parts\s*:\s*(\d+)", text).group(1))
    return found


for print_, options in (("tile.gcode", []), ("tile.gcode", ["--mesh-error", "0"]), ("tile.gcode", ["--mesh-error", "1"]),
                        ("knot.gcode", ["--layers", "1:8", "--features", "-support,-skirt,-brim"]),
                        ("two_tone.gcode", ["--interior", "keep", "--layers", "1:4"])):
    path, report = mesh(gcode(print_), "part.stl", "--voxel-size", "0.1", *options)
    found = admesh(path)
    made = report["files"][0]["mesh"]
    print(print_, options, made, found)
    check(found["Number of facets"] == made["triangles"], "admesh finds all faces")
    for fault in ("Total disconnected facets", "Degenerate facets", "Edges fixed", "Facets removed", "Facets reversed",
                  "Backwards edges"):
        check(found[fault] == 0, f"  {fault}: {found[fault]}")
    check(abs(found["Volume"] / made["volume_mm3"] - 1) < 1e-3, "  and its volume")
    # Cavities are part of the level set's air, not of the mesh's.
    least = report["grid"]["volume_mm3"]
    check(0.98 < made["volume_mm3"] / least < 1.02, f"  which is the level set's: {made['volume_mm3']:.2f}, {least:.2f} mm3")

# Where a thin gap keeps the outside out, the mesh is closed all the same.
for options in ([], ["--half-width", "2"]):
    path, _ = mesh(gcode("two_tone.gcode"), "thin.stl", "--voxels-per-layer", "2", *options)
    check(admesh(path)["Total disconnected facets"] == 0, f"two_tone.gcode {options}: the mesh is closed")

# Skirts are no part of a model, unless features are asked for; and as few faces as asked for.
gear = ["--voxel-size", "0.15", "--layers", "1:4"]
_, alone = mesh(gcode("gear.gcode"), "alone.stl", *gear)
_, everything = mesh(gcode("gear.gcode"), "all.stl", *gear, "--features", "all")
path, few = mesh(gcode("gear.gcode"), "few.stl", *gear, "--faces", "4000")
sizes = [[high - low for low, high in zip(*report["toolpath"]["selected_bbox_mm"])] for report in (alone, everything)]
check(sizes[0][0] + 3 < sizes[1][0], f"the skirt is left out: {sizes[0][0]:.1f} of {sizes[1][0]:.1f} mm")
check(few["files"][0]["mesh"]["triangles"] <= 4000 < alone["files"][0]["mesh"]["triangles"], "--faces bounds them")
check(admesh(path)["Total disconnected facets"] == 0, "  and the mesh is closed")

# The same surface in every format, unit and orientation.
path, report = mesh(gcode("tile.gcode"), "a.ply", "--voxel-size", "0.2")
made = report["files"][0]["mesh"]
with open(path, "rb") as file:
    data = file.read()
header, body = data.split(b"end_header\n", 1)
vertices = struct.unpack(f"<{3 * made['vertices']}f", body[: 12 * made["vertices"]])
path, _ = mesh(gcode("tile.gcode"), "a.obj", "--voxel-size", "0.2")
with open(path, encoding="ascii") as file:
    lines = file.read().splitlines()
written = [float(x) for line in lines if line.startswith("v ") for x in line.split()[1:]]
check(len(written) == len(vertices) and max(abs(a - b) for a, b in zip(written, vertices)) < 1e-4, "PLY and OBJ agree")
low, high = report["toolpath"]["selected_bbox_mm"]
for axis in range(3):
    ends = (min(vertices[axis::3]), max(vertices[axis::3]))
    check(abs(ends[0] - low[axis]) < 0.3 and abs(ends[1] - high[axis]) < 0.3,
          f"  and the print's box within a voxel and a half: {ends}, {low[axis]} .. {high[axis]} mm")
# With all faces: merged ones depend on how coordinates round.
_, every = mesh(gcode("tile.gcode"), "b.stl", "--voxel-size", "0.2", "--mesh-error", "0")
made = every["files"][0]["mesh"]
for options in (["--unit", "m", "--origin", "center"], ["--up", "y"], ["--origin", "min"]):
    _, other = mesh(gcode("tile.gcode"), "b.stl", "--voxel-size", "0.2", "--mesh-error", "0", *options)
    volume = other["files"][0]["mesh"]["volume_mm3"]
    check(abs(volume / made["volume_mm3"] - 1) < 1e-4, f"{' '.join(options)} keeps the volume")
_, report = mesh(gcode("tile.gcode"), "c.stl", "--voxel-size", "0.2", "--snapshots", "50%")
check([os.path.basename(f["path"]) for f in report["files"]] == ["c_050pct.stl", "c.stl"] and
      report["files"][0]["mesh"]["volume_mm3"] < report["files"][1]["mesh"]["volume_mm3"], "snapshots are meshes too")

"""Prints of real PrusaSlicer beside their models: distances against formulas, placement, refusals."""

import json
import math
import os
import subprocess
import tempfile

from run_tools import BIN, check, run, skip_without

skip_without(modules=("numpy", "pyopenvdb"))

import numpy
import pyopenvdb

FOLDER = tempfile.mkdtemp(prefix="stratum_compare_")
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VOXEL = 0.1
CENTER = numpy.array([6.0, 6.0, 6.0])


def write_model(name, triangles):
    path = os.path.join(FOLDER, name)
    with open(path, "w", encoding="ascii") as file:
        file.write("solid model\n")
        for triangle in triangles:
            file.write("facet normal 0 0 0\nouter loop\n")
            for x, y, z in triangle:
                file.write(f"vertex {x:.6f} {y:.6f} {z:.6f}\n")
            file.write("endloop\nendfacet\n")
        file.write("endsolid model\n")
    return path


def turned_plan(radius, sides, profile):
    """A body of revolution: points (share of the radius, z) from the bottom to the top; both ends are on the axis."""
    rings = [[(6 + radius * r * math.cos(2 * math.pi * s / sides), 6 + radius * r * math.sin(2 * math.pi * s / sides), z)
              for s in range(sides)] for r, z in profile]
    triangles = []
    for low, high in zip(rings, rings[1:]):
        for s in range(sides):
            n = (s + 1) % sides
            if low[s] != low[n]:
                triangles.append((low[s], low[n], high[s]))
            if high[s] != high[n]:
                triangles.append((low[n], high[n], high[s]))
    return triangles


def box():
    c = [(x, y, z) for x in (0, 12) for y in (0, 12) for z in (0, 12)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return [t for a, b, d, e in faces for t in ((c[a], c[b], c[d]), (c[a], c[d], c[e]))]


def box_distance(p):
    q = numpy.abs(p - CENTER) - 6
    return numpy.linalg.norm(numpy.maximum(q, 0), axis=-1) + numpy.minimum(q.max(axis=-1), 0)


def sphere_distance(p):
    return numpy.linalg.norm(p - CENTER, axis=-1) - 6


def cylinder_distance(p):
    q = numpy.stack([numpy.linalg.norm((p - CENTER)[..., :2], axis=-1) - 6, numpy.abs((p - CENTER)[..., 2]) - 6], -1)
    return numpy.linalg.norm(numpy.maximum(q, 0), axis=-1) + numpy.minimum(q.max(axis=-1), 0)


RINGS, SIDES = 60, 120  # up to 4 um from the round surface
ball = [(math.sin(math.pi * n / RINGS) if 0 < n < RINGS else 0.0, 6 - 6 * math.cos(math.pi * n / RINGS)) for n in range(RINGS + 1)]
SHAPES = {"box": (box(), box_distance), "sphere": (turned_plan(6, SIDES, ball), sphere_distance),
          "cylinder": (turned_plan(6, SIDES, [(0.0, 0.0), (1.0, 0.0), (1.0, 12.0), (0.0, 12.0)]), cylinder_distance)}


def compare(sliced, model, *options):
    vdb = os.path.join(FOLDER, "print.vdb")
    report = json.loads(run(GCODE2VDB, sliced, "-o", vdb, "--voxel-size", str(VOXEL), "--compare", model, "--stats", "-",
                            "--quiet", *options))
    found = report["compare"]
    turn = numpy.array(found["placement"]["turn"]).reshape(3, 3)
    return found, turn, numpy.array(found["placement"]["move_mm"]), vdb


for name, (triangles, distance) in SHAPES.items():
    model = write_model(f"{name}.stl", triangles)
    sliced = os.path.join(FOLDER, f"{name}.gcode")
    run("prusa-slicer", "--export-gcode", "--layer-height", "0.2", "--first-layer-height", "0.2", "--skirts", "1",
        "--filament-diameter", "1.75", "--center", "100,90", "-o", sliced, model)
    found, turn, move, vdb = compare(sliced, model, "--grids", "deviation")
    middle = turn @ CENTER + move
    print(f"{name}: {found['placement']['residual_mm']:.3f} mm residual, turned {found['placement']['turn_degrees']:.2f}, "
          f"middle {middle}, hidden {found['hidden_share']:.3f}, print to model {found['print_to_model']['all']}")
    check(numpy.abs(middle[:2] - (100, 90)).max() < 0.02, f"{name}: is found where the slicer was told to put it")
    check(name != "box" or found["placement"]["turn_degrees"] < 0.5, "  and as it was turned")
    for way in ("print_to_model", "model_to_print"):
        check(found[way]["all"]["within_95_mm"] < 0.2 and abs(found[way]["walls"]["mean_mm"]) < 0.06,
              f"  {way}: 95 % within {found[way]['all']['within_95_mm']:.3f} mm")
    for end in ("least", "most"):
        there = found["print_to_model"]["all"]
        place = turn.T @ (numpy.array(there[end + "_at_mm"]) - move)
        check(abs(distance(place) - there[end + "_mm"]) < 0.25 * VOXEL, f"  its {end}, {there[end + '_mm']:+.3f} mm, is the formula's there")
    # Voxels whose middle is on the surface: the formula there.
    surface = pyopenvdb.read(vdb, "surface")
    deviation = pyopenvdb.read(vdb, "deviation")
    phi = surface.getConstAccessor()
    checked = 0
    worst = 0
    for number, item in enumerate(deviation.citerOnValues()):
        if number % 199 or item.count != 1:
            continue
        value = phi.getValue(item.min)
        if abs(value) > 0.1 * VOXEL:
            continue
        place = turn.T @ (numpy.array(deviation.transform.indexToWorld(item.min)) - move)
        worst = max(worst, abs(distance(place) - item.value))
        checked += 1
    check(checked > 100 and worst < 0.25 * VOXEL, f"  {checked} voxels deviate as the formula says, to {worst:.4f} mm")

    # The model elsewhere, turned: the same place is found.
    angle, shift = math.radians(33.3), numpy.array([12.3, -4.5, 1.2])
    by = numpy.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
    other = write_model(f"{name}_moved.stl", [[by @ corner + shift for corner in t] for t in triangles])
    _, turn2, move2, _ = compare(sliced, other)
    corners = {"box": [numpy.array(c, float) for t in triangles for c in t], "sphere": [CENTER],
               "cylinder": [numpy.array([6.0, 6.0, 0.0]), numpy.array([6.0, 6.0, 12.0])]}[name]
    miss = max(numpy.linalg.norm(turn2 @ (by @ c + shift) + move2 - (turn @ c + move)) for c in corners)
    check(miss < 0.02, f"  shifted and turned by hand it is found again, to {miss:.4f} mm")

# By the bed's coordinates: a model that lies where the slicer puts it.
shift = numpy.array([94.0, 84.0, 0.0])
placed = write_model("placed.stl", [[numpy.array(c) + shift for c in t] for t in SHAPES["box"][0]])
found, _, move, _ = compare(os.path.join(FOLDER, "box.gcode"), placed, "--compare-at", "bed")
check(found["placement"]["by"] != "best fit" and not move.any() and found["print_to_model"]["all"]["rms_mm"] < 0.1,
      "a model with the bed's coordinates")

# A 3MF of the slicer's own.
run("prusa-slicer", "--export-3mf", "-o", os.path.join(FOLDER, "box.3mf"), os.path.join(FOLDER, "box.stl"))
found, _, _, _ = compare(os.path.join(FOLDER, "box.gcode"), os.path.join(FOLDER, "box.3mf"))
check(abs(found["model_mm3"] - 1728) < 0.01, "a 3MF of PrusaSlicer")

triangles = SHAPES["box"][0]
bad = {"open.stl": (triangles[:-1], "not closed"), "turned.stl": ([t[::-1] for t in triangles], "inside out"),
       "none.stl": ([], "no triangles")}
for name, (faces, words) in bad.items():
    vdb = os.path.join(FOLDER, "kept.vdb")
    with open(vdb, "w", encoding="ascii") as file:
        file.write("old")
    done = subprocess.run([GCODE2VDB, os.path.join(FOLDER, "box.gcode"), "-o", vdb, "--force", "--compare",
                           write_model(name, faces)],
                          capture_output=True, text=True)
    check(done.returncode == 3 and (words in done.stderr or name == "none.stl"), f"{name}: {done.stderr.strip().splitlines()[-1]}")
    with open(vdb, encoding="ascii") as file:
        check(file.read() == "old", "  the old file stays")
done = subprocess.run([GCODE2VDB, os.path.join(FOLDER, "box.gcode"), "-o", vdb, "--grids", "deviation"],
                      capture_output=True, text=True)
check(done.returncode == 2 and "--compare part.stl" in done.stderr, "deviations without a model")

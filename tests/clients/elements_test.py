"""Solid elements in the real CalculiX: a cantilever against beam theory, sets, materials, stretched infill; bad input."""

import json
import math
import os
import re
import subprocess
import sys
import tempfile

from run_tools import BIN, check, gcode, run, skip_without, write_box

FOLDER = tempfile.mkdtemp(prefix="stratum_elements_")
GCODE2VDB = os.path.join(BIN, "gcode2vdb")


def elements(source, name, *options):
    path = os.path.join(FOLDER, name + ".inp")
    return path, json.loads(run(GCODE2VDB, source, "-o", path, "--stats", "-", "--quiet", *options))["files"][0]


def read_nodes(path):
    """Number and place of each node."""
    nodes = {}
    with open(path, encoding="ascii") as file:
        for line in file:
            if line.startswith("*NODE,"):
                break
        for line in file:
            if line.startswith("*"):
                return nodes
            number, *place = line.split(",")
            nodes[int(number)] = tuple(map(float, place))
    sys.exit(f"{path} has no nodes")


def node_set(name, members):
    return f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for n in members)


def solve(path, name, deck, *tables):
    """Runs CalculiX on a deck that includes the elements; returns the tables of its .dat, each as lines of numbers."""
    with open(os.path.join(FOLDER, name + ".inp"), "w", encoding="ascii") as file:
        file.write(f"*INCLUDE, INPUT={os.path.basename(path)}\n{deck}")
    done = subprocess.run(["ccx", "-i", name], cwd=FOLDER, capture_output=True, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "2"})
    if done.returncode != 0 or "*ERROR" in done.stdout:
        sys.exit(f"ccx {name}: {done.returncode}\n{done.stdout[-3000:]}")
    if warnings := re.findall(r"\*WARNING.*\n.*", done.stdout):
        print("\n".join(warnings[:5]))
    with open(os.path.join(FOLDER, name + ".dat"), encoding="ascii") as file:
        text = file.read()
    found = []
    for table in tables:
        body = re.search(rf"^ *{table}.*\n\n((?: .*\n)+)", text, re.M)
        if not body:
            sys.exit(f"{name}.dat has no {table}:\n{text[:500]}")
        found.append([[float(word) for word in line.split()] for line in body.group(1).splitlines()])
    return found


def write(name, text):
    path = os.path.join(FOLDER, name)
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    return path


WIDTH, HEIGHT, LENGTH = 2.0, 2.0, 18.0


def beam(name, low, width):
    """Four layers of three lines of 24 mm, whose straight sides (--section) and touching flats leave no gap."""
    text = "M83\n;TYPE:Solid infill\n"
    for layer in range(1, 5):
        text += f";LAYER_CHANGE\n;Z:{layer / 2}\n;HEIGHT:0.5\n;WIDTH:1\nG1 Z{layer / 2} F600\n"
        for row in range(3):
            y = low + width / 4 + width / 4 * row
            volume = width / 2 * 0.5 * 24
            text += f"G0 X0 Y{y:.5f} F6000\nG1 X24 Y{y:.5f} E{volume / (math.pi * 1.75**2 / 4):.5f} F1200\n"
    return write(name, text)


YOUNG, POISSON = 3500.0, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
# Timoshenko's beam, with Cowper's shear coefficient of a rectangle (Journal of Applied Mechanics 33, 1966).
KAPPA = 10 * (1 + POISSON) / (12 + 11 * POISSON)


def deflection(per_layer, *, elastic, along="z", width=WIDTH, off=0.0):
    """Of a cantilever by a force of 1 N, and what the beam's theory says. Its sides lie `off` elements off their faces."""
    block = beam(f"block{per_layer}.gcode", (off - 0.5) * 0.5 / per_layer, width)
    path, made = elements(block, f"beam{per_layer}", "--voxels-per-layer", str(per_layer), "--section", "0.001",
                          "--elastic", elastic)
    nodes = read_nodes(path)
    edge = made["edge_mm"]
    clamp = max(x for x, _, _ in nodes.values() if x <= 3)
    tip = min(x for x, _, _ in nodes.values() if x >= 3 + LENGTH - edge)
    clamped = [n for n, (x, _, _) in nodes.items() if x <= clamp]
    loaded = [n for n, (x, _, _) in nodes.items() if x == tip]
    dof = {"y": 2, "z": 3}[along]
    deck = (node_set("CLAMPED", clamped) + node_set("LOADED", loaded) +
            f"*STEP\n*STATIC\n*BOUNDARY\nCLAMPED, 1, 3\n*CLOAD\nLOADED, {dof}, {1 / len(loaded)}\n"
            "*NODE PRINT, NSET=LOADED\nU\n*END STEP\n")
    table, = solve(path, f"cantilever{per_layer}{along}", deck, "displacements")
    moved = sum(row[dof] for row in table) / len(table)
    length = tip - clamp
    young = float(elastic.split(",")[0])
    theory = length**3 / (3 * young * width * HEIGHT**3 / 12) + length / (KAPPA * SHEAR * width * HEIGHT)
    return moved, theory, made


# What no face joins is another piece; sets are those of the reader.
_, made = elements(gcode("tile.gcode"), "one", "--voxel-size", "0.4", "--features", "+skirt,+perimeter,+external-perimeter")
_, every = elements(gcode("tile.gcode"), "all", "--voxel-size", "0.4", "--features",
                    "+skirt,+perimeter,+external-perimeter", "--all-pieces")
check(made["pieces"] > 1 and made["elements"] + made["removed_elements"] == every["elements"],
      f"the largest of {made['pieces']} pieces is kept, {made['removed_elements']} elements are left out and said")
with open(os.path.join(FOLDER, "all.inp"), encoding="ascii") as file:
    text = file.read()
for name in ("LAYER_1", "FEATURE_EXTERNAL_PERIMETER", "FEATURE_PERIMETER", "TOOL_0"):
    check(f"*ELSET, ELSET={name}," in text and f"*NSET, NSET={name}," in text, f"  {name}")

# What can't be: a message, no file.
old = write("old.inp", "by gcode2vdb 0.1: old")
for options, words in ((["--max-nodes", "100"], "--voxel-size"), (["--elastic", "3500,0.7"], "stable"),
                       (["--elastic", "1,2,3"], "nine"), (["--grids", "layer"], "sets of layers"), (["--unit", "m"], "mm, N"),
                       (["--interior", "cull"], "solid"), (["--up", "y"], "as printed"), (["--usda"], "volume"),
                       (["--snapshots", "50%"], "--layers"), (["--voxel-size", "0.001"], "--voxel-size")):
    done = subprocess.run([GCODE2VDB, gcode("tile.gcode"), "-o", old, *options], capture_output=True, text=True)
    check(done.returncode == 2 and words in done.stderr, f"{' '.join(options)}: {done.stderr.strip().splitlines()[-1]}")
with open(old, encoding="ascii") as file:
    check(file.read() == "by gcode2vdb 0.1: old", "the old file stays")
done = subprocess.run([GCODE2VDB, gcode("tile.gcode"), "-o", os.path.join(FOLDER, "a.vdb"), "--elastic", "3500"],
                      capture_output=True, text=True)
check(done.returncode == 2 and ".inp" in done.stderr, "--elastic is for elements")

# What CalculiX computes of them.
skip_without(("ccx", "prusa-slicer"))

errors = {}
for per_layer in (1, 2, 3):
    moved, theory, made = deflection(per_layer, elastic=f"{YOUNG},{POISSON}")
    errors[per_layer] = moved / theory - 1
    print(f"{4 * per_layer} elements across: {made['elements']} elements, {made['written_mm3']:.1f} mm3, tip {moved:.5f} mm, "
          f"beam theory {theory:.5f} mm: {100 * errors[per_layer]:+.2f} %")
check(abs(errors[2]) < 0.03, "a cantilever at 8 elements across is within 3 % of beam theory")
check(abs(errors[3] - errors[2]) < 0.005, "and hardly another one at 12")

# Off the lattice sides are ragged, so that the volume is right: a little softer.
for width, off in ((2.0, 0.44), (1.9, 0.12)):
    moved, theory, made = deflection(2, elastic=f"{YOUNG},{POISSON}", width=width, off=off)
    print(f"{width} mm wide, {off} elements off the faces: tip {100 * (moved / theory - 1):+.2f} %, "
          f"{100 * made['written_mm3'] / made['solid_mm3']:.2f} % of the volume")
    check(abs(moved / theory - 1) < 0.1, "a beam that lies off the lattice is within 10 % of beam theory")
    check(abs(made["written_mm3"] / made["solid_mm3"] - 1) < 0.01, "and holds its plastic")

# Beads lie along x: of a material that is stiff along them alone, the beam bends as the first modulus says.
orthotropic = f"{YOUNG},{YOUNG / 4},{YOUNG / 4},{POISSON},{POISSON},{POISSON},{SHEAR},{SHEAR / 4},{SHEAR}"
moved, theory, made = deflection(2, elastic=orthotropic)
print(f"orthotropic: tip {moved:.5f} mm, by the modulus along the beads {theory:.5f} mm, {made['directions']} direction")
check(abs(moved / theory - 1) < 0.04 and made["directions"] == 1, "the first axis of an orthotropic material is the bead's")

# The same beads, turned by 30 degrees in the G-code, stretched along their lines: the oriented sections turn with them.
for turn in (0, 30):
    a = math.radians(turn)

    def at(u, v):
        return f"X{10 + u * math.cos(a) - v * math.sin(a):.4f} Y{20 + u * math.sin(a) + v * math.cos(a):.4f}"

    text = "M83\n"
    for layer in range(1, 4):
        text += f";LAYER_CHANGE\n;Z:{layer / 2}\n;HEIGHT:0.5\n;WIDTH:1\nG1 Z{layer / 2} F600\n"
        for row in range(6):
            text += f"G0 {at(0, 0.5 * row)} F6000\nG1 {at(12, 0.5 * row)} E{0.4463 * 12 / 2.4053:.5f} F1200\n"
    path, made = elements(write(f"turned{turn}.gcode", text), f"turned{turn}", "--voxel-size", "0.25", "--section", "0.001",
                          "--elastic", orthotropic)
    nodes = read_nodes(path)
    along = {n: (x - 10) * math.cos(a) + (y - 20) * math.sin(a) for n, (x, y, _) in nodes.items()}
    # Each node of both ends is moved as a homogeneous stretch of 0.1 % along the beads does: the ends' reaction is
    # modulus x strain x section.
    low = [n for n, u in along.items() if u < 1.5]
    high = [n for n, u in along.items() if u > 10.5]
    deck = node_set("LOW", low) + node_set("HIGH", high) + "*STEP\n*STATIC\n*BOUNDARY\nLOW, 1, 3, 0.\n"
    deck += f"HIGH, 1, 1, {0.009 * math.cos(a):.9f}\nHIGH, 2, 2, {0.009 * math.sin(a):.9f}\nHIGH, 3, 3, 0.\n"
    deck += "*NODE PRINT, NSET=HIGH, TOTALS=ONLY\nRF\n*END STEP\n"
    table, = solve(path, f"stretched{turn}", deck, "total force")
    force = table[0][0] * math.cos(a) + table[0][1] * math.sin(a)
    print(f"turned by {turn} degrees: {made['directions']} direction(s), {force:.2f} N")
    if turn == 0:
        straight = force
check(abs(force / straight - 1) < 0.05, "a turned print is as stiff along its beads as one that is not")

# Infill: a tile of 12 x 8 x 0.8 mm by PrusaSlicer, without solid layers, stretched by 0.1 %.
model = os.path.join(FOLDER, "tile.stl")
write_box(model, 12, 8, 0.8)
moduli = {}
for density in (20, 40, 70, 100):
    sliced = os.path.join(FOLDER, f"tile{density}.gcode")
    run("prusa-slicer", "--export-gcode", "--layer-height", "0.2", "--first-layer-height", "0.2", "--skirts", "0",
        "--perimeters", "1", "--top-solid-layers", "0", "--bottom-solid-layers", "0", "--fill-pattern",
        "rectilinear", "--fill-density", f"{density}%", "--filament-diameter", "1.75", "-o", sliced, model)
    path, made = elements(sliced, f"tile{density}", "--voxel-size", "0.2", "--elastic", f"{YOUNG},{POISSON}")
    nodes = read_nodes(path)
    xs = [x for x, _, _ in nodes.values()]
    length = max(xs) - min(xs)
    deck = ("*STEP\n*STATIC\n*BOUNDARY\nXMIN, 1, 3, 0.\n" f"XMAX, 1, 1, {0.001 * length}\n"
            "XMAX, 2, 3, 0.\n*NODE PRINT, NSET=XMAX, TOTALS=ONLY\nRF\n*END STEP\n")
    table, = solve(path, f"stretch{density}", deck, "total force")
    share = made["written_mm3"] / (12 * 8 * 0.8)
    moduli[density] = (share, table[0][0] / (8 * 0.8 * 0.001) / YOUNG, made)
    print(f"infill {density} %: {made['elements']} elements, solid {share:.3f}, modulus {moduli[density][1]:.3f} of the plastic's")
steps = list(moduli.values())
check(all(a[0] < b[0] and a[1] < b[1] for a, b in zip(steps, steps[1:])), "stiffness grows with infill")
check(all(modulus <= 1.02 * share for share, modulus, _ in steps), "and stays below the share of solid (Voigt's bound)")
# Gibson and Ashby, Cellular Solids (1997): E ~ share^n, n from 1 (walls along the load) to 3 (walls that bend).
(low_share, low, _), (high_share, high, _) = steps[0], steps[-1]
exponent = math.log(high / low) / math.log(high_share / low_share)
check(1 <= exponent <= 3, f"as share^{exponent:.2f}, between 1 and 3")

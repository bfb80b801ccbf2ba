"""gcode2vdb --report: its files and options, what it needs no file for, what it refuses."""

import json
import os
import re
import shutil
import subprocess

from run_tools import BIN, Scratch, check, gcode

GCODE2VDB = os.path.join(BIN, "gcode2vdb")
SCRATCH = Scratch("report", GCODE2VDB)
FOLDER, path, call, does = SCRATCH.folder, SCRATCH.path, SCRATCH.call, SCRATCH.does
COARSE = ["--voxel-size", "0.1", "--quiet"]


def report(name):
    with open(path(name), encoding="utf-8") as file:
        return json.load(file)


def value(data, key):
    return data["numbers"][key]["value"]


shutil.copy(gcode("tile.gcode"), path("t.gcode"))

# --- three files at once, and no .vdb that nobody asked for -------------------------------------------------------------
does("t.gcode", "--report", "t.json", "--report", "t.md", "--report", "t.html", *COARSE)
check(sorted(os.listdir(FOLDER)) == ["t.gcode", "t.html", "t.json", "t.md"], "the three files alone")
plain = report("t.json")
for key, number in plain["numbers"].items():
    check(set(number) >= {"title", "value", "unit", "definition"}, f"{key} has title, value, unit and definition")
left = {one["number"]: one for one in plain["left_out"]}
check("--price" in left["cost"]["remedy"], "no price in the file: the cost is left out, with the remedy")
layers = plain["by_layer"]
check(all(len(c["values"]) == len(layers["layer"]) for c in layers["columns"].values()), "a value a layer")
check(len(plain["by_height"]["from_mm"]) == 24, "24 layers by height")
with open(path("t.html"), encoding="utf-8") as file:
    page = file.read()
check(len(page) < 1e6 and page.count("<svg") == 6 and not re.search(r"src=|href=|<script", page), "a page that needs no other")
check(all(number["title"] in page for number in plain["numbers"].values()), "  with all numbers")

# --- mass and cost -----------------------------------------------------------------------------------------------------
does("t.gcode", "--report", "t.json", "--density", "1.24", "--price", "25", *COARSE)
heavy = report("t.json")
mass = 1.24e-3 * value(heavy, "deposited_volume")
check(abs(value(heavy, "mass") - mass) < 1e-5 * mass, "mass by the density that is given")
check(abs(value(heavy, "cost") - mass * 0.025) < 1e-5 * mass, "cost by the price that is given")
with open(path("t.gcode"), encoding="utf-8") as file:
    text = file.read()
for key in ("filament_density", "filament_cost"):
    text = re.sub(rf"(?m)^; {key} = .*\n", "", text)
with open(path("stated.gcode"), "w", encoding="utf-8") as file:
    file.write(text + "; filament_density = 1.27\n; filament_cost = 40\n")
does("stated.gcode", "--report", "stated.json", *COARSE)
stated = report("stated.json")
check(abs(value(stated, "mass") / value(heavy, "mass") - 1.27 / 1.24) < 1e-6, "density and price of the file")
check(abs(value(stated, "cost") / value(stated, "mass") - 0.04) < 1e-6, "  both")

# --- units, axes and places don't matter; the .vdb is the same with a report ---------------------------------------------
does("t.gcode", "--report", "m.json", "-o", "m.vdb", "--unit", "m", "--up", "y", "--origin", "center", *COARSE)
moved = report("m.json")
for key in ("plastic_volume", "enclosed_volume", "outer_surface", "porosity", "thinnest_wall", "roughness_ra"):
    check(abs(value(moved, key) - value(plain, key)) <= 2e-4 * abs(value(plain, key)), f"{key} in print millimetres")
check(all(abs(a - b) < 1e-3 for a, b in zip(value(moved, "center_of_mass"), value(plain, "center_of_mass"))), "center, too")
does("t.gcode", "-o", "with.vdb", "--report", "with.json", *COARSE)
does("t.gcode", "-o", "without.vdb", *COARSE)


def lines(name):
    return subprocess.run(["vdb_print", "-l", path(name)], capture_output=True, text=True).stdout.replace(name, "")


check(lines("with.vdb") == lines("without.vdb"), "the same level set with a report and without")

# --- selections, culling, meshes, settled beads ------------------------------------------------------------------------------
does("t.gcode", "--report", "l.json", "--layers", "3:8", "--features", "-skirt", *COARSE)
some = report("l.json")
check(some["by_layer"]["layer"] == [3, 4, 5, 6, 7, 8] and "3:8" in some["print"]["selection"], "six layers of it")
check(value(some, "bed_contact") == 0, "  that lie on no bed")
does("t.gcode", "-o", "t.stl", "--report", "c.json", "--features", "all", *COARSE)
culled = report("c.json")
why = {one["number"]: one["remedy"] for one in culled["left_out"]}
check("--interior keep" in why["porosity"] and "porosity" not in culled["numbers"], "a mesh is culled: no porosity")
check(abs(value(culled, "enclosed_volume") / value(plain, "enclosed_volume") - 1) < 0.01, "  but the same hull")
does("t.gcode", "--report", "s.json", "--beads", "settled", *COARSE)
settled = report("s.json")
check(value(settled, "plastic_volume") > value(plain, "plastic_volume"), "settled beads fill grooves")

# --- streams, and what is refused ----------------------------------------------------------------------------------------
done = does("t.gcode", "--report", "-.json", "--voxel-size", "0.2")
check("numbers" in json.loads(done.stdout), "-.json is standard output, and nothing else is")
for options, status, fragment in (
        (["t.gcode", "--report", "t.txt"], 2, ".json, .md or .html"),
        (["t.gcode", "stated.gcode", "--report", "t.json"], 2, "one input"),
        (["t.gcode", "--report", "none/t.json"], 1, "none"),
        (["t.gcode", "--report", "a.md", "--report", "a.md"], 2, "already"),
        (["t.gcode", "--density", "1.2"], 2, "--report"),
        (["t.gcode", "--report", "t.json", "--density", "-1"], 2, "--density"),
        (["t.gcode", "-o", "p.inp", "--report", "t.json"], 2, "run once for each")):
    before = sorted(os.listdir(FOLDER))
    done = call(*options)
    check(done.returncode == status and fragment in done.stderr, f"{' '.join(options)}: {done.stderr.strip()}")
    check(sorted(os.listdir(FOLDER)) == before, "  and nothing is left behind")
shutil.rmtree(FOLDER)

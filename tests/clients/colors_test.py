"""Colours of a print's tools in every format, read by real programs: Blender, lib3mf, PrusaSlicer, admesh; and by their names."""

import ctypes
import ctypes.util
import hashlib
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
import zipfile

from run_tools import BIN, check, corpus, gcode, run

FOLDER = tempfile.mkdtemp(prefix="stratum_colors_")
INSIDE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "colors_inside.py")
PRINT = gcode("two_tone.gcode")
COMMON = ["--layers", "6:10", "--voxel-size", "0.3"]
FIRST, SECOND = "#c04020", "#2060e0"
COLORS = ["--color", f"{FIRST},{SECOND}"]


def convert(name, *options, source=PRINT, common=COMMON):
    path = os.path.join(FOLDER, name)
    return path, json.loads(run(os.path.join(BIN, "gcode2vdb"), source, "-o", path, "--stats", "-", *common, *options))


def refused(status, word, *command):
    done = subprocess.run(command, capture_output=True, text=True)
    check(done.returncode == status and word in done.stderr, f"{' '.join(command[1:])}: {done.stderr.strip()}")


def linear(color):
    values = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in values]


def near(a, b, within=2e-3):
    return all(abs(x - y) < within for x, y in zip(a, b))


def closed(triangles):
    """Whether every edge is used as often in one direction as in the other."""
    edges = {}
    for a, b, c in triangles:
        for p, q in ((a, b), (b, c), (c, a)):
            edges[min(p, q), max(p, q)] = edges.get((min(p, q), max(p, q)), 0) + (1 if p < q else -1)
    return not any(edges.values())


# --- tools ---------------------------------------------------------------------------------------------------------------
whole = convert("whole.vdb")[1]
parts = [convert(f"tool{tool}.vdb", "--tool", str(tool))[1] for tool in (0, 1)]
both = convert("both.vdb", "--tool", "0,1")[1]
check(both["grid"]["active_voxels"] == whole["grid"]["active_voxels"], "--tool 0,1 is the whole print")
beads = [report["files"][0]["beads"] for report in parts]
check(sum(beads) == whole["files"][0]["beads"] and min(beads) > 0, f"  and each tool alone a part of it: {beads}")
refused(2, "its tools are 0, 1", os.path.join(BIN, "gcode2vdb"), PRINT, "-o", os.path.join(FOLDER, "no.vdb"), "--tool", "5")
refused(2, "its tools are 0, 1", os.path.join(BIN, "vdbtrace"), PRINT, "-o", os.path.join(FOLDER, "no.png"), "--tool", "0,5")
solid, report = convert("part.inp", "--tool", "1", common=["--layers", "6:10", "--voxel-size", "0.4"])
with open(solid, encoding="ascii") as file:
    sets = set(re.findall(r"^\*ELSET, ELSET=(\w+)", file.read(), re.M | re.I))
check(any("tool_1" in s.lower() for s in sets) and not any("tool_0" in s.lower() for s in sets),
      f"solid elements of one tool: {sorted(sets)}")

# --- meshes --------------------------------------------------------------------------------------------------------------
made = {}
for ending in ("stl", "ply", "obj", "3mf", "glb", "usda"):
    made[ending] = convert("part." + ending, *COLORS)
triangles = made["glb"][1]["files"][0]["mesh"]["triangles"]
for ending in ("obj", "3mf", "usda"):
    check(made[ending][1]["files"][0]["mesh"]["triangles"] == triangles, f"{ending} has the triangles of glb")
for ending in ("3mf", "glb", "usda", "obj"):
    again, _ = convert("again." + ending, *COLORS, "--threads", "1")
    pair = [hashlib.sha256(open(p, "rb").read().replace(b"again.mtl", b"part.mtl")).digest() for p in (made[ending][0], again)]
    check(pair[0] == pair[1], f"{ending}: the same bytes again, by one thread")

# 3MF: by Python alone ...
path = made["3mf"][0]
with zipfile.ZipFile(path) as archive:
    check(archive.testzip() is None and archive.namelist() == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"],
          f"a package: {archive.namelist()}")
    model = ET.fromstring(archive.read("3D/3dmodel.model"))
space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
check(model.get("unit") == "millimeter", "  in mm")
bases = [(base.get("name"), base.get("displaycolor").lower()) for base in model.iter(space + "base")]
check(bases == [("tool_0", FIRST), ("tool_1", SECOND)], f"  with a material a tool: {bases}")
points = [tuple(float(v.get(a)) for a in "xyz") for v in model.iter(space + "vertex")]
faces = [(tuple(int(t.get(k)) for k in ("v1", "v2", "v3")), int(t.get("p1", 0))) for t in model.iter(space + "triangle")]
check(len(faces) == triangles and closed([face for face, _ in faces]), f"  and a closed surface of {len(faces)} triangles")


def area(face):
    a, b, c = (points[k] for k in face)
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return 0.5 * sum(x * x for x in n) ** 0.5


areas = [sum(area(face) for face, material in faces if material == k) for k in (0, 1)]
check(min(areas) > 20, f"  of both: {areas[0]:.0f} and {areas[1]:.0f} mm2")

# ... by lib3mf, the reader of the 3MF Consortium ...
name = ctypes.util.find_library("3MF") or "lib3MF.so.1"
try:
    lib = ctypes.CDLL(name)
except OSError:
    sys.exit(f"{name} is not installed (lib3mf1)")


def ask(function, *arguments):
    status = getattr(lib, "lib3mf_" + function)(*arguments)
    check(status == 0, f"  lib3mf_{function}: {status:#x}")


def handle(function, owner=None, *arguments):
    out = ctypes.c_void_p()
    ask(function, *([owner] if owner is not None else []), *arguments, ctypes.byref(out))
    return out


def number(function, *arguments):
    out = ctypes.c_uint32()
    ask(function, *arguments, ctypes.byref(out))
    return out.value


def only(iterator):
    ask("resourceiterator_movenext", iterator, ctypes.byref(ctypes.c_int()))
    return handle("resourceiterator_getcurrent", iterator)


document = handle("createmodel")
reader = handle("model_queryreader", document, b"3mf")
ask("reader_readfromfileutf8", reader, path.encode())
check(number("reader_getwarningcount", reader) == 0, "lib3mf reads it without a warning")
shape = only(handle("model_getmeshobjects", document))
check(number("meshobject_gettrianglecount", shape) == triangles, "  finds the triangles")
materials = only(handle("model_getbasematerials", document))
channels = (ctypes.c_ubyte * 4)()
seen = []
for n in range(number("basematerial_getcount", materials)):
    ask("basematerial_getdisplaycolor", materials, n, *[ctypes.byref(channels, k) for k in range(4)])
    seen.append("#%02x%02x%02x" % tuple(channels[:3]))
check(seen == [FIRST, SECOND], f"  and the colours: {seen}")
groups, indices = (ctypes.c_uint32 * triangles)(), (ctypes.c_uint32 * triangles)()
ask("propertyhandler_getbasematerialarray", handle("meshobject_createpropertyhandler", shape), groups, indices)
check(list(indices) == [material for _, material in faces], "  on the triangles that have them")

# ... by PrusaSlicer, whose STL of it goes to admesh.
info = run("prusa-slicer", "--info", path)
volume = float(re.search(r"volume = ([\d.]+)", info).group(1))
exact = made["3mf"][1]["files"][0]["mesh"]["volume_mm3"]
check("manifold = yes" in info and abs(volume / exact - 1) < 1e-3, f"PrusaSlicer: manifold, {volume:.1f} of {exact:.1f} mm3")
copy = os.path.join(FOLDER, "slicer.stl")
run("prusa-slicer", "--export-stl", path, "-o", copy)
found = run("admesh", copy)
check(re.search(r"Total disconnected facets\s*:\s*0\s", found), "admesh: nothing is disconnected")

# A file of an earlier run is replaced, a slicer's project is not.
convert("part.3mf", *COLORS)
project = os.path.join(FOLDER, "project.3mf")
run("prusa-slicer", "--export-3mf", copy, "-o", project)
refused(2, "--force", os.path.join(BIN, "gcode2vdb"), PRINT, "-o", project, *COMMON)

# GLB by its own numbers.
data = open(made["glb"][0], "rb").read()
magic, version, length, head, kind = struct.unpack("<4sIII4s", data[:20])
check((magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON") and head % 4 == 0, "a .glb")
root = json.loads(data[20 : 20 + head])
check([m["name"] for m in root["materials"]] == ["tool_0", "tool_1"], "  with a material a tool")
check(near(root["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"], linear(SECOND), 1e-6), "  in linear light")
check(sum(root["accessors"][p["indices"]]["count"] for p in root["meshes"][0]["primitives"]) == 3 * triangles,
      "  and all triangles")

# USD as text.
with open(made["usda"][0], encoding="utf-8") as file:
    text = file.read()
check(all(text.count(a) == text.count(b) for a, b in ("{}", "()", "[]")), "a .usda whose brackets close")
subsets = [[int(n) for n in found.split(", ")] for found in re.findall(r"int\[\] indices = \[([\d, ]+)\]", text)]
counts = re.search(r"faceVertexCounts = \[([\d, ]+)\]", text).group(1).split(", ")
check(len(subsets) == 2 and sorted(subsets[0] + subsets[1]) == list(range(len(counts))), "  whose subsets part its faces")
check(re.findall(r"rel material:binding = <(.*?)>", text) == ["/print/materials/tool_0", "/print/materials/tool_1"],
      "  and are bound to their materials")
check(len(re.findall(r"-?\d+", re.search(r"faceVertexIndices = \[(.*?)\]", text).group(1))) == sum(map(int, counts)),
      "  with the corners that it counts")

# Blender.
done = subprocess.run(
    ["blender", "--background", "--factory-startup", "--python-exit-code", "1", "--python", INSIDE, "--",
     *[made[e][0] for e in ("obj", "glb", "ply")]], capture_output=True, text=True)
results = [json.loads(line[7:]) for line in done.stdout.splitlines() if line.startswith("RESULT ")]
if done.returncode != 0 or len(results) != 3:
    sys.exit(f"blender ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
low, high = ([f(p[a] for p in points) for a in range(3)] for f in (min, max))
for result in results:
    scale = 1e3 if result["file"].endswith("glb") else 1
    check(near([scale * x for x in result["low"]], low, 0.01) and near([scale * x for x in result["high"]], high, 0.01),
          f"Blender: {result['file']} stands where the 3MF does")
    check(result["triangles"] == triangles, f"  with {triangles} triangles")
    if result["file"].endswith("ply"):
        seen = result["points"]
        for color in (FIRST, SECOND):
            exact = [int(color[k : k + 2], 16) / 255 for k in (1, 3, 5)]
            check(any(near(point, exact, 5e-3) for point in seen), f"  whose points have {color}")
        check(len(seen) == 2, "  and no other colour")
        continue
    check(sorted(result["materials"]) == ["tool_0", "tool_1"], f"  materials: {sorted(result['materials'])}")
    for tool, color in ((0, FIRST), (1, SECOND)):
        entry = result["materials"][f"tool_{tool}"]
        check(near(entry["color"], linear(color)), f"  tool {tool} is {color}")
        check(abs(entry["area"] * scale * scale / areas[tool] - 1) < 1e-3, f"  on {entry['area']:.3g} of area")

# One material: of one tool, in its own colour; and none, if surfaces alone are asked for.
path, _ = convert("one.glb", "--tool", "1", *COLORS)
data = open(path, "rb").read()
root = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
check([m["name"] for m in root["materials"]] == ["tool_1"], "one tool, one material")
path, _ = convert("bare.glb", "--grids", "surface")
data = open(path, "rb").read()
check("materials" not in json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]]), "--grids surface: no colours")
plain, _ = convert("plain.obj")
check(not os.path.exists(os.path.join(FOLDER, "plain.mtl")) and "usemtl" not in open(plain).read(),
      "an .obj has colours only if asked for")
refused(2, "name a file", os.path.join(BIN, "gcode2vdb"), PRINT, "-o", "-.obj", *COMMON, *COLORS, "--quiet")
refused(2, "has no voxels", os.path.join(BIN, "gcode2vdb"), PRINT, "-o", os.path.join(FOLDER, "x.stl"), "--grids", "color")

# Units and axes that formats state.
_, tall = convert("cm.3mf", "--unit", "cm", "--up", "y", "--origin", "center")
with zipfile.ZipFile(os.path.join(FOLDER, "cm.3mf")) as archive:
    model = ET.fromstring(archive.read("3D/3dmodel.model"))
heights = [float(v.get("z")) for v in model.iter(space + "vertex")]
check(model.get("unit") == "centimeter" and abs(10 * (max(heights) - min(heights)) - (high[2] - low[2])) < 0.21,
      "a 3MF says its unit, and z stays up")

# A real print of two colours, if the corpus is there.
if real := corpus("slicer-meta-flashstudio_2color.gcode.3mf"):
    path, _ = convert("real.3mf", source=real, common=["--voxel-size", "0.3"])
    with zipfile.ZipFile(path) as archive:
        model = ET.fromstring(archive.read("3D/3dmodel.model"))
    bases = {(base.get("name"), base.get("displaycolor").lower()) for base in model.iter(space + "base")}
    check(bases == {("tool_0", "#ffffff"), ("tool_1", "#00c1ae")}, f"FlashStudio's print of two colours: {bases}")
    check("manifold = yes" in run("prusa-slicer", "--info", path), "  is manifold")

# --- names ---------------------------------------------------------------------------------------------------------------
tool = os.path.join(BIN, "vdbtrace")
listed = run(tool, "--colors", "prusament galaxy").splitlines()
check(len(listed) == 5 and all("Prusament" in line for line in listed), f"--colors lists: {listed}")
check(run(os.path.join(BIN, "gcode2vdb"), "--colors", "prusament galaxy").splitlines() == listed, "  by both tools")
refused(2, "did you mean 'Devil Design PETG Galaxy Black'", tool, PRINT, "--color", "Galaxy Black")
refused(2, "Prusament", tool, PRINT, "--color", "Prusament Galxy Blck")
refused(2, "no filament has", tool, "--colors", "nosuchword")
_, report = convert("named.vdb", "--color", "Prusament Galaxy Black,Bambu Lab Purple Galaxy")
seen = [entry["color"] for entry in report["toolpath"]["tools"]]
check(seen == ["#3d3e3d", "#594177"], f"filaments by their names: {seen}")


def trace(name, source, *options):
    path = os.path.join(FOLDER, name)
    return json.loads(run(tool, source, "-o", path, "--size", "160x120", "--spp", "4", "--stats", "-", *options))


view = ["--view", "top", "--layers", "6:10", "--voxel-size", "0.3"]
report = trace("tools.png", PRINT, *view, *COLORS)
stated = [entry["color"] for entry in report["material"]["colors"]]
check(sorted(stated) == sorted([FIRST, SECOND]), f"vdbtrace: a colour a tool: {stated}")
for finish in ("silk", "matte", "glitter"):
    trace(finish + ".png", PRINT, *view, "--brdf", f"{finish}:0.6,0.3,0.1")
    check(os.path.getsize(os.path.join(FOLDER, finish + ".png")) > 2000, f"  a picture in {finish}")
trace("finished.png", PRINT, *view, "--color", "Bambu Lab Purple Galaxy,3DJAKE Silk Gold")
check(open(os.path.join(FOLDER, "finished.png"), "rb").read() !=
      open(os.path.join(FOLDER, "tools.png"), "rb").read(), "  finishes by name")
refused(2, "needs G-code", tool, os.path.join(FOLDER, "named.vdb"), "--color", "red,blue")

# --- mixes ---------------------------------------------------------------------------------------------------------------
mixed = os.path.join(FOLDER, "mixed.gcode")
with open(PRINT, encoding="utf-8") as file:
    lines = file.read()
with open(mixed, "w", encoding="utf-8") as file:
    file.write("M163 S0 P0.5\nM163 S1 P0.5\nM164 S1\n" + lines)
_, report = convert("mixed.glb", "--color", "#ffff00,#00ffff", source=mixed)
data = open(os.path.join(FOLDER, "mixed.glb"), "rb").read()
root = json.loads(data[20 : 20 + struct.unpack("<I", data[12:16])[0]])
mix = root["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"]
check(mix[1] > 0.9 and mix[0] < 0.1 and mix[2] < 0.1, f"yellow and cyan mix to green: {mix}")
done = subprocess.run([os.path.join(BIN, "gcode2vdb"), mixed, "-o", os.path.join(FOLDER, "m.vdb"), *COMMON],
                      capture_output=True, text=True)
check("mixes filaments" in done.stderr, f"without colours it says so: {done.stderr.strip()}")

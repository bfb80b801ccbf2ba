"""Runs inside Blender: imports each mesh given after `--` and prints its materials, the share of its area that each has, its
box, and the colours of its points."""

import json
import os
import sys

import bpy

# Debian's NumPy, which the importer of glTF needs, is not found where another python3 comes first on PATH.
sys.path.append("/usr/lib/python3/dist-packages")
import numpy  # noqa: E402

# The importer of Blender 3.4 uses a name that Debian's NumPy, 1.24, no longer has.
numpy.bool = bool

for path in sys.argv[sys.argv.index("--") + 1 :]:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ending = os.path.splitext(path)[1]
    if ending == ".obj":
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    elif ending == ".glb":
        bpy.ops.import_scene.gltf(filepath=path)
    elif bpy.app.version >= (4, 0):
        bpy.ops.wm.ply_import(filepath=path)
    else:
        bpy.ops.import_mesh.ply(filepath=path)
    result = {"file": os.path.basename(path), "materials": {}, "triangles": 0, "low": [1e9] * 3, "high": [-1e9] * 3}
    for shape in [o for o in bpy.data.objects if o.type == "MESH"]:
        mesh = shape.data
        for vertex in mesh.vertices:
            place = shape.matrix_world @ vertex.co
            for axis in range(3):
                result["low"][axis] = min(result["low"][axis], place[axis])
                result["high"][axis] = max(result["high"][axis], place[axis])
        for polygon in mesh.polygons:
            result["triangles"] += len(polygon.vertices) - 2
            if not mesh.materials:
                continue
            material = mesh.materials[polygon.material_index]
            surface = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
            entry = result["materials"].setdefault(
                material.name, {"color": list(surface.inputs["Base Color"].default_value)[:3], "area": 0.0})
            entry["area"] += polygon.area
        if mesh.color_attributes:
            colors = {tuple(round(c, 3) for c in datum.color_srgb[:3]) for datum in mesh.color_attributes[0].data}
            result["points"] = sorted(colors)
    print("RESULT " + json.dumps(result))

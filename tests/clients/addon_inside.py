"""Runs inside Blender: the add-on's import, good and bad, and a Cycles render. Prints RESULT and one JSON line."""

import json
import os
import sys
import time

import bpy

ADDON, GCODE, LARGE, PICTURE = sys.argv[sys.argv.index("--") + 1 :]
sys.path.insert(0, os.path.dirname(ADDON))
bpy.ops.preferences.addon_install(filepath=ADDON)
bpy.ops.preferences.addon_enable(module="stratum_import")
import stratum_import  # noqa: E402

result = {}


def clear():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="stratum_import")


def run(**options):
    """What the operator returned, or what it said."""
    try:
        return list(bpy.ops.import_scene.stratum_gcode(**options))[0]
    except RuntimeError as error:
        return str(error)


def measure(thing):
    """Box and volume of the evaluated mesh in world space."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    points = [thing.matrix_world @ v.co for v in mesh.vertices]
    six = sum(points[a].dot(points[b].cross(points[c])) for a, b, c in (t.vertices for t in mesh.loop_triangles))
    smooth = all(p.use_smooth for p in mesh.polygons)
    evaluated.to_mesh_clear()
    return {"min": [min(p[i] for p in points) for i in range(3)] if points else None,
            "max": [max(p[i] for p in points) for i in range(3)] if points else None,
            "volume": six / 6, "smooth": smooth, "faces": len(points)}


# One print, in millimetres.
clear()
result["import"] = run(filepath=GCODE, voxel_size=0.1, features="-skirt,-brim,-custom", interior="keep", scale=1.0, grids="layer")
mesh = next(o for o in bpy.data.objects if o.type == "MESH")
result["mesh"] = measure(mesh)
result["materials"] = [list(m.diffuse_color) for m in mesh.data.materials]
volume = next(o for o in bpy.data.objects if o.type == "VOLUME")
result["grids"] = sorted(g.name for g in volume.data.grids)

# A picture of it.
low, high = result["mesh"]["min"], result["mesh"]["max"]
middle = [(a + b) / 2 for a, b in zip(low, high)]
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
bpy.context.collection.objects.link(camera)
camera.location = (middle[0], middle[1] - 40, middle[2] + 30)
camera.rotation_euler = (0.93, 0, 0)
lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
lamp.data.energy = 4
lamp.rotation_euler = (0.6, 0.5, 0)
bpy.context.collection.objects.link(lamp)
scene = bpy.context.scene
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.samples = 4
scene.cycles.use_denoising = False  # Debian has no denoiser
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 120, 100
scene.render.filepath = PICTURE
bpy.ops.render.render(write_still=True)
pixels = bpy.data.images.load(PICTURE).pixels[:]
result["lit"] = sum(1 for i in range(0, len(pixels), 4) if pixels[i] > 1.2 * pixels[i + 2] and pixels[i] > 0.1)

# Ten steps of a print.
clear()
result["sequence"] = run(filepath=GCODE, voxel_size=0.2, features="-skirt,-brim,-custom", snapshots=10, frames=2, scale=1.0)
tops, seen = [], []
for step in range(10):
    bpy.context.scene.frame_set(1 + 2 * step)
    shown = [o for o in bpy.data.objects if o.type == "MESH" and not o.hide_render]
    seen.append(len(shown))
    tops.append(measure(shown[0])["volume"])
result["seen"], result["volumes"], result["end"] = seen, tops, bpy.context.scene.frame_end

# What goes wrong.
clear()
bad = os.path.join(os.path.dirname(PICTURE), "bad.gcode")
with open(bad, "w", encoding="ascii") as file:
    file.write("Dear printer, please print a boat.\n")
result["bad"] = run(filepath=bad)
result["absent"] = run(filepath="/nowhere/print.gcode")
preferences = bpy.context.preferences.addons["stratum_import"].preferences
preferences.converter = "/nowhere/gcode2vdb"
result["no_binary"] = run(filepath=GCODE)
preferences.converter = ""
result["objects_left"] = len(bpy.data.objects)

# Cancel in the middle, as the modal operator does.
conversion = stratum_import.Conversion(LARGE, ["--voxel-size", "0.04", "--interior", "keep"])
start = time.perf_counter()
while conversion.poll() and time.perf_counter() - start < 0.5:
    time.sleep(0.02)
result["was_running"] = conversion.process.poll() is None
conversion.cancel()
result["cancelled"] = conversion.process.returncode
result["left"] = os.path.exists(conversion.folder)
print("RESULT " + json.dumps(result))

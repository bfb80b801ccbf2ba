"""Runs inside Blender: the add-on's import, good and bad, and a Cycles render. Prints RESULT and one JSON line."""

import json
import os
import shutil
import struct
import sys
import tempfile

import bpy
import numpy

ZIP, DATA, FOLDER = sys.argv[sys.argv.index("--") + 1 :]
TILE, TWO_TONE = (os.path.join(DATA, name) for name in ("tile.gcode", "two_tone.gcode"))
PLAIN = "-skirt,-brim,-custom"
bpy.ops.preferences.addon_install(filepath=ZIP)
bpy.ops.preferences.addon_enable(module="stratum_import")
from stratum_import import conversion, materials, objects, session, settings  # noqa: E402

tempfile.tempdir = os.path.join(FOLDER, "temporary")
os.mkdir(tempfile.tempdir)
preferences = bpy.context.preferences.addons["stratum_import"].preferences
result = {}


def clear(empty=True):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=empty)
    bpy.ops.preferences.addon_enable(module="stratum_import")
    global preferences
    preferences = bpy.context.preferences.addons["stratum_import"].preferences


def run(**options):
    """What the operator returned, or what it said."""
    try:
        return list(bpy.ops.import_scene.stratum_gcode(**options))[0]
    except RuntimeError as error:
        return str(error)


def program(name, *lines):
    """A stand-in for gcode2vdb."""
    path = os.path.join(FOLDER, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\n" + "\n".join(lines) + "\n")
    os.chmod(path, 0o755)
    return path


def measure(thing):
    """Box and volume in world space of a mesh as shown, and what its faces are like."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()

    def values(items, name, width, kind=numpy.float32):
        array = numpy.empty(len(items) * width, kind)
        items.foreach_get(name, array)
        return array.reshape(-1, width)

    points = values(mesh.vertices, "co", 3).astype(float)
    world = numpy.array(thing.matrix_world)
    points = points @ world[:3, :3].T + world[:3, 3]
    a, b, c = (points[column] for column in values(mesh.loop_triangles, "vertices", 3, numpy.int32).T)
    # Of the tetrahedra from a point of the surface.
    volume = float(numpy.einsum("ij,ij->", a - points[0], numpy.cross(b - points[0], c - points[0]))) / 6
    area = values(mesh.polygons, "area", 1)[:, 0]
    slot = values(mesh.polygons, "material_index", 1, numpy.int32)[:, 0]
    measured = {"min": points.min(0).tolist(), "max": points.max(0).tolist(), "volume": volume,
                "smooth": bool(values(mesh.polygons, "use_smooth", 1, bool).all()), "faces": len(mesh.polygons),
                "area_by_material": [float(area[slot == n].sum() / area.sum()) for n in range(len(thing.data.materials))]}
    evaluated.to_mesh_clear()
    return measured


def box(thing):
    corners = objects.corners_of(thing)
    return [[pick(corner[axis] for corner in corners) for axis in range(3)] for pick in (min, max)]


# --- one print, three ways --------------------------------------------------------------------------------------------
same = {"filepath": TILE, "voxel_size": 0.1, "features": PLAIN, "interior": "keep", "unit": "MM", "origin": "bed"}
clear()
result["mesh"] = run(**same), measure(bpy.context.object), bpy.context.object.data.validate()
clear()
result["modifier"] = run(**same, kind="MODIFIER", adaptivity=0), measure(bpy.context.object)
modifier = bpy.context.object.modifiers[0]
modifier.adaptivity = 0.2
result["adapted"] = measure(bpy.context.object)["faces"]
bpy.context.object.location.x += 100
result["moved"] = measure(bpy.context.object)["min"][0]
clear()
result["volume"] = run(**same, kind="VOLUME", grids="layer"), sorted(g.name for g in bpy.context.object.data.grids)
# With that volume still active.
result["after_volume"] = run(**same), [slot.material.node_tree.nodes[0].type
                                       for slot in bpy.context.object.material_slots]

# --- as it comes ------------------------------------------------------------------------------------------------------
clear(empty=False)
result["default"] = run(filepath=TILE, aim=True)
thing = bpy.context.object
result["name"], result["selected"] = thing.name, [o.name for o in bpy.context.selected_objects]
result["box"], result["cube"] = box(thing), box(bpy.data.objects["Cube"])
result["faces"] = len(thing.data.polygons)
result["remembered"] = preferences.last_settings
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 4
scene.cycles.use_denoising = False  # Debian has no denoiser
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 120, 100
scene.render.filepath = os.path.join(FOLDER, "tile.png")
bpy.ops.render.render(write_still=True)
pixels = numpy.array(bpy.data.images.load(scene.render.filepath).pixels[:]).reshape(120, 160, 4)
orange = (pixels[..., 0] > 1.2 * pixels[..., 2]) & (pixels[..., 0] > 0.05)
result["orange"] = int(orange.sum()), int(orange[[0, -1]].sum() + orange[:, [0, -1]].sum())

clear()
result["limited"] = run(filepath=TILE, faces=60000), len(bpy.context.object.data.polygons)
clear()
bpy.context.scene.unit_settings.scale_length = 0.01
result["scene_unit"] = run(filepath=TILE, unit="SCENE", origin="min", voxel_size=0.2), box(bpy.context.object)

# --- colors -----------------------------------------------------------------------------------------------------------
# A row of three squares, the last one of two triangles; the corners of the first two are red, one of the third.
painted = os.path.join(FOLDER, "painted.ply")
red, blue = (200, 30, 20), (31, 78, 107)
with open(painted, "wb") as file:
    file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
               b"property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 4\n"
               b"property list uchar uint vertex_indices\nend_header\n")
    for n in range(8):
        file.write(struct.pack("<3f3B", n // 2, n % 2, 0, *(red if n in (0, 1, 2, 3, 4) else blue)))
    for face in ((0, 2, 3, 1), (2, 4, 5, 3), (4, 6, 5), (6, 7, 5)):
        file.write(struct.pack(f"<B{len(face)}I", len(face), *face))
clear()
palette = materials.Palette("p", {"toolpath": {"tools": [{"tool": 0, "color": "#1f4e6c"}, {"tool": 1, "color": None}]}})
thing = objects.mesh_object(painted, "painted", 1.0, palette.of_faces)
result["painted"] = [m.name for m in thing.data.materials], [p.material_index for p in thing.data.polygons]
result["painted_colors"] = [list(m.diffuse_color) for m in thing.data.materials]
result["painted_valid"] = not thing.data.validate()
clear()
result["two"] = run(filepath=TWO_TONE, voxel_size=0.2), measure(bpy.context.object), [m.name for m in bpy.context.object.data.materials]

# --- what its file calls itself ---------------------------------------------------------------------------------------
result["names"] = {}
for name in ("part.v2.gcode", "a.b.c.gcode.3mf", "noise.gz", "x.GCODE"):
    result["names"][name] = settings.print_name(os.path.join("/somewhere.else", name))
named = shutil.copy(TILE, os.path.join(FOLDER, "part.v2.gcode"))
clear()
result["named"] = run(filepath=named, voxel_size=0.2), bpy.context.object.name

# --- removed while others were still being converted ---------------------------------------------------------------------
clear()
kept, gone, unlinked = (objects.link(name, None) for name in ("kept", "gone", "unlinked"))
bpy.data.objects.remove(gone)
bpy.context.collection.objects.unlink(unlinked)
result["still_there"] = [thing.name for thing in objects.still_there([kept, gone, unlinked])]

# --- several prints, one of them not a print --------------------------------------------------------------------------
bad = os.path.join(FOLDER, "bad.gcode")
with open(bad, "w", encoding="ascii") as file:
    file.write("Dear printer, please print a boat.\n")
shutil.copy(TWO_TONE, FOLDER)
clear()
result["batch"] = run(directory=FOLDER, files=[{"name": n} for n in ("part.v2.gcode", "bad.gcode", "two_tone.gcode")], voxel_size=0.2)
result["batch_boxes"] = {o.name: box(o) for o in bpy.context.selected_objects}

# --- ten steps of a print ---------------------------------------------------------------------------------------------
clear()
result["sequence"] = run(filepath=TILE, voxel_size=0.2, features=PLAIN, snapshots=10, frames=2)
seen, volumes = [], []
for step in range(10):
    bpy.context.scene.frame_set(1 + 2 * step)
    shown = [o for o in bpy.data.objects if o.type == "MESH" and not o.hide_render]
    seen.append(len(shown))
    volumes.append(measure(shown[0])["volume"])
result["seen"], result["volumes"], result["end"] = seen, volumes, bpy.context.scene.frame_end
result["sequence_materials"] = len(bpy.data.materials)

# --- a volume beside its .blend file ----------------------------------------------------------------------------------
clear()
os.mkdir(os.path.join(FOLDER, "work"))
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(FOLDER, "work", "scene.blend"))
result["kept"] = [(run(filepath=TILE, kind="VOLUME", voxel_size=0.2), bpy.context.object.data.filepath) for _ in range(2)]

# --- what goes wrong --------------------------------------------------------------------------------------------------
clear()
result["bad"] = run(filepath=bad)
result["absent"] = run(filepath="/nowhere/print.gcode")
preferences.converter = "/nowhere/gcode2vdb"
result["no_binary"] = run(filepath=TILE)
preferences.converter = program("failing", "echo 'gcode2vdb: a warning' >&2", "printf '\\r\\033[Kreading ━ 7 %%  1 s left\\r\\033[K' >&2",
                                "echo 'gcode2vdb: the disk is füll' >&2", "exit 1")
result["failing"] = run(filepath=TILE)
result["objects_left"] = len(bpy.data.objects)
# Far more than a pipe or a terminal holds.
converter = os.path.join(os.environ["STRATUM_BIN"], "gcode2vdb")
preferences.converter = program("chatty", "head -c 300000 /dev/zero | tr '\\0' 'x' >&2", "echo >&2",
                                "head -c 300000 /dev/zero | tr '\\0' 'x'", f'exec "{converter}" "$@"')
result["chatty"] = run(filepath=TILE, voxel_size=0.2)

# --- cancelled in the middle, as the modal operator does ---------------------------------------------------------------
# It has written half a file and says so; then it would go on for ever.
sleeping = program("sleeping", 'echo half > "$3"', "printf '\\r\\033[Kvoxelizing ━━━ 40 %%  9 s left' >&2", "exec sleep 1000000")
started = conversion.Conversion(sleeping, TILE, "tile.ply", [])
while started.progress == 0 and started.running():
    started.wait(0.01)
result["heard"] = started.stage, started.progress, os.listdir(started._folder)
process = started._process
started.cancel()
result["cancelled"] = process.returncode
defaults = settings.ImportSettings()
for name, kind in settings.ImportSettings.__annotations__.items():
    setattr(defaults, name, kind.keywords.get("default", ""))
clear()
several = session.Session([TILE, TWO_TONE], defaults, sleeping)
while several.status()[1] == 0 and several.step(0.01):
    pass
result["status"] = several.status()
several.cancel()
result["after_cancel"] = several.step(), len(several.shown), several.failures, len(bpy.data.objects)
bpy.ops.preferences.addon_disable(module="stratum_import")
result["disabled"] = not hasattr(bpy.types, "IMPORT_SCENE_OT_stratum_gcode")
result["left"] = [name for name in os.listdir(tempfile.tempdir) if not name.startswith("stratum_vdb_")]
print("RESULT " + json.dumps(result))

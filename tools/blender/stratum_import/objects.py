"""Prints as Blender objects: meshes, volumes, volumes with a mesher; where they stand, when they are seen."""

import bpy
import numpy
from mathutils import Vector

from .conversion import ConversionError
from .ply import read_ply

SOLID = {"MESH", "CURVE", "SURFACE", "META", "FONT", "VOLUME"}
# An object so many times longer than a print is a floor or a room, not its neighbor.
SURROUNDINGS = 10
GAP = 0.1  # of a print's width
MARGIN = 1.1


def link(name, data):
    thing = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(thing)
    return thing


def mesh_object(path, name, scale, materials_of):
    """An object of a PLY file's faces. `materials_of(mesh)` is Palette.of_faces. Raises ValueError."""
    polygons = read_ply(path)
    materials, index = materials_of(polygons)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(polygons.points))
    mesh.vertices.foreach_set("co", (polygons.points * numpy.float32(scale)).ravel())
    mesh.loops.add(len(polygons.corners))
    mesh.loops.foreach_set("vertex_index", polygons.corners.astype(numpy.int32))
    mesh.polygons.add(len(polygons.sizes))
    mesh.polygons.foreach_set("loop_start", polygons.starts())
    if not bpy.types.MeshPolygon.bl_rna.properties["loop_total"].is_readonly:  # Blender 4 finds it itself
        mesh.polygons.foreach_set("loop_total", polygons.sizes)
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(polygons.sizes), bool))
    for material in materials:
        mesh.materials.append(material)
    if index is not None:
        mesh.polygons.foreach_set("material_index", index)
    mesh.update(calc_edges=True)
    return link(name, mesh)


def volume_object(path, name, scale):
    data = bpy.data.volumes.new(name)
    data.filepath = path
    if not data.grids.load():
        raise ConversionError(f"{path}: {data.grids.error_message}")
    volume = link(name, data)
    volume.scale = (scale, scale, scale)
    return volume


def meshed_volume(path, name, scale, voxel, adaptivity, materials):
    """A mesh made by a modifier from a hidden volume, which follows it as its child. Blender takes a value to lie in the
    middle of a voxel, OpenVDB at its lattice point, so the volume stands half a voxel back."""
    volume = volume_object(path, name + " volume", scale)
    mesh = link(name, bpy.data.meshes.new(name))
    for material in materials:
        mesh.data.materials.append(material)
    volume.parent = mesh
    volume.location = (-0.5 * voxel * scale,) * 3
    volume.hide_viewport = volume.hide_render = True
    modifier = mesh.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object = volume
    modifier.grid_name = "surface"
    modifier.resolution_mode = "GRID"
    modifier.threshold = 0.0
    modifier.adaptivity = adaptivity
    modifier.use_smooth_shade = True
    return mesh


def face_count(thing):
    """As shown, after its modifiers; 0 for a volume."""
    if thing.type != "MESH":
        return 0
    return len(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons)


def print_box(report, origin, scale):
    """Low and high corner of a print in scene units, before it is moved."""
    low, high = (Vector(corner) for corner in report["toolpath"]["selected_bbox_mm"])
    if origin != "bed":
        middle = (low + high) / 2
        start = low if origin == "min" else Vector((middle.x, middle.y, low.z))
        low, high = low - start, high - start
    return low * scale, high * scale


def corners_of(thing):
    """Of its box in world space, after its modifiers."""
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [evaluated.matrix_world @ Vector(corner) for corner in evaluated.bound_box]


def solid_boxes():
    """World boxes of the visible solid objects."""
    boxes = []
    for thing in bpy.context.view_layer.objects:
        if thing.type in SOLID and thing.visible_get():
            corners = corners_of(thing)
            boxes.append(tuple(Vector(pick(c[axis] for c in corners) for axis in range(3)) for pick in (min, max)))
    return boxes


def way_clear(low, high, boxes):
    """How far along x, to the left, a box must go so that it meets none of the others; those much larger than it don't
    count. To the left: Blender's default camera looks at the default cube from the right, and sees both."""
    size = (high - low).length
    near = [(a, b) for a, b in boxes if (b - a).length <= SURROUNDINGS * size]
    touch = 1e-4 * size
    way = 0.0

    def meets(a, b):
        moved = (low.x + way, low.y, low.z), (high.x + way, high.y, high.z)
        return all(moved[0][axis] < b[axis] - touch and a[axis] < moved[1][axis] - touch for axis in range(3))

    while True:
        blocking = [a.x for a, b in near if meets(a, b)]
        if not blocking:
            return way
        way = min(blocking) - high.x - GAP * (high.x - low.x)


def aim_camera(scene, things):
    """Moves the scene's camera, which keeps its direction, so that it just sees all of the things."""
    camera = scene.camera
    if not camera:
        return
    corners = [corner for thing in things for corner in corners_of(thing)]
    middle = sum(corners, Vector()) / len(corners)
    coordinates = [value for corner in corners for value in middle + MARGIN * (corner - middle)]
    place, width = camera.camera_fit_coords(bpy.context.evaluated_depsgraph_get(), coordinates)
    matrix = camera.matrix_world.copy()
    matrix.translation = place
    camera.matrix_world = matrix
    if camera.data.type == "ORTHO":
        camera.data.ortho_scale = width
    camera.data.clip_end = max(camera.data.clip_end, 2 * max((corner - place).length for corner in corners))


def show_in_views(window):
    """Zooms the 3D views of a window to what is selected."""
    for area in window.screen.areas if window else ():
        region = next((region for region in area.regions if region.type == "WINDOW"), None)
        if area.type == "VIEW_3D" and region:
            with bpy.context.temp_override(window=window, area=area, region=region):
                bpy.ops.view3d.view_selected()


def show_between(thing, first, last):
    """Keyframes an object so that it is seen in frames first to last; last None is for good."""
    for frame, hidden in ((first - 1, True), (first, False)) + (((last + 1, True),) if last is not None else ()):
        thing.hide_viewport = thing.hide_render = hidden
        thing.keyframe_insert("hide_viewport", frame=frame)
        thing.keyframe_insert("hide_render", frame=frame)


def still_there(things):
    """Those that the user hasn't removed meanwhile, and can select."""
    bpy.context.view_layer.update()
    seen = set(bpy.context.view_layer.objects)
    there = []
    for thing in things:
        try:
            if thing in seen:
                there.append(thing)
        except ReferenceError:
            pass
    return there


def select_only(things):
    for thing in bpy.context.selected_objects:
        thing.select_set(False)
    for thing in things:
        thing.select_set(True)
    if things:
        bpy.context.view_layer.objects.active = things[-1]

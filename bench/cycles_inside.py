"""Runs inside Blender: renders the mesh of a level set with Cycles, as vdbtrace renders the level set itself.

Reads a JSON file named after `--`; see bench/cycles.py, which writes it. World units of the .vdb are Blender's units.
"""

import json
import math
import sys
import time

import bpy
import mathutils
import numpy as np
import pyopenvdb

with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
    job = json.load(file)


def along(values, axis, n):
    """Linear interpolation to a lattice n times as fine."""
    values = np.moveaxis(values, axis, 0)
    fine = np.empty(((len(values) - 1) * n + 1,) + values.shape[1:], values.dtype)
    for k in range(n):
        part = fine[k::n][:len(values) - 1]
        np.multiply(values[:-1], 1 - k / n, out=part)
        part += np.float32(k / n) * values[1:]
    fine[-1] = values[-1]
    return np.moveaxis(fine, 0, axis)


def refined(grid, n):
    """The grid's own trilinear field on a lattice n times as fine: a mesh of it has smaller facets, the same shape."""
    low, high = grid.evalActiveVoxelBoundingBox()
    low = [c - 1 for c in low]
    values = np.empty([h - l + 2 for l, h in zip(low, high)], np.float32)
    grid.copyToArray(values, ijk=low)
    for axis in range(3):
        values = along(values, axis, n)
    fine = pyopenvdb.FloatGrid(grid.background)
    fine.copyFromArray(np.ascontiguousarray(values), ijk=[c * n for c in low], tolerance=0.0)
    fine.transform = pyopenvdb.createLinearTransform(grid.transform.voxelSize()[0] / n)
    fine.transform.translate(grid.transform.indexToWorld((0, 0, 0)))
    return fine


def mesh_of(grid, name):
    """OpenVDB's own mesher on the grid's lattice points: no half voxel is lost, as in Blender's Volume to Mesh."""
    points, quads = grid.convertToQuads()
    # OpenVDB's winding looks inwards to Blender.
    quads = np.ascontiguousarray(quads[:, ::-1])
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(points, dtype=np.float32).ravel())
    mesh.loops.add(quads.size)
    mesh.loops.foreach_set("vertex_index", quads.astype(np.int32).ravel())
    mesh.polygons.add(len(quads))
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(quads), 4, dtype=np.int32))
    mesh.update(calc_edges=True)
    print(f"MESH {len(points)} vertices, {len(quads)} quads", flush=True)
    return mesh


def matt(name, albedo):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*albedo, 1.0)
    diffuse.inputs["Roughness"].default_value = 0.0
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(diffuse.outputs["BSDF"], output.inputs["Surface"])
    return material


def add(mesh, material):
    thing = bpy.data.objects.new(mesh.name, mesh)
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(thing)


scene = bpy.context.scene
for thing in list(scene.objects):
    bpy.data.objects.remove(thing)
grid = pyopenvdb.read(job["vdb"], "surface")
if job["refine"] > 1:
    grid = refined(grid, job["refine"])
add(mesh_of(grid, "print"), matt("plastic", job["albedo"]))
del grid
if job.get("bed"):
    half = 1e5
    bed = bpy.data.meshes.new("bed")
    bed.from_pydata([(x, y, job["bed"]["z"]) for x, y in ((-half, -half), (half, -half), (half, half), (-half, half))],
                    [], [(0, 1, 2, 3)])
    add(bed, matt("paper", job["bed"]["albedo"]))

camera = bpy.data.cameras.new("camera")
camera.sensor_fit = "VERTICAL"
camera.angle = math.radians(job["fov"])
camera.clip_start, camera.clip_end = 1e-3, 1e7
eye, look_at = mathutils.Vector(job["eye"]), mathutils.Vector(job["look_at"])
stand = bpy.data.objects.new("camera", camera)
stand.location = eye
# A camera looks along its -z with +y up; the world's z is up in the picture.
stand.rotation_euler = (look_at - eye).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(stand)
scene.camera = stand

world = bpy.data.worlds.new("world")
scene.world = world
world.use_nodes = True
tree = world.node_tree
texture = tree.nodes.new("ShaderNodeTexEnvironment")
texture.image = bpy.data.images.load(job["env"])
texture.image.colorspace_settings.name = "Linear"
texture.interpolation = "Linear"
tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
world.cycles.sampling_method = "AUTOMATIC"

scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y = job["size"]
scene.render.resolution_percentage = 100
scene.render.use_persistent_data = True
scene.render.threads_mode = "FIXED"
scene.render.threads = job["threads"]
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
cycles = scene.cycles
cycles.device = "CPU"
cycles.use_adaptive_sampling = False
cycles.use_denoising = False
cycles.max_bounces = cycles.diffuse_bounces = job["bounces"] - 1  # Cycles doesn't count the first scattering
cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
cycles.light_sampling_threshold = 0.0
cycles.blur_glossy = 0.0
cycles.pixel_filter_type = "BLACKMAN_HARRIS"
cycles.filter_width = 1.5  # its default; as broad as vdbtrace's window of radius 1.5 pixels

for shot in job["shots"]:
    cycles.samples = shot["spp"]
    cycles.seed = shot["seed"]
    scene.render.filepath = shot["output"]
    begin = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    print("SHOT " + json.dumps({**shot, "seconds": time.perf_counter() - begin}), flush=True)

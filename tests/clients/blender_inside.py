"""Runs inside Blender what docs/blender.md does by hand: imports the .vdb given after `--`, whose voxel size in its own unit
comes next, meshes it at threshold 0, moves it back by half a voxel, and prints what it found before and after."""

import json
import sys

import bpy

path, voxel = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.object.volume_import(filepath=path)
volume = bpy.context.object
volume.data.grids.load()
grids = [[grid.name, grid.data_type] for grid in volume.data.grids]

mesh = bpy.data.objects.new("mesh", bpy.data.meshes.new("mesh"))
bpy.context.collection.objects.link(mesh)
modifier = mesh.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
modifier.object = volume
modifier.grid_name = "surface"
modifier.resolution_mode = "GRID"
modifier.threshold = 0.0
modifier.adaptivity = 0.05
modifier.use_smooth_shade = True


def measure():
    points = [v.co for v in mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices]
    return {"vertices": len(points), "min": [min(p[axis] for p in points) for axis in range(3)],
            "max": [max(p[axis] for p in points) for axis in range(3)]}


found = {"grids": grids, "there": measure()}
volume.location = (-float(voxel) / 2,) * 3
found["moved"] = measure()
print("RESULT " + json.dumps(found))

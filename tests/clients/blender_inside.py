"""Runs inside Blender: imports the .vdb given after `--`, meshes it at threshold 0, prints what it found."""

import json
import sys

import bpy

path = sys.argv[sys.argv.index("--") + 1]
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
evaluated = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
points = [vertex.co for vertex in evaluated.data.vertices]
print(
    "RESULT "
    + json.dumps(
        {
            "grids": grids,
            "vertices": len(points),
            "min": [min(p[axis] for p in points) for axis in range(3)],
            "max": [max(p[axis] for p in points) for axis in range(3)],
        }
    )
)

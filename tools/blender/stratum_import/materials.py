"""A material for each filament, and the faces that have it."""

import re

import bpy
import numpy

UNKNOWN = (204, 64, 13)  # orange, where the file names no color


def tool_colors(report):
    """By T number, sRGB bytes, None where the file names no color."""
    colors = {}
    for tool in report["toolpath"]["tools"]:
        text = tool.get("color") or ""
        known = re.fullmatch(r"#[0-9A-Fa-f]{6}", text)
        colors[tool["tool"]] = tuple(bytes.fromhex(text[1:])) if known else None
    return colors


def linear(color):
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (byte / 255 for byte in color)]


def new_material(name, color):
    """A plastic of an sRGB color."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    # Blender's own first nodes are those of a volume while an object of that kind is active.
    nodes = material.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    output = nodes.new("ShaderNodeOutputMaterial")
    shader.location.x, output.location.x = -300, 0
    material.node_tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    shader.inputs["Base Color"].default_value = (*linear(color), 1)
    shader.inputs["Roughness"].default_value = 0.35
    material.diffuse_color = (*linear(color), 1)
    return material


class Palette:
    """The materials of one print; all meshes of a sequence share them."""

    def __init__(self, name, report):
        self._name = name
        self._tools = tool_colors(report)
        self._made = {}  # by sRGB color, or by tool where there is none

    def of_tools(self):
        """One for each tool that the print uses, in their order."""
        return [self._material(color or UNKNOWN, tool) for tool, color in self._tools.items()]

    def of_faces(self, mesh):
        """The materials of a PolygonMesh, and for each face the index of its own or None if all have the first. A face
        whose corners differ takes the color that two of them have."""
        if mesh.colors is None:
            return self.of_tools(), None
        packed = mesh.colors.astype(numpy.uint32) @ numpy.array([65536, 256, 1], numpy.uint32)
        found, of_point = numpy.unique(packed, return_inverse=True)
        starts = mesh.starts()
        first, second, third = (of_point[mesh.corners[starts + n]] for n in range(3))
        face = numpy.where(second == third, second, first)
        quads = numpy.flatnonzero(mesh.sizes == 4)
        fourth = of_point[mesh.corners[starts[quads] + 3]]
        for one, other in ((second, third), (third, second)):
            pair = (fourth == one[quads]) & (first[quads] != other[quads])
            face[quads[pair]] = fourth[pair]
        colors = [tuple(int(value).to_bytes(3, "big")) for value in found]
        return [self._material(color, self._tool_of(color)) for color in colors], face.astype(numpy.int32)

    def _tool_of(self, color):
        # Colors on the way through a grid are rounded.
        near = (tool for tool, own in self._tools.items() if own and max(abs(a - b) for a, b in zip(own, color)) <= 2)
        return next(near, None)

    def _material(self, color, tool):
        key = color if tool is None else tool
        if key not in self._made:
            label = "#" + bytes(color).hex() if tool is None else f"tool {tool + 1}"
            self._made[key] = new_material(f"{self._name} {label}", color)
        return self._made[key]

"""What the import offers, and the command line that follows from it."""

import json
import math
import os

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

ENDINGS = (".gz", ".gcode", ".gco", ".g", ".bgcode", ".3mf", ".ufp", ".gx")
MOST_VOXELS_PER_LAYER = 4
# One voxel a layer tells little of how many faces finer ones have.
TRIAL_VOXELS_PER_LAYER = 2
PER_MM = {"MM": 1.0, "CM": 0.1, "M": 0.001}


def print_name(path):
    """part.v2.gcode.gz -> part.v2"""
    name = os.path.basename(path)
    while True:
        stem, ending = os.path.splitext(name)
        if not stem or ending.lower() not in ENDINGS:
            return name
        name = stem


class ImportSettings:
    """A mixin for the operator."""

    kind: EnumProperty(name="As", default="MESH", items=(
        ("MESH", "Mesh", "A mesh in the .blend file; each filament's faces have a material of their own"),
        ("MODIFIER", "Volume to Mesh", "A mesh made by a modifier from a .vdb file: coarser and finer by its settings"),
        ("VOLUME", "Volume", "The level set in a .vdb file, with the grids asked for")))
    unit: EnumProperty(name="Unit", default="CM", items=(
        ("MM", "Millimeters", "1 unit is 1 mm"),
        ("CM", "Centimeters", "1 unit is 1 cm: of a size with Blender's default camera, lamp and clipping"),
        ("M", "Meters", "1 unit is 1 m"),
        ("SCENE", "Scene's", "True to size in the scene's unit scale")))
    origin: EnumProperty(name="Origin", default="center", items=(
        ("center", "Center", "The print stands in the middle, on the ground"),
        ("min", "Corner", "The corner of its box lies in the origin"),
        ("bed", "Bed", "Where the G-code prints it")))
    beside: BoolProperty(name="Beside others", default=True,
                         description="Moves a print to the left until it stands clear of what is there; not with origin Bed")
    aim: BoolProperty(name="Aim the camera", default=False,
                      description="The scene's camera keeps its direction and sees all of the print")
    adaptivity: FloatProperty(name="Adaptivity", description="Of Volume to Mesh: 0 keeps all faces, 0.5 merges many",
                              min=0, max=0.5, default=0.05)
    faces: IntProperty(name="Faces", description="About so many at most: 1 to 4 voxels a layer are made, as many as that allows",
                       min=1000, default=1000000)
    voxel_size: FloatProperty(name="Voxel size", description="mm; 0 follows from the faces", min=0, max=5, default=0)
    memory_budget: StringProperty(name="Memory budget", description="Finest voxel that fits, e.g. 4GB; instead of a size")
    layers: StringProperty(name="Layers", description="A:B, counted from 1")
    features: StringProperty(name="Features", description="+NAME,... only these; -NAME,... all but these")
    objects: StringProperty(name="Objects", description="Names or numbers, separated by commas")
    plate: IntProperty(name="Plate", description="Of a .gcode.3mf that has several; 0 is its only one", min=0, default=0)
    interior: EnumProperty(name="Interior", default="cull", items=(
        ("cull", "Outside only", "Leaves out what no outside point can reach"),
        ("keep", "All", "All inner surfaces")))
    grids: StringProperty(name="Attribute grids", description="Of volumes: layer,time,feature,tool,object,width,speed,color")
    snapshots: IntProperty(name="Print progress", description="Steps of a keyframed sequence; 1 is the whole print",
                           min=1, max=100, default=1)
    frames: IntProperty(name="Frames a step", min=1, max=1000, default=10)

    def scale(self, scene):
        """Scene units a millimeter."""
        return PER_MM.get(self.unit) or 0.001 / scene.unit_settings.scale_length

    def follows_faces(self):
        """True if only a trial tells how fine the voxels may be."""
        return self.kind != "VOLUME" and self.voxel_size == 0 and not self.memory_budget

    def trial_options(self):
        """For a coarse mesh of the whole print; the coarsest, where its faces are not asked for."""
        voxels = TRIAL_VOXELS_PER_LAYER if self.follows_faces() else 1
        return ["--voxels-per-layer", str(voxels), *self._selection_options()]

    def wants_trial(self):
        """A mesh asks also for how many colors there are."""
        return self.kind == "MESH" or self.follows_faces()

    def command_options(self, trial_faces=0, colored=False):
        """`trial_faces` are those of trial_options(), if wants_trial(). A `colored` mesh has colors."""
        options = [*self._selection_options(), "--origin", self.origin]
        if self.kind != "MESH" and self.grids:
            options.append(f"--grids={self.grids}")
        elif colored:
            options.append("--grids=color")
        if self.voxel_size > 0:
            options += ["--voxel-size", f"{self.voxel_size:.6g}"]
        elif self.memory_budget:
            options += ["--memory-budget", self.memory_budget]
        elif self.follows_faces():
            # Those of curved surfaces grow by the square of the voxels a layer; flat ones need fewer.
            most = int(TRIAL_VOXELS_PER_LAYER * math.sqrt(self.faces / max(trial_faces, 1)))
            options += ["--voxels-per-layer", str(min(max(most, 1), MOST_VOXELS_PER_LAYER))]
        if self.snapshots > 1:
            steps = (f"{100 * n / self.snapshots:.4g}%" for n in range(1, self.snapshots))
            options += ["--snapshots", ",".join(steps)]
        return options

    def _selection_options(self):
        options = ["--interior", self.interior]
        for name in ("layers", "features"):
            if getattr(self, name):
                options.append(f"--{name}={getattr(self, name)}")
        for name in filter(None, (part.strip() for part in self.objects.split(","))):
            options.append(f"--object={name}")
        if self.plate:
            options += ["--plate", str(self.plate)]
        return options

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for title, names in (
                ("Result", ("kind", "unit", "origin", "beside", "aim")),
                ("Detail", ("faces", "voxel_size", "memory_budget", "adaptivity", "interior")),
                ("What", ("layers", "features", "objects", "plate", "grids")),
                ("Sequence", ("snapshots", "frames"))):
            box = layout.box()
            box.label(text=title)
            column = box.column()
            for name in names:
                row = column.row()
                row.enabled = {"faces": self.follows_faces(), "beside": self.origin != "bed", "adaptivity": self.kind == "MODIFIER",
                               "grids": self.kind != "MESH", "frames": self.snapshots > 1}.get(name, True)
                row.prop(self, name)


REMEMBERED = tuple(name for name in ImportSettings.__annotations__ if name not in ("layers", "objects", "plate"))


def remember(settings, preferences):
    """Keeps the settings for the next import, of this session or, as preferences are, of a later one."""
    preferences.last_settings = json.dumps({name: getattr(settings, name) for name in REMEMBERED})
    bpy.context.preferences.is_dirty = True


def recall(settings, preferences):
    """Sets what the last import had, except what the caller has set."""
    try:
        last = json.loads(preferences.last_settings or "{}")
    except ValueError:
        return
    for name in REMEMBERED:
        if name in last and not settings.properties.is_property_set(name):
            try:
                setattr(settings, name, last[name])
            except TypeError:  # of another version
                pass

"""File > Import > G-code as printed: runs gcode2vdb and brings the level set, a mesh of it and its materials into Blender.

Needs Blender 3.4 or newer and gcode2vdb on PATH, in $STRATUM_BIN, or named in the add-on's preferences."""

import json
import os
import pty
import re
import shutil
import subprocess
import tempfile

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

bl_info = {
    "name": "Stratum: G-code as printed",
    "author": "The Stratum developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > G-code as printed",
    "description": "Level sets of sliced prints, every bead and layer line",
    "category": "Import-Export",
}


class ConversionError(Exception):
    """What went wrong, in words for the user."""


def find_converter():
    """The path of gcode2vdb. Raises ConversionError."""
    addon = bpy.context.preferences.addons.get(__name__)
    named = bpy.path.abspath(addon.preferences.converter) if addon and addon.preferences.converter else ""
    if named:
        if os.access(named, os.X_OK):
            return named
        raise ConversionError(f"{named} is not a program; set gcode2vdb in the add-on's preferences")
    beside = os.path.join(os.environ.get("STRATUM_BIN", ""), "gcode2vdb")
    found = beside if os.access(beside, os.X_OK) else shutil.which("gcode2vdb")
    if not found:
        raise ConversionError("gcode2vdb was not found; install Stratum, or name it in the add-on's preferences")
    return found


class Conversion:
    """gcode2vdb at work: its progress, its report, its end."""

    def __init__(self, source, options):
        self.folder = tempfile.mkdtemp(prefix="stratum_")
        self.vdb = os.path.join(self.folder, os.path.basename(source).split(".")[0] + ".vdb")
        self.stats = os.path.join(self.folder, "report.json")
        self.progress = 0.0
        self.messages = ""
        # gcode2vdb shows its progress on terminals only, so it gets one.
        self.terminal, theirs = pty.openpty()
        os.set_blocking(self.terminal, False)
        command = [find_converter(), source, "-o", self.vdb, "--stats", self.stats, *options]
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=theirs)
        except OSError as error:
            shutil.rmtree(self.folder, ignore_errors=True)
            raise ConversionError(f"gcode2vdb can't be started: {error}") from error
        finally:
            os.close(theirs)

    def _read(self):
        while True:
            try:
                part = os.read(self.terminal, 65536)
            except OSError:  # nothing there yet, or the other end is closed
                return
            if not part:
                return
            self.messages += part.decode(errors="replace")

    def poll(self):
        """True while it runs."""
        running = self.process.poll() is None
        self._read()
        percents = re.findall(r"(\d+) %", self.messages)
        if percents:
            self.progress = int(percents[-1]) / 100
        return running

    def cancel(self):
        """Ends the process, which removes what it was writing, and forgets the rest."""
        self.process.terminate()
        self.process.wait()
        self._close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def result(self):
        """The report of a process that has ended. Raises ConversionError with its message."""
        self._read()
        self._close()
        if self.process.returncode != 0:
            shutil.rmtree(self.folder, ignore_errors=True)
            lines = re.sub(r"\r|\x1b\[K", "\n", self.messages).strip().splitlines()
            said = lines[-1] if lines else f"gcode2vdb ended with {self.process.returncode}"
            raise ConversionError(said)
        with open(self.stats, encoding="utf-8") as file:
            return json.load(file)

    def _close(self):
        os.close(self.terminal)


def materials_of(report):
    """A material for each tool, in the filament's colour if the file tells it."""
    made = []
    for tool in report["toolpath"]["tools"]:
        color = tool.get("color", "")
        material = bpy.data.materials.new(f"Tool {tool['tool'] + 1}")
        material.use_nodes = True
        srgb = [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] if re.fullmatch(r"#[0-9A-Fa-f]{6}", color) else [0.8, 0.25, 0.05]
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]
        shader = material.node_tree.nodes["Principled BSDF"]
        shader.inputs["Base Color"].default_value = (*linear, 1)
        shader.inputs["Roughness"].default_value = 0.35
        material.diffuse_color = (*linear, 1)
        made.append(material)
    return made


def load_volume(path, name, scale):
    data = bpy.data.volumes.new(name)
    data.filepath = path
    data.grids.load()
    if data.grids.error_message:
        raise ConversionError(f"{path}: {data.grids.error_message}")
    volume = bpy.data.objects.new(name, data)
    volume.scale = (scale, scale, scale)
    bpy.context.collection.objects.link(volume)
    return volume


def mesh_of(volume, voxel, scale, materials):
    """An object that meshes the volume. Blender takes a value to lie in the middle of a voxel, OpenVDB at its lattice
    point: its mesh is half a voxel off. So the modifier looks at a twin of the volume that is half a voxel back."""
    twin = bpy.data.objects.new(volume.name + " (for the mesh)", volume.data)
    twin.scale = volume.scale
    twin.location = (-0.5 * voxel * scale,) * 3
    bpy.context.collection.objects.link(twin)
    twin.hide_viewport = twin.hide_render = True
    mesh = bpy.data.objects.new(volume.name + " mesh", bpy.data.meshes.new(volume.name))
    for material in materials:
        mesh.data.materials.append(material)
    bpy.context.collection.objects.link(mesh)
    modifier = mesh.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object = twin
    modifier.grid_name = "surface"
    modifier.resolution_mode = "GRID"
    modifier.threshold = 0.0
    modifier.use_smooth_shade = True
    # Every face has the first slot; the other tools' materials stand ready in theirs.
    return mesh


def show_between(thing, first, last):
    """Keyframes an object so that it is seen in frames first to last; last None is for good."""
    for frame, hidden in ((first - 1, True), (first, False)) + (((last + 1, True),) if last is not None else ()):
        thing.hide_viewport = thing.hide_render = hidden
        thing.keyframe_insert("hide_viewport", frame=frame)
        thing.keyframe_insert("hide_render", frame=frame)


class ImportSettings:
    """What the operator offers."""

    voxel_size: FloatProperty(name="Voxel size", description="mm; 0 follows from the layer height", min=0, max=5, default=0)
    memory_budget: StringProperty(name="Memory budget", description="Finest voxel that fits, e.g. 4GB; instead of a size")
    layers: StringProperty(name="Layers", description="A:B, counted from 1")
    features: StringProperty(name="Features", description="+NAME,... only these; -NAME,... all but these", default="")
    objects: StringProperty(name="Objects", description="Names or numbers, separated by commas")
    grids: StringProperty(name="Attribute grids", description="layer,time,feature,tool,object,width,speed,color")
    interior: EnumProperty(name="Interior", default="cull", items=(
        ("cull", "Outside only", "Leaves out what no outside point can reach"),
        ("keep", "All", "All inner surfaces")))
    scale: FloatProperty(name="Scale", description="Scene units a millimetre", min=1e-6, max=1000, default=0.001, precision=4)
    snapshots: IntProperty(name="Print progress", description="Steps of a keyframed sequence; 1 is the whole print", min=1, max=100, default=1)
    frames: IntProperty(name="Frames a step", min=1, max=1000, default=10)
    as_mesh: BoolProperty(name="Mesh", description="Add a Volume to Mesh modifier", default=True)

    def command_options(self):
        options = ["--interior", self.interior]
        if self.voxel_size > 0:
            options += ["--voxel-size", f"{self.voxel_size:.6g}"]
        elif self.memory_budget:
            options += ["--memory-budget", self.memory_budget]
        for name in ("layers", "features", "grids"):
            if getattr(self, name):
                options.append(f"--{name}={getattr(self, name)}")
        for name in filter(None, (part.strip() for part in self.objects.split(","))):
            options += ["--object", name]
        if self.snapshots > 1:
            steps = (f"{100 * n / self.snapshots:.4g}%" for n in range(1, self.snapshots))
            options += ["--snapshots", ",".join(steps)]
        return options

    def load(self, conversion):
        report = conversion.result()
        materials = materials_of(report)
        voxel = report["grid"]["voxel_size_mm"]
        files = report["files"]
        for number, file in enumerate(files):
            volume = load_volume(file["path"], os.path.basename(file["path"])[:-4], self.scale)
            things = [volume]
            if self.as_mesh:
                things.append(mesh_of(volume, voxel, self.scale, materials))
                volume.hide_viewport = volume.hide_render = True
            if len(files) > 1:
                first = 1 + number * self.frames
                show_between(things[-1], first, None if number + 1 == len(files) else first + self.frames - 1)
        if len(files) > 1:
            bpy.context.scene.frame_start, bpy.context.scene.frame_end = 1, len(files) * self.frames
            bpy.context.scene.frame_set(len(files) * self.frames)
        return report


class IMPORT_OT_stratum_gcode(bpy.types.Operator, ImportHelper, ImportSettings):
    """Import sliced G-code as the part it prints"""

    bl_idname = "import_scene.stratum_gcode"
    bl_label = "Import G-code as printed"
    bl_options = {"REGISTER", "UNDO"}
    filter_glob: StringProperty(default="*.gcode;*.gco;*.g;*.gz;*.bgcode;*.3mf;*.ufp;*.gx", options={"HIDDEN"})

    _conversion = None
    _timer = None

    def execute(self, context):
        try:
            self._conversion = Conversion(self.filepath, self.command_options())
        except ConversionError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if bpy.app.background:
            self._conversion.process.wait()
            return self._finish(context)
        context.window_manager.progress_begin(0, 100)
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self._conversion.cancel()
            self._stop(context)
            self.report({"INFO"}, "Import cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._conversion.poll():
            context.window_manager.progress_update(100 * self._conversion.progress)
            context.workspace.status_text_set(f"gcode2vdb: {100 * self._conversion.progress:.0f} %   (Esc cancels)")
            return {"RUNNING_MODAL"}
        self._stop(context)
        return self._finish(context)

    def _stop(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _finish(self, context):
        try:
            self.load(self._conversion)
        except ConversionError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class StratumPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    converter: StringProperty(name="gcode2vdb", subtype="FILE_PATH", description="Empty: looked for on PATH")

    def draw(self, context):
        self.layout.prop(self, "converter")


def menu(self, context):
    self.layout.operator(IMPORT_OT_stratum_gcode.bl_idname, text="G-code as printed")


def register():
    bpy.utils.register_class(StratumPreferences)
    bpy.utils.register_class(IMPORT_OT_stratum_gcode)
    bpy.types.TOPBAR_MT_file_import.append(menu)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    bpy.utils.unregister_class(IMPORT_OT_stratum_gcode)
    bpy.utils.unregister_class(StratumPreferences)


if __name__ == "__main__":
    register()

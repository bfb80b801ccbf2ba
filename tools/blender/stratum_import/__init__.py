"""File > Import > G-code as printed: runs gcode2vdb and brings the part that it makes into Blender.

Needs Blender 3.4 or newer and gcode2vdb on PATH, in $STRATUM_BIN, or named in the add-on's preferences."""

import os

import bpy
from bpy.props import CollectionProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .conversion import ConversionError, find_converter
from .objects import aim_camera, select_only, show_in_views, still_there
from .session import Session
from .settings import ENDINGS, ImportSettings, recall, remember

# Blender before 4.2 reads this, later ones blender_manifest.toml.
bl_info = {
    "name": "Stratum: G-code as printed",
    "author": "The Stratum developers",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > G-code as printed",
    "description": "Sliced prints as they come out, every bead and layer line",
    "category": "Import-Export",
}


class StratumPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__
    converter: StringProperty(name="gcode2vdb", subtype="FILE_PATH", description="Empty: looked for on PATH")
    last_settings: StringProperty(options={"HIDDEN"})

    def draw(self, context):
        self.layout.prop(self, "converter")


def preferences():
    return bpy.context.preferences.addons[__package__].preferences


class IMPORT_OT_stratum_gcode(bpy.types.Operator, ImportHelper, ImportSettings):
    """Import sliced G-code as the part it prints"""

    bl_idname = "import_scene.stratum_gcode"
    bl_label = "Import G-code as printed"
    bl_options = {"UNDO", "PRESET"}
    filter_glob: StringProperty(default=";".join("*" + ending for ending in ENDINGS), options={"HIDDEN"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})

    _session = None
    _timer = None
    _interactive = False

    def invoke(self, context, event):
        recall(self, preferences())
        self._interactive = True
        return ImportHelper.invoke(self, context, event)

    def paths(self):
        several = [os.path.join(self.directory, file.name) for file in self.files if file.name]
        return [os.path.abspath(bpy.path.abspath(path)) for path in several or [self.filepath]]

    def execute(self, context):
        try:
            converter = find_converter(bpy.path.abspath(preferences().converter))
        except ConversionError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        self._session = Session(self.paths(), self, converter)
        if self._interactive and context.window:
            context.window_manager.progress_begin(0, 100)
            self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
            context.window_manager.modal_handler_add(self)
            return {"RUNNING_MODAL"}
        said = ""
        while self._session.step(seconds=0.5):
            what, share = self._session.status()
            line = f"{what} {10 * int(10 * share)} %"
            if what and line != said:
                print(line, flush=True)
                said = line
        return self._finish()

    def modal(self, context, event):
        if event.type == "ESC":
            self.cancel(context)
            self.report({"INFO"}, "Import cancelled")
            return self._finish() if self._session.shown else {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._session.step():
            what, share = self._session.status()
            context.window_manager.progress_update(100 * share)
            context.workspace.status_text_set(f"{what} {100 * share:.0f} %   (Esc cancels)")
            return {"RUNNING_MODAL"}
        self._stop(context)
        return self._finish()

    def cancel(self, context):
        """Blender calls this too, when it quits or opens another file."""
        if self._session:
            self._session.cancel()
        if self._timer:
            self._stop(context)

    def _stop(self, context):
        context.window_manager.event_timer_remove(self._timer)
        self._timer = None
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def _finish(self):
        session = self._session
        things = still_there(session.shown)
        if things:
            select_only(things)
            if self.aim:
                aim_camera(bpy.context.scene, things)
            if self._interactive:
                show_in_views(bpy.context.window)
        if session.shown:
            remember(self, preferences())
        for kind, lines in (("INFO", session.lines), ("WARNING", session.warnings), ("ERROR", session.failures)):
            for line in lines:
                self.report({kind}, line)
        return {"FINISHED"} if session.shown else {"CANCELLED"}


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

"""One import from first file to last: conversions one after the other, each brought into the scene when it has ended."""

import os
import shutil
import tempfile
import time

import bpy

from . import objects
from .conversion import Conversion, ConversionError
from .materials import Palette, tool_colors
from .settings import print_name


FAILURES = (ConversionError, OSError, ValueError)


class Session:
    """Call step() until it is False, or cancel(). `failures` and `lines` say what came of the files."""

    def __init__(self, paths, settings, converter):
        self._waiting = list(paths)
        self._settings = settings
        self._converter = converter
        self._conversion = None
        self._path = ""
        self._trying = False  # a coarse level set first, which tells how fine the voxels may be, and the colors
        self._colored = False
        self._start = 0.0
        self.shown = []  # one object a print, the last of a sequence
        self.lines = []
        self.warnings = []
        self.failures = []

    def step(self, seconds=0.0):
        """Starts, goes on waiting for so long, or takes in what has ended. False: all is done."""
        if not self._conversion:
            if not self._waiting:
                return False
            self._begin(self._waiting.pop(0))
        elif self._conversion.running():
            self._conversion.wait(seconds)
        else:
            self._end()
        return True

    def status(self):
        """What is being done, and how much of it."""
        if not self._conversion:
            return "", 0.0
        stage = "measuring" if self._trying else self._conversion.stage or "starting"
        return f"{os.path.basename(self._path)}: {stage}", self._conversion.progress

    def cancel(self):
        """Ends what runs. What had come into the scene before stays."""
        self._waiting.clear()
        if self._conversion:
            self._conversion.cancel()
            self._conversion = None

    def _begin(self, path):
        self._path, self._start = path, time.perf_counter()
        self._trying, self._colored = self._settings.wants_trial(), False
        self._convert(self._settings.trial_options() if self._trying else self._settings.command_options())

    def _convert(self, options):
        ending = ".ply" if self._settings.kind == "MESH" or self._trying else ".vdb"
        try:
            self._conversion = Conversion(self._converter, self._path, print_name(self._path) + ending, options)
        except ConversionError as error:
            self.failures.append(str(error))

    def _end(self):
        conversion, self._conversion = self._conversion, None
        try:
            report = conversion.result()
            if self._trying:
                self._trying = False
                self._colored = self._settings.kind == "MESH" and len(set(tool_colors(report).values())) > 1
                faces = report["files"][0]["mesh"]["triangles"]
                self._convert(self._settings.command_options(faces, self._colored))
            else:
                self._take(report)
        except FAILURES as error:
            self.failures.append(str(error))
        finally:
            conversion.close()

    def _take(self, report):
        name, scale = print_name(self._path), self._settings.scale(bpy.context.scene)
        low, high = objects.print_box(report, self._settings.origin, scale)
        clear = self._settings.beside and self._settings.origin != "bed"
        way = objects.way_clear(low, high, objects.solid_boxes()) if clear else 0.0
        before = set(bpy.data.objects)
        try:
            things = self._make(name, scale, report)
        except FAILURES:
            for thing in set(bpy.data.objects) - before:
                bpy.data.objects.remove(thing)
            raise
        for thing in things:
            thing.location.x += way
        self._animate(things)
        self.shown.append(things[-1])
        # Boxes of what comes after must see this one.
        bpy.context.view_layer.update()
        size = " x ".join(f"{length:.1f}" for length in (high - low) / scale)
        faces = objects.face_count(things[-1])
        self.lines.append(f"{name}: {f'{faces:,} faces, ' if faces else ''}{size} mm, voxels of "
                          f"{report['grid']['voxel_size_mm']:.3g} mm, {time.perf_counter() - self._start:.1f} s")
        self.warnings += [f"{os.path.basename(self._path)}:{w['first_line']}: {w['text']}" for w in report["toolpath"]["warnings"]]

    def _make(self, name, scale, report):
        voxel = report["grid"]["voxel_size_mm"]
        palette = Palette(name, report)
        things = []
        for file in report["files"]:
            label = f"{name} {file['snapshot']}".strip()
            if self._settings.kind == "MESH":
                things.append(objects.mesh_object(file["path"], label, scale, palette.of_faces))
            elif self._settings.kind == "MODIFIER":
                things.append(objects.meshed_volume(keep(file["path"]), label, scale, voxel, self._settings.adaptivity,
                                                    palette.of_tools()))
            else:
                things.append(objects.volume_object(keep(file["path"]), label, scale))
        return things

    def _animate(self, things):
        if len(things) < 2:
            return
        frames = self._settings.frames
        for number, thing in enumerate(things):
            first = 1 + number * frames
            objects.show_between(thing, first, None if number + 1 == len(things) else first + frames - 1)
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end = 1, max(scene.frame_end if self.shown else 1, len(things) * frames)
        scene.frame_set(scene.frame_end)


def keep(path):
    """Moves a .vdb that the scene needs to beside the .blend file, or to a folder of its own as long as there is none."""
    folder = bpy.path.abspath("//") or tempfile.mkdtemp(prefix="stratum_vdb_")
    stem, ending = os.path.splitext(os.path.basename(path))
    target, number = os.path.join(folder, stem + ending), 1
    while os.path.exists(target):
        target, number = os.path.join(folder, f"{stem}.{number:03}{ending}"), number + 1
    try:
        shutil.move(path, target)
    except OSError as error:
        raise ConversionError(f"{target}: {error.strerror}") from error
    return bpy.path.relpath(target) if bpy.data.filepath else target

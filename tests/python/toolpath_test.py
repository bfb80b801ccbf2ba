"""stratum.Toolpath: what it reads, views without a copy, and toolpaths of arrays."""

import copy
import gc
import gzip
import os
import pathlib
import pickle
import sys
import tempfile
import threading
import time
import unittest
import zlib

import numpy as np

import stratum
from common import gcode, path_of, read_bytes, tool


def box_of_beads(count, layers=1):
    """Lines of 1 mm side by side."""
    beads = np.zeros(count, stratum.bead_dtype)
    index = np.arange(count)
    beads["x0"] = index % 1000 * 0.4
    beads["x1"] = beads["x0"]
    beads["y0"] = index // 1000 % 1000
    beads["y1"] = beads["y0"] + 1
    beads["run"] = index % layers
    beads["z0"] = beads["z1"] = 0.2 * (1 + beads["run"])
    beads["width"] = 0.4
    beads["arc"] = -1
    runs = np.zeros(layers, stratum.run_dtype)
    runs["height"] = 0.2
    runs["speed"] = 50
    runs["layer"] = np.arange(layers) + 1
    return beads, runs


class Reading(unittest.TestCase):
    def test_same_as_the_tool(self):
        path = gcode("hull.gcode")
        toolpath = stratum.read(path)
        lines = tool("gcode2vdb", path, "--dump-toolpath", "-", "--voxel-size", "0.4", "-o", path_of("hull.vdb"), "--quiet").splitlines()
        names = lines[0].split(",")
        rows = np.genfromtxt(lines[1:], delimiter=",", usecols=[names.index(n) for n in names if n[-1] in "01"])
        columns = [n for n in names if n[-1] in "01"]
        self.assertEqual(len(rows), len(toolpath))
        for name in ("x0", "y0", "x1", "y1"):
            if name in columns:
                np.testing.assert_allclose(toolpath.beads[name], rows[:, columns.index(name)], atol=1e-3)

    def test_from_path_bytes_and_container(self):
        path = gcode("tile.gcode")
        program = read_bytes(path)
        beads = stratum.read(path).beads
        for source in (pathlib.Path(path), program, bytearray(program), gzip.compress(program)):
            self.assertTrue(np.array_equal(stratum.read(source).beads, beads))
        self.assertEqual(stratum.read(gzip.compress(program)).format, "gzip")

    def test_options(self):
        path = gcode("tile.gcode")
        thick = stratum.read(path, filament_diameter=2.85)
        self.assertGreater(thick.beads["width"].mean(), stratum.read(path).beads["width"].mean())
        lagging = stratum.read(path, flow_lag=0.05, printer="ideal")
        self.assertEqual(len(lagging.flow), len(lagging))
        self.assertEqual(stratum.read(path).flow, None)

    def test_flow(self):
        path = gcode("tile.gcode")
        plain = stratum.read(path)
        self.assertAlmostEqual(stratum.read(path, flow=90).extruded_mm3 / plain.extruded_mm3, 0.9, places=6)
        for bad in (0, 1001):
            with self.assertRaisesRegex(stratum.UsageError, "flow=.*from 1 to 1000"):
                stratum.read(path, flow=bad)

    def test_facts(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        self.assertIn("PrusaSlicer", toolpath.slicer)
        self.assertEqual(toolpath.layer_count, toolpath.bead_layers().max())
        self.assertEqual(set(toolpath.stated), {"seconds", "model_seconds", "grams", "cost", "materials", "nozzle_diameters",
                                                "printer", "layer_height", "first_layer_height"})
        self.assertGreater(toolpath.stated["seconds"], 60)
        self.assertIn("PrusaSlicer", toolpath.summary())
        self.assertIn(f"{len(toolpath)} beads", repr(toolpath))
        self.assertAlmostEqual(toolpath.bead_volumes().sum() / toolpath.extruded_mm3, 1, delta=0.02)

    def test_helpers(self):
        toolpath = stratum.read(gcode("two_tone.gcode"))
        runs, of = toolpath.runs, toolpath.beads["run"]
        np.testing.assert_array_equal(toolpath.bead_layers(), runs["layer"][of])
        np.testing.assert_array_equal(toolpath.bead_tools(), runs["tool"][of])
        np.testing.assert_array_equal(toolpath.bead_objects(), runs["object"][of])
        np.testing.assert_array_equal(toolpath.bead_features(), runs["feature"][of])
        self.assertEqual(set(np.unique(toolpath.bead_tools())), {0, 1})
        straight = toolpath.beads["arc"] < 0
        np.testing.assert_array_equal(toolpath.bead_lines()[straight], -toolpath.beads["arc"][straight])
        beads = toolpath.beads
        length = np.sqrt(sum((beads[a + "1"] - beads[a + "0"]) ** 2 for a in "xyz"))
        np.testing.assert_allclose(toolpath.bead_lengths()[straight], length[straight])

    def test_selection(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        chosen = toolpath.select(layers="2:3", features="+external-perimeter")
        expected = np.isin(toolpath.bead_layers(), (2, 3)) & (
            toolpath.bead_features() == stratum.features.index("external-perimeter"))
        np.testing.assert_array_equal(chosen, np.flatnonzero(expected))
        with self.assertRaisesRegex(stratum.UsageError, "external-perimeter"):
            toolpath.select(features="+outer")

    def test_times(self):
        toolpath = stratum.read(gcode("tile.gcode"), timed=True)
        timing = toolpath.timing
        self.assertEqual(timing.dtype, stratum.timing_dtype)
        self.assertEqual(len(timing), len(toolpath))
        self.assertTrue((np.diff(timing["start"]) >= 0).all())
        self.assertAlmostEqual(timing["seconds"].sum(), sum(toolpath.times["features"].values()), delta=0.1)
        self.assertGreaterEqual(toolpath.times["total"], timing["start"][-1])
        self.assertIsNone(stratum.read(gcode("tile.gcode")).timing)
        self.assertIsNone(stratum.read(gcode("tile.gcode")).times)


    def test_travels(self):
        path = gcode("tile.gcode")
        self.assertIsNone(stratum.read(path).travels)
        toolpath = stratum.read(path, travels=True)
        travels = toolpath.travels
        self.assertEqual(travels.dtype, stratum.travel_dtype)
        self.assertFalse(travels.flags.writeable)
        self.assertGreater(len(travels), 20)
        self.assertTrue((np.diff(travels["line"].astype(int)) >= 0).all())
        self.assertTrue((np.diff(travels["bead"].astype(int)) >= 0).all())
        self.assertTrue((travels["start"] == 0).all())
        # Where travels end, the next bead begins, unless another travel comes before it.
        last = np.append(np.diff(travels["bead"].astype(int)) > 0, True) & (travels["bead"] < len(toolpath))
        for axis in "xyz":
            np.testing.assert_allclose(travels[axis + "1"][last], toolpath.beads[axis + "0"][travels["bead"][last]], atol=1e-9)
        timed = stratum.read(path, travels=True, timed=True)
        self.assertTrue((np.diff(timed.travels["start"]) >= 0).all())
        self.assertAlmostEqual(timed.travels["seconds"].sum(), timed.times["travel"], places=2)
        for name in stratum.travel_dtype.names:
            if name not in ("start", "seconds"):
                np.testing.assert_array_equal(timed.travels[name], travels[name])
        self.assertIsNone(timed.replace(beads=timed.beads).travels)
        for options in ({"sag": 0.1}, {"flow_lag": 0.05}, {"belt": 45}):
            with self.assertRaisesRegex(stratum.UsageError, "travels are not told"):
                stratum.read(path, travels=True, **options)

    def test_travels_on_arcs(self):
        program = b"M83\nG1 X10 Y10 Z0.2 F6000\nG1 X20 E1 F1200\nG2 X30 Y10 I5 J0 F6000\nG1 X40 E1 E-1\nG1 X30 E-0.5\nG1 X20 E1\n"
        travels = stratum.read(program, travels=True, timed=True).travels
        arc = travels[travels["sweep"] != 0]
        self.assertEqual(len(arc), 1)
        self.assertAlmostEqual(arc["sweep"][0], -np.pi, places=5)
        self.assertEqual((arc["center_x"][0], arc["center_y"][0], arc["bead"][0], arc["line"][0]), (25, 10, 1, 4))
        self.assertGreater(arc["seconds"][0], 5 * np.pi / 100)
        self.assertEqual(travels["filament"][travels["line"] == 6], -0.5)


class Views(unittest.TestCase):
    def test_layout(self):
        self.assertEqual(stratum.bead_dtype.itemsize, 60)
        self.assertEqual(stratum.bead_dtype.names, ("x0", "y0", "z0", "x1", "y1", "z1", "width", "run", "arc"))
        self.assertEqual(stratum.run_dtype.itemsize, 16)

    def test_no_copy_and_read_only(self):
        toolpath = stratum.read(gcode("tile.gcode"), timed=True)
        for name in ("beads", "runs", "arcs", "timing"):
            one, other = getattr(toolpath, name), getattr(toolpath, name)
            if len(one):
                self.assertEqual(one.ctypes.data, other.ctypes.data)
                self.assertTrue(np.shares_memory(one, other))
            self.assertFalse(one.flags.writeable)
            with self.assertRaises(ValueError):
                one.flags.writeable = True
        with self.assertRaises(ValueError):
            toolpath.beads["x0"][0] = 1

    def test_view_keeps_its_owner(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        beads = toolpath.beads
        copy = beads.copy()
        runs = toolpath.runs
        self.assertGreater(sys.getrefcount(toolpath), 2)
        del toolpath
        gc.collect()
        trash = [np.full(1000, 7, stratum.bead_dtype) for _ in range(100)]
        self.assertTrue(np.array_equal(beads, copy))
        self.assertGreater(runs["height"].min(), 0)
        del trash

    def test_a_million_beads(self):
        beads, runs = box_of_beads(1_000_000)
        toolpath = stratum.make_toolpath(beads, runs)
        seconds = []
        for _ in range(20):
            start = time.perf_counter()
            view = toolpath.beads
            seconds.append(time.perf_counter() - start)
        self.assertEqual(len(view), 1_000_000)
        self.assertTrue(np.shares_memory(view, toolpath.beads))
        start = time.perf_counter()
        view.copy()
        copying = time.perf_counter() - start
        # A copy of 60 MB takes milliseconds.
        self.assertLess(min(seconds), 0.05 * copying)
        print(f"10^6 beads: a view takes {min(seconds) * 1e6:.0f} us, a copy {copying * 1e3:.0f} ms")


class Arrays(unittest.TestCase):
    def test_the_same_again(self):
        toolpath = stratum.read(gcode("tile_arcs.gcode"))
        again = stratum.make_toolpath(toolpath.beads, toolpath.runs, toolpath.arcs, toolpath.objects)
        self.assertGreater(len(toolpath.arcs), 0)
        for name in ("beads", "runs", "arcs"):
            self.assertTrue(np.array_equal(getattr(again, name), getattr(toolpath, name)))
        self.assertFalse(np.shares_memory(again.beads, toolpath.beads))
        self.assertAlmostEqual(again.extruded_mm3, toolpath.bead_volumes().sum(), places=6)

    def test_replace(self):
        toolpath = stratum.read(gcode("tile.gcode"), timed=True)
        beads = toolpath.beads.copy()
        beads["x0"] += 10
        beads["x1"] += 10
        moved = toolpath.replace(beads=beads)
        np.testing.assert_array_equal(moved.beads["x0"], toolpath.beads["x0"] + 10)
        self.assertEqual(moved.slicer, toolpath.slicer)
        self.assertIsNone(moved.timing)
        half = toolpath.replace(beads=toolpath.beads[::2])
        np.testing.assert_array_equal(half.beads["y1"], toolpath.beads["y1"][::2])

    def refuses(self, remedy, change=None, **arrays):
        beads, runs = box_of_beads(10)
        given = {"beads": beads, "runs": runs, **arrays}
        if change:
            change(given)
        with self.assertRaisesRegex(stratum.UsageError, remedy):
            stratum.make_toolpath(given["beads"], given["runs"], given.get("arcs"), given.get("objects"))

    def test_bad_arrays(self):
        self.assertTrue(issubclass(stratum.UsageError, ValueError))
        self.refuses("numpy.zeros", beads=[1, 2, 3])
        self.refuses("dtype stratum.bead_dtype.*field by field", beads=np.zeros((10, 9)).reshape(-1))
        self.refuses(r"not the shape \(10, 1\); use .reshape", lambda g: g.update(beads=g["beads"].reshape(10, 1)))
        masked = np.ma.masked_array(box_of_beads(10)[0])
        masked["x1"][3] = np.ma.masked
        self.refuses("beads: has masked values", beads=masked)
        self.refuses("is empty", lambda g: g.update(beads=g["beads"][:0]))
        self.refuses("dtype stratum.run_dtype", runs=np.zeros(1, stratum.arc_dtype))
        for bad in (np.nan, np.inf, 1e9):
            self.refuses(r"beads\[3\]: y1 is .*leave such beads out", lambda g, v=bad: g["beads"]["y1"].__setitem__(3, v))
        for bad in (np.nan, 0, -1, 1e4):
            self.refuses(r"beads\[2\]: width", lambda g, v=bad: g["beads"]["width"].__setitem__(2, v))
            self.refuses(r"runs\[0\]: height", lambda g, v=bad: g["runs"]["height"].__setitem__(0, v))
        self.refuses(r"beads\[9\]: run 1: there are 1", lambda g: g["beads"]["run"].__setitem__(9, 1))
        self.refuses(r"beads\[0\]: arc 0: there are 0", lambda g: g["beads"]["arc"].__setitem__(0, 0))
        self.refuses(r"runs\[0\]: object 1", lambda g: g["runs"]["object"].__setitem__(0, 1))
        self.refuses(r"runs\[0\]: feature 200", lambda g: g["runs"]["feature"].__setitem__(0, 200))
        self.refuses(r"runs\[0\]: speed", lambda g: g["runs"]["speed"].__setitem__(0, np.nan))
        self.refuses("the first must be", objects=["cube"])
        arcs = np.zeros(1, stratum.arc_dtype)
        self.refuses(r"arcs\[0\]: sweep 0", arcs=arcs)
        arcs = arcs.copy()
        arcs["sweep"] = 1
        self.refuses(r"beads\[5\]: its ends are", lambda g: g["beads"]["arc"].__setitem__(5, 0), arcs=arcs)

    def test_strided_arrays(self):
        beads, runs = box_of_beads(20)
        toolpath = stratum.make_toolpath(beads[::-2], runs)
        self.assertTrue(np.array_equal(toolpath.beads, beads[::-2]))


FIELDS = ("objects", "slicer", "firmware", "format", "filament_diameter", "layer_height", "layer_count", "extrusion_rule",
          "cut_short", "filament_mm", "prime_mm", "primed_mm", "extruded_mm3", "warnings", "stated", "times", "source")


class Pickles(unittest.TestCase):
    def same(self, toolpath, again):
        for name in ("beads", "runs", "arcs", "timing", "flow", "travels"):
            one, other = getattr(toolpath, name), getattr(again, name)
            if one is None:
                self.assertIsNone(other)
            else:
                self.assertEqual(one.dtype, other.dtype)
                self.assertTrue(np.array_equal(one, other), name)
        for name in FIELDS:
            self.assertEqual(getattr(toolpath, name), getattr(again, name), name)
        self.assertEqual(toolpath.summary(), again.summary())
        self.assertEqual(toolpath.__getstate__(), again.__getstate__())  # what has no name, too

    def test_every_field(self):
        everything = {"timed": True, "flow_lag": 0.02, "sag": 0.1, "strings": True, "beads": "settled", "section": "50%",
                      "filament_colors": "#ff8000"}
        for name, options in (("tile.gcode", {}), ("tile_arcs.gcode", everything), ("two_tone.gcode", {"timed": True, "travels": True}),
                              ("hull.gcode", {"planner": "jerk", "timed": True})):
            toolpath = stratum.read(gcode(name), **options)
            for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
                self.same(toolpath, pickle.loads(pickle.dumps(toolpath, protocol)))
            self.same(toolpath, copy.deepcopy(toolpath))
        beads, runs = box_of_beads(100)
        self.same(stratum.make_toolpath(beads, runs), copy.copy(stratum.make_toolpath(beads, runs)))

    def test_gives_the_same_file(self):
        toolpath = stratum.read(gcode("two_tone.gcode"), timed=True)
        files = [path_of(name) for name in ("plain.vdb", "pickled.vdb")]
        for path, of in zip(files, (toolpath, pickle.loads(pickle.dumps(toolpath)))):
            stratum.write_vdb(of, path, voxel_size=0.3, grids="color,time,tool")
        self.assertEqual(read_bytes(files[0]), read_bytes(files[1]))

    def test_bytes_are_stable(self):
        path = gcode("tile_arcs.gcode")
        states = {stratum.read(path, timed=True).__getstate__() for _ in range(3)}
        self.assertEqual(len(states), 1)

    def test_damage_and_versions(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        state = toolpath.__getstate__()
        empty = stratum.Toolpath.__new__(stratum.Toolpath)
        for bad in (b"", b"stratum", state[:-1], state[:100], state + b"x", state[:50] + b"?" + state[51:]):
            with self.assertRaisesRegex(stratum.InputError, "damaged; read the G-code again"):
                empty.__setstate__(bad)
        at = state.index(b"stratum.Toolpath") + 16
        other = state[:at] + (99).to_bytes(4, "little") + state[at + 4:-4]
        with self.assertRaisesRegex(stratum.InputError, "version 99; this stratum reads version [0-9]+"):
            empty.__setstate__(other + zlib.crc32(other).to_bytes(4, "little"))
        empty.__setstate__(state)
        self.same(toolpath, empty)
        with self.assertRaisesRegex(TypeError, "never changes"):
            empty.__setstate__(state)

    def test_objects_without_a_value(self):
        """Their values were read from memory that nobody had written: a crash."""
        empty = stratum.Toolpath.__new__(stratum.Toolpath)
        self.assertEqual((len(empty), empty.travels, empty.times, empty.source), (0, None, None, ""))
        self.assertEqual(repr(empty), "<stratum.Toolpath: 0 beads in 0 layers>")
        for one in (stratum.Picture, stratum.LevelSet, stratum.PrintField, stratum.Intersector):
            with self.assertRaises(TypeError):
                one.__new__(one)
        with self.assertRaisesRegex(TypeError, "No constructor defined"):
            stratum.Picture.__new__(stratum.Picture, 1)
        class Same(stratum.PrintField):
            pass

        toolpath = stratum.read(gcode("tile.gcode"))
        for one in (stratum.PrintField, stratum.Intersector, Same):
            with self.assertRaisesRegex(TypeError, "incompatible constructor arguments|expected a PrintField"):
                one.__new__(one, 1)
        for field in (Same(toolpath, voxel_size=0.2), Same.__new__(Same, toolpath, voxel_size=0.2)):
            self.assertIs(type(field), Same)
            self.assertEqual(field.voxel_size, 0.2)
        with self.assertRaises(TypeError):
            stratum.Toolpath()

    def test_a_users_class(self):
        class Own(stratum.PrintField):
            def __init__(self):
                super().__init__(stratum.read(gcode("tile.gcode")), voxel_size=0.2)

        self.assertEqual(Own().voxel_size, 0.2)


class Errors(unittest.TestCase):
    def test_text_that_is_no_utf8(self):
        """Latin-1 in names, comments and the file's own name."""
        text = b"M83\n;LAYER_CHANGE\n;HEIGHT:0.2\n;TYPE:caf\xe9\nM486 S0\nM486 Ab\xe9\nG1 Z0.2 F600\nG1 X100 E5 F1200\n"
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(os.fsencode(folder), b"caf\xe9.gcode")
            with open(path, "wb") as file:
                file.write(text)
            toolpath = stratum.read(os.fsdecode(path))
        self.assertEqual(toolpath.objects, ["", "b\u00e9"])
        self.assertIn("caf\u00e9", toolpath.warnings[0]["text"])
        self.assertTrue(toolpath.summary())
        with self.assertRaisesRegex(stratum.UsageError, "b\u00e9"):
            toolpath.select(objects="zz")

    def test_what_has_no_effect_or_makes_no_sense(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        for refused, words in (
                (lambda: stratum.write_vdb(toolpath, "part.stl", voxel_size=0.5), "must end in .vdb"),
                (lambda: stratum.voxelize(toolpath, grids="time", voxel_size=0.5), "read it with timed=True"),
                (lambda: stratum.render(toolpath, color_by="time", size=(16, 16)), "timed=True"),
                (lambda: stratum.PrintField(toolpath, voxel_size=0.5).attribute("time", [[0, 0, 0]]), "timed=True"),
                (lambda: stratum.read(gcode("tile.gcode"), planner="jerk"), "timed=True"),
                (lambda: stratum.report(toolpath, unit="cm"), "a report is in mm"),
                (lambda: stratum.Intersector(stratum.PrintField(toolpath, voxel_size=0.5), grid="x"), "of a .vdb alone")):
            with self.assertRaisesRegex(stratum.UsageError, words):
                refused()
        for wrong in ({"objects": 5}, {"objects": [1, 2]}):
            with self.assertRaisesRegex(TypeError, "objects: expected a text"):
                toolpath.replace(**wrong)
        runs = toolpath.runs.copy()
        runs["layer"][0] = 100000000
        with self.assertRaisesRegex(stratum.UsageError, r"runs\[0\]: layer 100000000"):
            toolpath.replace(runs=runs)

    def test_replaced_beads_have_their_filament(self):
        two = stratum.read(b"M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z0.2 F600\nG1 X100 E5\nT1\nG1 X0 E2.5\n",
                           filament_diameter=[1.75, 2.85])
        self.assertAlmostEqual(two.replace(beads=two.beads).filament_mm, 7.5, 5)
        first = two.replace(beads=two.beads[:1])
        self.assertAlmostEqual(first.filament_mm, 5, 5)
        self.assertAlmostEqual(stratum.report(first)["numbers"]["filament_length"]["value"], 5, 5)

    def test_arcs_end_where_their_beads_end(self):
        toolpath = stratum.read(b"M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 X10 Y0 Z0.2 F600\nG3 X0 Y10 I-10 J0 E1\n")
        arcs = toolpath.arcs.copy()
        arcs["sweep"] *= -1
        with self.assertRaisesRegex(stratum.UsageError, "sweep of arcs"):
            toolpath.replace(arcs=arcs)

    def test_input(self):
        for source, text in (("/nowhere/part.gcode", "/nowhere/part.gcode"), (b"", "empty|no G-code"), (b"\0" * 100, "")):
            with self.assertRaisesRegex(stratum.InputError, text):
                stratum.read(source)

    def test_options(self):
        path = gcode("tile.gcode")
        with self.assertRaisesRegex(TypeError, "did you mean 'filament_diameter'.*there are"):
            stratum.read(path, filament_diametre=2)
        with self.assertRaisesRegex(stratum.UsageError, r"read\(\): filament_colors bluu.*did you mean"):
            stratum.read(path, filament_colors="bluu")
        with self.assertRaisesRegex(stratum.UsageError, "^tools 4: the print has no such tool; all of it is by tool 0"):
            stratum.voxelize(stratum.read(path), tools=4, voxel_size=0.4)
        for options, words in (({"layers": "9:3"}, "^layers 9:3: the first"), ({"features": "x"}, "^features x: expected"),
                               ({"objects": "cube"}, "^objects cube: "), ({"grids": "x"}, "^grids x: "),
                               ({"tolerance": -1}, "^tolerance -1: ")):
            with self.assertRaisesRegex(stratum.UsageError, words) as caught:
                stratum.voxelize(stratum.read(path), **options)
            self.assertNotIn("--", str(caught.exception))
        mixing = stratum.read(b"M83\nM163 S0 P0.5\nM163 S1 P0.5\nM164 S0\nG1 X10 Y10 Z0.2 F600\nG1 X20 E1\n")
        self.assertIn("filament_colors NAME,NAME,... says which", " ".join(w["text"] for w in mixing.warnings))
        with self.assertRaisesRegex(stratum.InputError, "left by layers, features, objects and tools"):
            stratum.voxelize(stratum.read(path), layers="800:900")
        for options, words in (({"spp": 99999999}, "spp=99999999: expected a whole number from 1 to 65536"),
                               ({"view": "x"}, "view='x': expected one of iso"), ({"env": "x"}, "^env x"),
                               ({"seconds": -1}, "^seconds -1"), ({"lights": "x"}, "^lights x"),
                               ({"ao_distance": -1, "integrator": "ao"}, ""), ({"f_number": -1}, "^f_number -1")):
            with self.assertRaisesRegex(stratum.UsageError, words) as caught:
                stratum.render(path, size=(16, 16), voxel_size=0.4, **options)
            self.assertNotRegex(str(caught.exception), r"(^|[ (])--[a-z]")
        with self.assertRaisesRegex(stratum.UsageError, "did you mean 'klipper'"):
            stratum.read(path, firmware="kliper")
        with self.assertRaisesRegex(TypeError, "plate: expected a whole number, not 1.5"):
            stratum.read(path, plate=1.5)
        with self.assertRaisesRegex(stratum.UsageError, "from 0 to 0.5"):
            stratum.read(path, sag=3)
        with self.assertRaisesRegex(stratum.UsageError, "finite"):
            stratum.read(path, layer_height=float("nan"))
        with self.assertRaisesRegex(TypeError, "expected a path"):
            stratum.read(42)
        with self.assertRaisesRegex(TypeError, "progress"):
            stratum.read(path, progress=3)


class Threads(unittest.TestCase):
    def test_many_read_one(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        expected = toolpath.beads["x0"].sum()
        found = []

        def work():
            for _ in range(20):
                found.append(toolpath.beads["x0"].sum() == expected and len(toolpath.select(layers="1:5")) > 0)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 80)
        self.assertTrue(all(found))


if __name__ == "__main__":
    unittest.main()

"""Level sets: the tool's bytes, dense blocks, values as pyopenvdb reads them, sampling."""

import os
import sys
import unittest

import numpy as np

import stratum
from common import CORPUS, gcode, path_of, read_bytes, tool


class Files(unittest.TestCase):
    """write_vdb() makes the file of gcode2vdb."""

    def same(self, name, command, **options):
        theirs, ours = path_of("theirs.vdb"), path_of("ours.vdb")
        tool("gcode2vdb", gcode(name), "-o", theirs, "--quiet", *command)
        stratum.write_vdb(stratum.read(gcode(name)), ours, **options)
        self.assertEqual(read_bytes(ours), read_bytes(theirs))

    def test_streamed(self):
        self.same("tile.gcode", [])
        self.same("hull.gcode", ["--voxel-size", "0.2", "--layers", "3:9", "--features", "-infill"],
                  voxel_size=0.2, layers="3:9", features="-infill")
        self.same("gear.gcode", ["--voxels-per-layer", "2", "--unit", "m", "--up", "y", "--origin", "center", "--precision",
                                 "half", "--compression", "zip"],
                  voxels_per_layer=2, unit="m", up="y", origin="center", precision="half", compression="zip")

    def test_in_memory(self):
        self.same("tile.gcode", ["--grids", "layer,width", "--voxel-size", "0.2"], grids="layer,width", voxel_size=0.2)
        self.same("hull.gcode", ["--interior", "cull", "--voxel-size", "0.2"], interior="cull", voxel_size=0.2)
        self.same("tile.gcode", ["--interior-distance", "--voxel-size", "0.2"], interior_distance=True, voxel_size=0.2)
        self.same("two_tone.gcode", ["--voxel-size", "0.2"], voxel_size=0.2)
        self.same("two_tone.gcode", ["--voxel-size", "0.2", "--tool", "1", "--grids", "surface"], voxel_size=0.2, tools=1,
                  grids="surface")

    def test_of_what_the_plastic_does(self):
        theirs, ours = path_of("theirs.vdb"), path_of("ours.vdb")
        tool("gcode2vdb", gcode("tile.gcode"), "-o", theirs, "--quiet", "--printer", "typical")
        stratum.write_vdb(stratum.read(gcode("tile.gcode"), printer="typical"), ours)
        self.assertEqual(read_bytes(ours), read_bytes(theirs))

    def test_level_set_writes_the_same(self):
        theirs, ours = path_of("theirs.vdb"), path_of("ours.vdb")
        tool("gcode2vdb", gcode("tile.gcode"), "-o", theirs, "--quiet", "--grids", "tool", "--voxel-size", "0.2")
        stratum.voxelize(stratum.read(gcode("tile.gcode")), grids=["tool"], voxel_size=0.2).write(ours)
        self.assertEqual(read_bytes(ours), read_bytes(theirs))

    def test_a_made_toolpath_names_no_file(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        made = stratum.make_toolpath(toolpath.beads, toolpath.runs)
        stratum.write_vdb(made, path_of("made.vdb"), voxel_size=0.2)
        metadata = stratum.LevelSet.read(path_of("made.vdb")).metadata
        self.assertNotIn("source_file", metadata)
        self.assertNotIn("source_sha256", metadata)
        self.assertAlmostEqual(metadata["voxel_size_mm"], 0.2)

    def test_errors(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        with self.assertRaisesRegex(stratum.OutputError, "nowhere"):
            stratum.write_vdb(toolpath, "/nowhere/part.vdb")
        self.assertTrue(issubclass(stratum.OutputError, OSError))
        with self.assertRaisesRegex(stratum.UsageError, "give one of them"):
            stratum.voxelize(toolpath, voxel_size=0.1, voxels_per_layer=2)
        with self.assertRaises(stratum.UsageError):
            stratum.voxelize(toolpath, voxel_size=-1)
        with self.assertRaises(stratum.UsageError):
            stratum.voxelize(toolpath, voxel_size=1e-6)
        with self.assertRaisesRegex(stratum.InputError, "layers"):
            stratum.voxelize(toolpath, layers="900:")
        with self.assertRaisesRegex(TypeError, "voxel_size"):
            stratum.voxelize(toolpath, voxelsize=0.1)
        with self.assertRaises(stratum.InputError):
            stratum.LevelSet.read("/nowhere/part.vdb")


class Dense(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.toolpath = stratum.read(gcode("hull.gcode"))
        cls.level_set = stratum.voxelize(cls.toolpath, voxel_size=0.2)
        cls.block = stratum.voxelize_block(cls.toolpath, voxel_size=0.2)

    def test_block_is_the_level_set(self):
        values, origin, size = self.block
        self.assertEqual((values.dtype, values.ndim, values.flags.c_contiguous), (np.float32, 3, True))
        high = np.add(origin, size * (np.array(values.shape) - 1))
        dense = self.level_set.dense((origin, high))
        np.testing.assert_allclose(dense.origin, origin, atol=1e-9)
        self.assertEqual(dense.values.shape, values.shape)
        np.testing.assert_array_equal(dense.values, values)
        self.assertLess(values.min(), 0)
        self.assertAlmostEqual(values.max(), self.level_set.background)

    def test_all_active_are_inside(self):
        whole = self.level_set.dense()
        values, origin, size = self.block
        first = np.rint((np.array(whole.origin) - origin) / size).astype(int)
        self.assertTrue((first >= 0).all() and (first + whole.values.shape <= values.shape).all())
        cut = values[tuple(slice(a, a + n) for a, n in zip(first, whole.values.shape))]
        np.testing.assert_array_equal(whole.values, cut)

    def test_boxes(self):
        values, origin, size = self.block
        generator = np.random.default_rng(3)
        for _ in range(20):
            corners = np.sort(generator.integers(-9, np.array(values.shape) + 9, (2, 3)), axis=0)
            low, high = origin + size * corners[0], origin + size * corners[1]
            part = stratum.voxelize_block(self.toolpath, (low, high), voxel_size=0.2)
            np.testing.assert_allclose(part.origin, low, atol=1e-6)
            self.assertEqual(part.values.shape, tuple(corners[1] - corners[0] + 1))
            expected = np.full(part.values.shape, self.level_set.background, np.float32)
            inner_low = np.clip(corners[0], 0, values.shape)
            inner_high = np.clip(corners[1] + 1, 0, values.shape)
            if (inner_high > inner_low).all():
                here = tuple(slice(a - c, b - c) for a, b, c in zip(inner_low, inner_high, corners[0]))
                expected[here] = values[tuple(slice(a, b) for a, b in zip(inner_low, inner_high))]
            np.testing.assert_array_equal(part.values, expected)

    def test_other_beads(self):
        for options in ({"beads": "settled"}, {"printer": "typical"}, {"section": "50%"}):
            toolpath = stratum.read(gcode("bridges.gcode"), **options)
            block = stratum.voxelize_block(toolpath, voxel_size=0.15, layers="1:12")
            high = np.add(block.origin, block.voxel_size * (np.array(block.values.shape) - 1))
            grid = stratum.voxelize(toolpath, voxel_size=0.15, layers="1:12").dense((block.origin, high))
            np.testing.assert_array_equal(block.values, grid.values)

    def test_errors(self):
        with self.assertRaisesRegex(stratum.UsageError, "two corners"):
            stratum.voxelize_block(self.toolpath, [[0, 0, 0]])
        with self.assertRaisesRegex(stratum.UsageError, "finite"):
            stratum.voxelize_block(self.toolpath, [[0, 0, 0], [1, 1, float("nan")]])
        with self.assertRaisesRegex(stratum.UsageError, "smaller box"):
            stratum.voxelize_block(self.toolpath, [[-4e3] * 3, [4e3] * 3], voxel_size=0.2)
        with self.assertRaisesRegex(stratum.UsageError, "no sample"):
            stratum.voxelize_block(self.toolpath, [[0.01, 0, 0], [0.02, 1, 1]], voxel_size=0.2)


class Sampling(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.toolpath = stratum.read(gcode("hull.gcode"))
        cls.level_set = stratum.voxelize(cls.toolpath, voxel_size=0.1, layers="1:12", grids="layer,tool,width,feature")
        cls.field = stratum.PrintField(cls.toolpath, voxel_size=0.1, layers="1:12")
        low, high = np.array(cls.level_set.bounds)
        cls.points = np.random.default_rng(1).uniform(low, high, (20000, 3))

    def test_at_samples(self):
        block = self.level_set.dense()
        index = np.stack([np.random.default_rng(2).integers(0, n, 5000) for n in block.values.shape], axis=1)
        points = block.origin + block.voxel_size * index
        np.testing.assert_allclose(self.level_set.sample(points), block.values[tuple(index.T)], atol=1e-6)
        homogeneous = self.level_set.transform @ np.array([1, 2, 3, 1])
        np.testing.assert_allclose(homogeneous[:2], [0.1, 0.2])

    def test_exact_distance(self):
        # At the samples both are the same; between them the level set is trilinear.
        block = self.level_set.dense()
        index = np.argwhere(np.abs(block.values) < self.field.reach)
        index = index[np.random.default_rng(5).integers(0, len(index), 20000)]
        points = block.origin + block.voxel_size * index
        values = block.values[tuple(index.T)]
        exact = self.field.distance(points)
        np.testing.assert_allclose(exact, values, atol=2e-6)
        self.assertGreater((values < 0).sum(), 1000)

    def test_trilinear_is_near(self):
        exact = self.field.distance(self.points)
        sampled = self.level_set.sample(self.points)
        outside = (exact > 0) & (exact < self.field.reach - 0.1)
        self.assertGreater(outside.sum(), 500)
        self.assertLess(np.abs(exact - sampled)[outside].mean(), 0.01)
        self.assertTrue((np.abs(exact - sampled)[outside] < 0.1).all())

    def test_far_away(self):
        far = np.array([[1e300, 0, 0], [0, -1e12, 0], [0, 0, 1e6]])
        np.testing.assert_allclose(self.level_set.sample(far), self.level_set.background)
        np.testing.assert_allclose(self.field.distance(far), self.field.reach)
        self.assertEqual(self.level_set.sample(np.zeros((0, 3))).shape, (0,))

    def test_attributes(self):
        self.assertEqual(self.level_set.attributes, ["layer", "tool", "width", "feature"])
        surface = self.points[np.abs(self.level_set.sample(self.points)) < 0.05]
        for name, kind in (("layer", np.int32), ("tool", np.int32), ("feature", np.int32), ("width", np.float32)):
            of_grid, of_print = self.level_set.attribute(name, surface), self.field.attribute(name, surface)
            self.assertEqual((of_grid.dtype, of_grid.shape), (kind, (len(surface),)))
            np.testing.assert_array_equal(of_grid, of_print)
        layers = self.level_set.attribute("layer", surface)
        self.assertEqual((layers.min(), layers.max()), (1, 12))
        nothing = self.level_set.attribute("layer", [[1e3, 0, 0]])
        self.assertEqual(nothing[0], -1)
        self.assertTrue(np.isnan(self.level_set.attribute("width", [[1e3, 0, 0]])[0]))
        self.assertEqual(self.field.attribute("color", surface).shape, (len(surface), 3))
        with self.assertRaisesRegex(stratum.UsageError, "there are layer, tool"):
            self.level_set.attribute("time", surface)
        with self.assertRaisesRegex(stratum.UsageError, "layer"):
            self.field.attribute("layers", surface)

    def test_bad_points(self):
        for method in (self.level_set.sample, self.field.distance):
            with self.assertRaisesRegex(stratum.UsageError, r"shape \(N, 3\), not \(3,\); use .reshape\(-1, 3\)"):
                method([1.0, 2.0, 3.0])
            with self.assertRaisesRegex(stratum.UsageError, r"points\[1\]: is not finite; leave such rows out"):
                method([[0, 0, 0], [0, np.nan, 0]])
            with self.assertRaisesRegex(stratum.UsageError, "expected numbers"):
                method([["a", "b", "c"]])

    def test_settled_beads_have_no_exact_distance(self):
        field = stratum.PrintField(stratum.read(gcode("tile.gcode"), beads="settled"), voxel_size=0.2)
        with self.assertRaisesRegex(stratum.UsageError, "sample a level set"):
            field.distance([[0, 0, 0]])


class Meshes(unittest.TestCase):
    def test_is_that_of_the_tool(self):
        path = path_of("tile.stl")
        for error in (0, 0.25):
            tool("gcode2vdb", gcode("tile.gcode"), "-o", path, "--quiet", "--voxel-size", "0.2", "--interior", "keep",
                 "--mesh-error", error, "--features", "all")
            stl = np.frombuffer(read_bytes(path)[84:], [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("none", "<u2")])
            mesh = stratum.voxelize(stratum.read(gcode("tile.gcode")), voxel_size=0.2).mesh(mesh_error=error)
            self.assertEqual((mesh.vertices.dtype, mesh.faces.dtype, mesh.colors), (np.float32, np.uint32, None))
            np.testing.assert_array_equal(mesh.vertices[mesh.faces], stl["corners"])

    def test_is_closed(self):
        level_set = stratum.voxelize(stratum.read(gcode("vase.gcode")), voxel_size=0.2)
        mesh = level_set.mesh()
        corners = mesh.vertices.astype(float)[mesh.faces]
        volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
        self.assertGreater(volume, 100)
        edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]).astype(np.int64)
        there, back = (np.sort(edges[:, a] << 32 | edges[:, 1 - a]) for a in (0, 1))
        np.testing.assert_array_equal(there, back)
        self.assertEqual(set(np.unique(mesh.faces)), set(range(len(mesh.vertices))))
        self.assertLessEqual(len(level_set.mesh(outside_only=True).faces), len(mesh.faces))

    def test_colors(self):
        level_set = stratum.voxelize(stratum.read(gcode("two_tone.gcode")), voxel_size=0.2)
        self.assertIn("color", level_set.attributes)
        mesh = level_set.mesh()
        self.assertEqual((mesh.colors.dtype, mesh.colors.shape), (np.uint8, mesh.vertices.shape))
        self.assertEqual(len(np.unique(mesh.colors, axis=0)), 2)
        for bad in (-1, 2.5, np.nan):
            with self.assertRaisesRegex(stratum.UsageError, "mesh_error=.*from 0 to 2"):
                level_set.mesh(mesh_error=bad)


class OpenVdb(unittest.TestCase):
    def test_same_values(self):
        sys.path.append("/usr/lib/python3/dist-packages")
        try:
            import pyopenvdb
        except ImportError:
            self.skipTest("no pyopenvdb for this Python")
        path = path_of("hull.vdb")
        stratum.write_vdb(stratum.read(gcode("hull.gcode")), path, voxel_size=0.2, grids="width")
        theirs = pyopenvdb.read(path, "surface")
        ours = stratum.LevelSet.read(path, attributes=["width"])
        self.assertEqual(theirs.activeVoxelCount(), ours.active_voxels)
        self.assertEqual(theirs.background, ours.background)
        low, high = theirs.evalActiveVoxelBoundingBox()
        values = np.zeros(np.subtract(high, low) + 1, np.float32)
        theirs.copyToArray(values, ijk=low)
        block = ours.dense()
        np.testing.assert_array_equal(block.values, values)
        np.testing.assert_allclose(theirs.transform.indexToWorld(low), block.origin)
        widths = pyopenvdb.read(path, "width").getConstAccessor()
        inside = np.argwhere(np.abs(values) < 0.1)[::997]
        points = block.origin + block.voxel_size * inside
        expected = [widths.getValue(tuple(int(c) for c in low + index)) for index in inside]
        np.testing.assert_array_equal(ours.attribute("width", points), np.float32(expected))


class Corpus(unittest.TestCase):
    """Real files, where they are."""

    def test_block_of_real_prints(self):
        for name, layers in (("gcode-preview-benchy_slic3r.gcode", "5:9"), ("vase_ps25.gcode", "3:12"),
                             ("preprocess_cancellation-superslicer.gcode", "1:5")):
            path = os.path.join(CORPUS, "gcode", name)
            if not os.path.exists(path):
                self.skipTest(f"no {path}")
            toolpath = stratum.read(path)
            values, origin, size = stratum.voxelize_block(toolpath, voxel_size=0.2, layers=layers)
            high = np.add(origin, size * (np.array(values.shape) - 1))
            grid = stratum.voxelize(toolpath, voxel_size=0.2, layers=layers, grids="surface")
            np.testing.assert_array_equal(values, grid.dense((origin, high)).values, name)
            self.assertLess(values.min(), 0)


if __name__ == "__main__":
    unittest.main()

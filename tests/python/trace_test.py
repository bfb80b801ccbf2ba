"""Rays: the same hits through a print, its level set and its file, and against the field they are of."""

import unittest

import numpy as np

import stratum
from common import gcode, path_of


class Tracing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        toolpath = stratum.read(gcode("hull.gcode"))
        options = {"voxel_size": 0.1, "layers": "1:15"}
        cls.field = stratum.PrintField(toolpath, **options)
        cls.level_set = stratum.voxelize(toolpath, grids="layer,width", **options)
        cls.path = path_of("hull.vdb")
        cls.level_set.write(cls.path)
        low, high = np.array(cls.level_set.bounds)
        generator = np.random.default_rng(7)
        inside = generator.uniform(low, high, (30000, 3))
        cls.directions = generator.normal(size=(30000, 3))
        cls.origins = inside - 100 * cls.directions / np.linalg.norm(cls.directions, axis=1)[:, None]
        cls.intersectors = {
            "print": stratum.Intersector(cls.field, ["layer", "width"], brick_values="float"),
            "grid": stratum.Intersector(cls.level_set, ["layer", "width"], brick_values="float"),
            "file": stratum.Intersector(cls.path, ["layer", "width"], brick_values="float")}
        cls.hits = {name: shape.trace(cls.origins, cls.directions) for name, shape in cls.intersectors.items()}

    def test_all_sources_agree(self):
        first = self.hits["print"]
        self.assertGreater(first.hit.mean(), 0.2)
        self.assertLess(first.hit.mean(), 1)
        for name in ("grid", "file"):
            for field in ("t", "hit", "positions", "normals"):
                np.testing.assert_array_equal(getattr(self.hits[name], field), getattr(first, field), name)
            for attribute in ("layer", "width"):
                np.testing.assert_array_equal(self.hits[name].attributes[attribute], first.attributes[attribute])

    def test_hits_lie_on_the_surface(self):
        hits = self.hits["print"]
        unit = self.directions / np.linalg.norm(self.directions, axis=1)[:, None]
        np.testing.assert_allclose(hits.positions[hits.hit], (self.origins + hits.t[:, None] * unit)[hits.hit], atol=1e-9)
        np.testing.assert_allclose(self.level_set.sample(hits.positions[hits.hit]), 0, atol=1e-5)
        self.assertLess(np.abs(self.field.distance(hits.positions[hits.hit])).mean(), 0.01)
        np.testing.assert_allclose(np.linalg.norm(hits.normals[hits.hit], axis=1), 1, atol=1e-12)
        self.assertTrue((np.einsum("ij,ij->i", hits.normals, unit)[hits.hit] <= 1e-9).all())
        layers = hits.attributes["layer"]
        self.assertEqual((layers.dtype, layers[hits.hit].min() >= 1, layers.max()), (np.int32, True, 15))

    def test_misses(self):
        hits = self.hits["print"]
        missed = ~hits.hit
        self.assertEqual(hits.hit.dtype, bool)
        self.assertTrue(np.isinf(hits.t[missed]).all())
        self.assertTrue(np.isnan(hits.positions[missed]).all() and np.isnan(hits.normals[missed]).all())
        self.assertTrue((hits.attributes["layer"][missed] == -1).all())
        self.assertTrue(np.isnan(hits.attributes["width"][missed]).all())

    def test_occluded(self):
        for shape in self.intersectors.values():
            np.testing.assert_array_equal(shape.occluded(self.origins, self.directions), self.hits["print"].hit)

    def test_limits_of_t(self):
        hits = self.hits["print"]
        shape = self.intersectors["grid"]
        self.assertFalse(shape.trace(self.origins, self.directions, t_max=20).hit.any())
        one = np.flatnonzero(hits.hit)[0]
        again = shape.trace(self.origins[one:one + 1], self.directions[one:one + 1], t_min=hits.t[one] + 1e-6)
        self.assertTrue(again.t[0] > hits.t[one])

    def test_one_origin_or_one_direction(self):
        shape = self.intersectors["grid"]
        low, high = np.array(shape.bounds)
        top = np.random.default_rng(1).uniform(low, high, (1000, 3))
        top[:, 2] = high[2] + 5
        down = shape.trace(top, [[0, 0, -3]])
        np.testing.assert_array_equal(down.t, shape.trace(top, np.tile([0, 0, -1.0], (1000, 1))).t)
        self.assertEqual(len(shape.trace([high + 5], low - top).t), 1000)
        self.assertEqual(len(shape.trace(np.zeros((0, 3)), np.zeros((0, 3))).t), 0)

    def test_any_number_of_threads(self):
        self.addCleanup(stratum.set_threads, None)
        for count in (1, 3):
            stratum.set_threads(count)
            self.assertEqual(stratum.threads(), count)
            again = self.intersectors["grid"].trace(self.origins, self.directions)
            np.testing.assert_array_equal(again.t, self.hits["print"].t)
        with self.assertRaisesRegex(stratum.UsageError, "expected a whole number from 1"):
            stratum.set_threads(0)

    def test_outlives_its_source(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        shape = stratum.Intersector(stratum.PrintField(toolpath, voxel_size=0.2), ["tool"], smooth_normals=True)
        del toolpath
        low, high = np.array(shape.bounds)
        hits = shape.trace([[*(0.5 * (low + high))[:2], high[2] + 1]], [[0, 0, -1]])
        self.assertTrue(hits.hit[0])
        self.assertEqual(hits.attributes["tool"][0], 0)

    def test_bad_rays(self):
        shape = self.intersectors["grid"]
        for origins, directions, text in (
                ([[0, 0, 0]], [[0, 0, 0]], r"directions\[0\]: has no length"),
                ([[0, 0, 0]], [[0, 0, np.nan]], r"directions\[0\]: is not finite"),
                ([0, 0, 0], [[0, 0, 1]], r"origins: expected the shape \(N, 3\)"),
                (np.zeros((2, 3)), np.ones((3, 3)), "2 and 3 rows")):
            with self.assertRaisesRegex(stratum.UsageError, text):
                shape.trace(origins, directions)
        hidden = np.ma.masked_array(np.zeros((2, 3)), mask=[[0, 0, 0], [0, 1, 0]])
        with self.assertRaisesRegex(stratum.UsageError, "origins: has masked values.*filled"):
            shape.trace(hidden, np.ones((2, 3)))
        seen = np.ma.masked_array(np.zeros((2, 3)), mask=False)
        self.assertEqual(len(shape.trace(seen, np.ones((2, 3))).t), 2)
        with self.assertRaisesRegex(stratum.UsageError, "t_min"):
            shape.trace([[0, 0, 0]], [[0, 0, 1]], t_min=2, t_max=1)

    def test_bad_sources(self):
        with self.assertRaisesRegex(TypeError, "expected a PrintField"):
            stratum.Intersector(3)
        with self.assertRaises(stratum.InputError):
            stratum.Intersector("/nowhere/part.vdb")
        with self.assertRaisesRegex(stratum.InputError, "layer"):
            stratum.Intersector(self.path, ["tool"])


if __name__ == "__main__":
    unittest.main()

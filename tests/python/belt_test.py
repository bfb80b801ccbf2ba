"""A print on a belt: it lies in level sets, pictures and rays as it does in the world."""

import math
import unittest

import numpy as np
import stratum

# Two layers of three lines, laid 0.25 mm apart across the layers, with the gantry at 45 degrees.
LINES = "".join(
    f";LAYER:{n}\n;HEIGHT:0.25\nG0 Z{z:.6f}\n" + "".join(f"G0 X0 Y{y}\nG1 X10 E0.4\n" for y in (0, 0.5, 1))
    for n, z in enumerate((4, 4 + 0.25 * math.sqrt(2)))
)
PROGRAM = b"M83\nG0 X0 Y0 Z0 F6000\n" + LINES.encode()


class Belt(unittest.TestCase):
    def setUp(self):
        self.print = stratum.read(PROGRAM, belt=45)

    def test_angle(self):
        self.assertEqual(self.print.belt_angle, 45)
        self.assertEqual(stratum.read(PROGRAM).belt_angle, 0)
        self.assertEqual(self.print.replace(beads=self.print.beads[:2]).belt_angle, 45)
        for angle in (0, 90, math.nan):
            with self.assertRaises(stratum.UsageError):
                stratum.read(PROGRAM, belt=angle)

    def test_places(self):
        half = math.sqrt(0.5)
        # Nozzles at (y, Z) are y half along and up, less Z along; plastic is half a layer behind them.
        middles = np.array([(5, y * half - 4 + 0.125 * half, y * half - 0.125 * half) for y in (0, 0.5, 1)])
        # Samples lie on the planes of the layers, so those beside a middle are 0.1 mm deep.
        level_set = stratum.voxelize(self.print, voxel_size=0.05)
        np.testing.assert_array_less(level_set.sample(middles), -0.099)
        field = stratum.PrintField(self.print, voxel_size=0.05)
        np.testing.assert_array_less(field.distance(middles), -0.099)
        off = middles + (0, 0, 4)
        self.assertTrue((field.distance(off) > 0).all())
        low, high = level_set.bounds
        self.assertAlmostEqual(low[2], -0.5, delta=0.3)
        self.assertAlmostEqual(high[1], half - 4 + 0.2, delta=0.4)
        hits = stratum.Intersector(field).trace(middles + (0, 0, 9), [[0, 0, -1]])
        np.testing.assert_allclose(field.distance(hits.positions), 0, atol=0.03)

    def test_blocks_have_no_transform(self):
        with self.assertRaisesRegex(stratum.UsageError, "lean"):
            stratum.voxelize_block(self.print)


if __name__ == "__main__":
    unittest.main()

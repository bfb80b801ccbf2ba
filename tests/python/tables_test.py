"""Toolpaths as tables of pandas and as plots: the code of docs/python.md that needs other people's packages."""

import importlib.util
import os
import re
import tempfile
import unittest

import numpy as np

import stratum
from common import SOURCE, gcode

ABSENT = [name for name in ("pandas", "matplotlib") if importlib.util.find_spec(name) is None]


@unittest.skipIf(ABSENT, f"not installed: {', '.join(ABSENT)}; scripts/packages.sh has the packages")
class Tables(unittest.TestCase):
    def setUp(self):
        self.toolpath = stratum.read(gcode("two_tone.gcode"), timed=True, travels=True)

    def test_arrays_are_frames_and_come_back(self):
        import pandas
        for name in ("beads", "runs", "arcs", "timing", "travels"):
            array = getattr(self.toolpath, name)
            frame = pandas.DataFrame(array)
            self.assertEqual(len(frame), len(array))
            self.assertEqual(list(frame.columns), list(array.dtype.names))
            for column in frame:
                self.assertEqual(frame[column].dtype, array.dtype[column])
                np.testing.assert_array_equal(frame[column], array[column])
        frame = pandas.DataFrame(self.toolpath.beads)
        frame["width"] *= 2  # a copy: the toolpath's arrays are read-only
        beads = frame.to_records(index=False).astype(stratum.bead_dtype)
        wider = self.toolpath.replace(beads=beads)
        np.testing.assert_array_equal(wider.beads["width"], 2 * self.toolpath.beads["width"])
        np.testing.assert_array_equal(wider.beads["x0"], self.toolpath.beads["x0"])

    def test_code_of_the_page(self):
        import matplotlib
        matplotlib.use("Agg")
        import pandas
        with open(os.path.join(SOURCE, "docs", "python.md"), encoding="utf-8") as file:
            blocks = re.findall(r"^```py\n(.*?)^```", file.read(), re.M | re.S)
        self.assertEqual(len(blocks), 2)
        here = os.getcwd()
        with tempfile.TemporaryDirectory(prefix="stratum_tables_") as folder:
            os.chdir(folder)
            try:
                names = {"toolpath": self.toolpath, "stratum": stratum, "np": np}
                for block in blocks:
                    exec(compile(block, "page", "exec"), names)  # its own page
                self.assertGreater(os.path.getsize("layers.png"), 5000)
            finally:
                os.chdir(here)
        layers = names["layers"]
        self.assertIsInstance(layers, pandas.DataFrame)
        runs = self.toolpath.runs[self.toolpath.beads["run"]]
        first = runs["layer"] == 1
        self.assertAlmostEqual(layers.loc[1, "volume"], self.toolpath.bead_volumes()[first].sum(), 6)
        self.assertAlmostEqual(layers["seconds"].sum(), self.toolpath.timing["seconds"].sum(dtype=float), 1)
        self.assertEqual(len(layers), len(set(runs["layer"])))


if __name__ == "__main__":
    unittest.main()

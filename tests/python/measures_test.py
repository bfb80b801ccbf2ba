"""Numbers of a print and its distances from a model: those of gcode2vdb."""

import json
import unittest

import stratum
from common import gcode, path_of, tool


class Measures(unittest.TestCase):
    def test_report_is_that_of_the_tool(self):
        tool("gcode2vdb", gcode("tile.gcode"), "--report", path_of("a.json"), "--voxel-size", "0.2", "--density", "1.3",
             "--layers", "2:6", "--quiet")
        with open(path_of("a.json"), encoding="utf-8") as file:
            theirs = json.load(file)
        ours = stratum.report(stratum.read(gcode("tile.gcode"), timed=True), voxel_size=0.2, density=1.3, layers="2:6")
        self.assertEqual(ours["numbers"], theirs["numbers"])
        self.assertEqual(ours["by_layer"], theirs["by_layer"])

    def test_compare_is_that_of_the_tool(self):
        # The outside of the print itself is its model here.
        tool("gcode2vdb", gcode("tile.gcode"), "-o", path_of("tile.stl"), "--voxel-size", "0.2", "--features", "-skirt",
             "--mesh-error", "0", "--quiet")
        theirs = json.loads(tool("gcode2vdb", gcode("tile.gcode"), "-o", path_of("tile.vdb"), "--voxel-size", "0.2",
                                 "--compare", path_of("tile.stl"), "--compare-at", "bed", "--stats", "-", "--quiet"))
        ours = stratum.compare(stratum.read(gcode("tile.gcode")), path_of("tile.stl"), at="bed", voxel_size=0.2)
        self.assertEqual(ours, theirs["compare"])
        self.assertLess(ours["print_to_model"]["all"]["rms_mm"], 1e-3)

    def test_errors(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        with open(path_of("open.obj"), "w", encoding="ascii") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        with self.assertRaisesRegex(stratum.InputError, "not closed"):
            stratum.compare(toolpath, path_of("open.obj"))
        with self.assertRaisesRegex(stratum.UsageError, "at"):
            stratum.compare(toolpath, path_of("open.obj"), at="moon")
        with self.assertRaisesRegex(stratum.UsageError, "density"):
            stratum.report(toolpath, density=-1)


if __name__ == "__main__":
    unittest.main()

"""Pictures: the pixels and files of vdbtrace."""

import unittest

import numpy as np

import stratum
from common import gcode, path_of, read_bytes, tool
from png_file import png_pixels


def pixels_of(path):
    """The 8-bit RGB or RGBA pixels of a PNG."""
    width, height, rows = png_pixels(read_bytes(path))
    return np.frombuffer(b"".join(rows), np.uint8).reshape(height, width, -1)


class Pictures(unittest.TestCase):
    def same(self, source, command, **options):
        """vdbtrace's PNG has the same pixels, and the file that Picture writes the same bytes."""
        theirs, ours = path_of("theirs.png"), path_of("ours.png")
        tool("vdbtrace", source, "-o", theirs, "--quiet", "--size", "96x72", *command)
        picture = stratum.render(source, size=(96, 72), **options)
        np.testing.assert_array_equal(picture.srgb, pixels_of(theirs))
        picture.write(ours)
        self.assertEqual(read_bytes(ours), read_bytes(theirs))
        return picture

    def test_nothing_behind_the_print(self):
        picture = self.same(gcode("tile.gcode"), ["--background", "none"], background="none")
        self.assertEqual(picture.srgb.shape, (72, 96, 4))
        self.assertEqual(picture.alpha[0, 0], 0)
        shadow = (picture.alpha > 0.05) & (picture.alpha < 0.9) & (picture.linear.max(axis=2) < 0.01)
        self.assertGreater(shadow.sum(), 100)
        with self.assertRaises(stratum.UsageError):
            picture.write(path_of("refused.jpg"))

    def test_defaults(self):
        picture = self.same(gcode("tile.gcode"), [])
        self.assertEqual((picture.linear.shape, picture.linear.dtype), ((72, 96, 3), np.float32))
        self.assertEqual((picture.srgb.shape, picture.srgb.dtype), ((72, 96, 3), np.uint8))
        self.assertEqual(picture.metadata["Source"], "tile.gcode")
        self.assertIn("Denoised", picture.metadata)

    def test_options(self):
        self.same(gcode("hull.gcode"),
                  ["--spp", "4", "--no-denoise", "--view", "front", "--brdf", "pla-blue", "--env", "sky", "--voxel-size",
                   "0.2", "--layers", "1:60", "--seed", "3", "--no-bed"],
                  spp=4, denoise=False, view="front", brdf="pla-blue", env="sky", voxel_size=0.2, layers="1:60", seed=3,
                  bed=False)
        self.same(gcode("hull.gcode"),
                  ["--spp", "2", "--eye", "40,20,60", "--look-at", "100,100,10", "--fov", "30", "--clip", "0,1,0,100",
                   "--color-by", "feature", "--legend", "--voxel-size", "auto", "--printed", "60%", "--exposure", "0.5"],
                  spp=2, eye=(40, 20, 60), look_at=(100, 100, 10), fov=30, clip=(0, 1, 0, 100), color_by="feature",
                  legend=True, voxel_size="auto", printed="60%", exposure=0.5)
        self.same(gcode("tile.gcode"), ["--integrator", "ao", "--spp", "4", "--crop", "10,10,50,40"], integrator="ao",
                  spp=4, crop=(10, 10, 50, 40))

    def test_level_set_file(self):
        vdb = path_of("tile.vdb")
        stratum.write_vdb(stratum.read(gcode("tile.gcode")), vdb, voxel_size=0.2, grids="layer")
        self.same(vdb, ["--spp", "2", "--color-by", "layer"], spp=2, color_by="layer")
        self.same(vdb, ["--spp", "2", "--color-by", "layer", "--color-range", "2,9"], spp=2, color_by="layer", color_range=(2, 9))

    def test_colors_of_tools(self):
        path = gcode("two_tone.gcode")
        some = ["--spp", "2", "--layers", "6:10", "--view", "top"]
        options = {"spp": 2, "layers": "6:10", "view": "top"}
        names = ["teal", "3DJAKE Silk Gold"]
        two = self.same(path, [*some, "--color", ",".join(names)], color=names, **options)
        one = self.same(path, [*some, "--color", "Prusament Galaxy Black"], color="Prusament Galaxy Black", **options)
        self.assertFalse(np.array_equal(one.linear, two.linear))
        # Of a toolpath that is read, the colours are those it was read with: plain, since finishes are of pictures.
        plain = stratum.render(path, size=(96, 72), color=["teal", "#c49954"], **options)
        read = stratum.read(path, filament_colors=["teal", "#c49954"])
        np.testing.assert_array_equal(stratum.render(read, size=(96, 72), **options).linear, plain.linear)
        with self.assertRaisesRegex(stratum.UsageError, "filament_colors"):
            stratum.render(read, color=["red", "blue"])

    def test_toolpath_in_memory(self):
        path = gcode("hull.gcode")
        toolpath = stratum.read(path)
        options = {"size": (64, 48), "spp": 2, "voxel_size": 0.2}
        np.testing.assert_array_equal(stratum.render(toolpath, **options).linear, stratum.render(path, **options).linear)
        half = toolpath.replace(beads=toolpath.beads[:len(toolpath) // 2])
        self.assertFalse(np.array_equal(stratum.render(half, **options).linear, stratum.render(path, **options).linear))

    def test_layers_and_exr(self):
        picture = stratum.render(gcode("tile.gcode"), size=(64, 48), spp=2, denoise=False, aov=["normal", "depth"])
        self.assertEqual({name: layer.shape for name, layer in picture.layers.items()},
                         {"normal": (48, 64, 3), "depth": (48, 64)})
        self.assertGreater(picture.layers["depth"].max(), 10)
        picture.write(path_of("ours.exr"))
        tool("vdbtrace", gcode("tile.gcode"), "-o", path_of("theirs.exr"), "--quiet", "--size", "64x48", "--spp", "2", "--aov",
             "normal,depth")
        self.assertEqual(read_bytes(path_of("ours.exr")), read_bytes(path_of("theirs.exr")))

    def test_views_keep_the_picture(self):
        picture = stratum.render(gcode("tile.gcode"), size=(32, 24), spp=1)
        linear, alpha = picture.linear, picture.alpha
        self.assertTrue(np.shares_memory(linear, picture.linear))
        self.assertFalse(linear.flags.writeable)
        self.assertEqual(alpha.shape, (24, 32))
        copy = linear.copy()
        del picture
        np.testing.assert_array_equal(linear, copy)

    def test_camera(self):
        camera = stratum.render(gcode("tile.gcode"), size=(32, 24), spp=1, eye=(0, -50, 20), look_at=(0, 0, 20)).camera
        np.testing.assert_allclose(camera["eye"], (0, -50, 20))
        np.testing.assert_allclose(camera["forward"], (0, 1, 0), atol=1e-12)

    def test_errors(self):
        path = gcode("tile.gcode")
        for options, text in (({"size": (0, 10)}, ""), ({"spp": 0}, "spp"), ({"view": "above"}, "iso"),
                              ({"color": "blu", "brdf": "pla-blue"}, "give one"), ({"color": "bluu"}, "CSS"),
                              ({"color": "blue", "color_by": "layer"}, "expected no color_by beside it"),
                              ({"view": "top", "eye": (0, 0, 9)}, "expected no eye beside it"),
                              ({"env": "/nowhere.hdr"}, "nowhere"), ({"eye": (0, 0, float("inf"))}, "finite"),
                              ({"march": "sphere"}, "gcode2vdb"), ({"integrator": "pathh"}, "path")):
            with self.assertRaisesRegex((stratum.UsageError, stratum.InputError), text):
                stratum.render(path, **options)
        for options, text in (({"size": 10}, "the width and the height"), ({"eye": (0, 0)}, "three numbers"), ({"sp": 3}, "spp"),
                              ({"bed": 1}, "True or False")):
            with self.assertRaisesRegex(TypeError, text):
                stratum.render(path, **options)
        with self.assertRaisesRegex(stratum.UsageError, ".png"):
            stratum.render(path, size=(16, 12), spp=1).write(path_of("picture.bmp"))
        with self.assertRaises(stratum.OutputError):
            stratum.render(path, size=(16, 12), spp=1).write("/nowhere/picture.png")
        with self.assertRaisesRegex(TypeError, "LevelSet.write"):
            stratum.render(3)

    def test_options_without_effect_are_refused(self):
        toolpath = stratum.read(gcode("tile.gcode"))
        for options in ({"flow": 50}, {"beads": "settled"}, {"section": "50%"}, {"printer": "typical"}):
            with self.assertRaisesRegex(stratum.UsageError, f"{next(iter(options))}: .*read\\(\\) takes them"):
                stratum.render(toolpath, **options)
        level_set = path_of("made.vdb")
        stratum.voxelize(toolpath, voxel_size=0.4).write(level_set)
        for options in ({"printed": "20%"}, {"layers": "1:3"}, {"flow": 50}, {"voxel_size": 2}):
            with self.assertRaisesRegex(stratum.UsageError, f"{next(iter(options))}: .*made.vdb is a level set"):
                stratum.render(level_set, **options)


if __name__ == "__main__":
    unittest.main()

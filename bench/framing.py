#!/usr/bin/env python3
"""How parts lie in their default pictures: which share of the frame's limiting side they fill, whether one is cut, how far off centre.

    bench/framing.py BIN PRINT... [--view NAME]

Draws the mask of each print's part alone with the default camera of a picture of 640 x 480. Skirts, towers and custom G-code are
left out where tags name them; a skirt without a tag is in the mask, and may be cut. Prints a row for each print and the summary.
Needs numpy and Pillow.
"""

import argparse
import os
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("bin")
arguments.add_argument("prints", nargs="+")
arguments.add_argument("--view", default="iso")
given = arguments.parse_args()

fills, cut, off = [], 0, []
with tempfile.TemporaryDirectory() as folder:
    picture = os.path.join(folder, "mask.png")
    for path in given.prints:
        done = subprocess.run(
            [os.path.join(given.bin, "vdbtrace"), path, "--integrator", "mask", "--no-bed", "--size", "640x480", "--spp", "1", "--quiet", "--force",
             "--features", "-skirt,-wipe-tower,-custom", "--view", given.view, "-o", picture], capture_output=True, text=True)
        name = os.path.basename(path)
        if done.returncode:
            print(f"{name}: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
            continue
        mask = np.asarray(Image.open(picture).convert("L")) > 127
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        if not len(rows):
            print(f"{name}: nothing is drawn", file=sys.stderr)
            continue
        height, width = mask.shape
        x0, x1, y0, y1 = columns[0], columns[-1] + 1, rows[0], rows[-1] + 1
        fill = max((x1 - x0) / width, (y1 - y0) / height)
        edge = x0 == 0 or y0 == 0 or x1 == width or y1 == height
        shift = max(abs((x0 + x1) / 2 / width - 0.5), abs((y0 + y1) / 2 / height - 0.5))
        fills.append(fill)
        off.append(shift)
        cut += edge
        print(f"| {name} | {fill:.3f} | {shift:.3f} | {'cut' if edge else ''} |")
within = sum(0.80 <= fill <= 0.92 for fill in fills)
print(f"{len(fills)} prints: {within} fill 80 to 92 %, least {min(fills):.3f}, median {np.median(fills):.3f}, most {max(fills):.3f}; "
      f"{cut} cut; off centre {np.median(off):.3f} (median), {max(off):.3f} (most)")

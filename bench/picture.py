#!/usr/bin/env python3
"""Whole processes, from a cold start to a picture: straight from G-code, and by way of a level set's file.

    bench/picture.py BIN PRINT... [--voxel-size MM,...] [--runs N]

For each print and voxel size, in turns: `vdbtrace print.gcode`, and `gcode2vdb --interior cull` with `vdbtrace` of what it
wrote. Pictures of 1280 x 960: ambient occlusion at 1 and 32 samples, paths under the sky at 32. Medians of wall and CPU time;
the pixels of both ways are compared, too. Prints rows of a Markdown table.
"""

import argparse
import json
import os
import resource
import statistics
import subprocess
import tempfile
import time

PICTURES = {
    "ao 1": ["--integrator", "ao", "--spp", "1"],
    "ao 32": ["--integrator", "ao", "--spp", "32"],
    "path 32": ["--integrator", "path", "--env", "sky", "--spp", "32"],
}


def timed(*command):
    """Seconds on the clock and of all CPUs."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def pixels(path):
    """The compressed pixels of a PNG: its IDAT chunks; metadata left out."""
    with open(path, "rb") as file:
        data = file.read()
    place, out = 8, b""
    while place < len(data):
        length = int.from_bytes(data[place : place + 4], "big")
        if data[place + 4 : place + 8] == b"IDAT":
            out += data[place + 8 : place + 8 + length]
        place += 12 + length
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin", help="folder of the tools")
    parser.add_argument("prints", nargs="+", metavar="PRINT")
    parser.add_argument("--voxel-size", default="0.1,0.05", help="mm, several with commas")
    parser.add_argument("--pictures", default=",".join(PICTURES), help="which, with commas")
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    gcode2vdb, vdbtrace = (os.path.join(options.bin, tool) for tool in ("gcode2vdb", "vdbtrace"))
    print("| print | voxel | picture | from G-code s (CPU) | by a level set s (CPU) | ratio (CPU) | bricks made of listed | bytes"
          " of bricks, of the culled grid's |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="stratum_picture_") as folder:
        def path(name):
            return os.path.join(folder, name)

        for print_path in options.prints:
            for voxel in options.voxel_size.split(","):
                for name in options.pictures.split(","):
                    late, eager = [], []
                    for _ in range(options.runs):
                        late.append(timed(vdbtrace, print_path, "--voxel-size", voxel, *PICTURES[name], "-o", path("late.png"),
                                          "--quiet", "--stats", path("late.json")))
                        first = timed(gcode2vdb, print_path, "--voxel-size", voxel, "--interior", "cull", "-o", path("e.vdb"),
                                      "--quiet", "--stats", path("eager.json"))
                        second = timed(vdbtrace, path("e.vdb"), *PICTURES[name], "-o", path("eager.png"), "--quiet")
                        eager.append((first[0] + second[0], first[1] + second[1]))
                    if pixels(path("late.png")) != pixels(path("eager.png")):
                        raise SystemExit(f"{print_path} at {voxel} mm, {name}: the pictures differ")
                    with open(path("late.json"), encoding="utf-8") as file:
                        took = json.load(file)["on_demand"][0]
                    with open(path("eager.json"), encoding="utf-8") as file:
                        leaves = json.load(file)["grid"]["leaves"]
                    wall = [statistics.median(run[0] for run in way) for way in (late, eager)]
                    cpu = [statistics.median(run[1] for run in way) for way in (late, eager)]
                    # Bricks hold 9^3 samples of 16 bits; the file has a leaf where a brick may be.
                    share = took["bricks_made"] / leaves
                    print(f"| {os.path.basename(print_path)} | {voxel} mm | {name} | {wall[0]:.2f} ({cpu[0]:.2f}) | "
                          f"{wall[1]:.2f} ({cpu[1]:.2f}) | {wall[0] / wall[1]:.2f} ({cpu[0] / cpu[1]:.2f}) | "
                          f"{took['bricks_made']} of {took['bricks_listed']} | {took['bricks_made'] * 1458e-9:.2f} GB, {share:.2f} |",
                          flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""What the effects of docs/deposit.md cost: time from the bytes to the grid, and to a first picture.

    bench/deposit_cost.py BIN_FOLDER FILE.gcode... [--runs N] [--voxel-size MM]

Runs gcode2vdb and vdbtrace in turns with each set of options, and prints a Markdown table of the medians and of the ratios
to capsules in the same turn, with their least and largest. The picture is of 640 x 480 pixels and one sample, straight from
G-code; its time is that of the whole process.
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile
import time

MODELS = {
    "capsule": [],
    "settled": ["--beads", "settled"],
    "flow": ["--flow-lag", "0.015", "--pressure-advance", "0"],
    "typical": ["--printer", "typical"],
}


def grid(options, file, model, folder):
    """Seconds of parsing and of voxelizing, cm^3 fed, beads."""
    report = os.path.join(folder, "stats.json")
    subprocess.run([os.path.join(options.bin, "gcode2vdb"), file, *MODELS[model], "--quiet", "--voxel-size",
                    str(options.voxel_size), "-o", os.path.join(folder, "part.vdb"), "--stats", report], check=True)
    with open(report, encoding="utf-8") as stream:
        stats = json.load(stream)
    seconds = stats["seconds"]
    return seconds["parse"], seconds["voxelize"], stats["toolpath"]["volume_mm3"] * 1e-3, stats["toolpath"]["beads"]


def picture(options, file, model, folder):
    start = time.perf_counter()
    subprocess.run([os.path.join(options.bin, "vdbtrace"), file, *MODELS[model], "--quiet", "--voxel-size",
                    str(options.voxel_size), "--size", "640x480", "--spp", "1", "-o", os.path.join(folder, "part.png")],
                   check=True)
    return time.perf_counter() - start


def ratio(values, base):
    ratios = [value / other for value, other in zip(values, base)]
    return f"{statistics.median(ratios):.2f} ({min(ratios):.2f}..{max(ratios):.2f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--voxel-size", type=float, default=0.1, help="mm")
    options = parser.parse_args()
    print(f"voxels of {options.voxel_size} mm, {options.runs} runs in turns\n")
    print("| print | beads are | beads | parse s | grid s | of capsules | picture s | of capsules |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory(prefix="stratum_cost_") as folder:
        for file in options.files:
            runs = {model: [] for model in MODELS}
            for _ in range(options.runs):
                for model, rows in runs.items():
                    rows.append((*grid(options, file, model, folder), picture(options, file, model, folder)))
            name = f"{os.path.basename(file)}, {runs['capsule'][0][2]:.0f} cm³"
            base = list(zip(*runs["capsule"]))
            for model, rows in runs.items():
                parse, voxelize, _, beads, seen = zip(*rows)
                print(f"| {name} | {model} | {beads[0]} | {statistics.median(parse):.3f} | {statistics.median(voxelize):.3f} "
                      f"| {ratio(voxelize, base[1])} | {statistics.median(seen):.2f} | {ratio(seen, base[4])} |", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""What the effects of docs/deposit.md cost: time from the bytes to the level set's file, and to pictures.

    bench/deposit_cost.py BIN_FOLDER FILE.gcode... [--runs N] [--voxel-size MM] [--folder DIR]

Runs gcode2vdb and vdbtrace in turns with each set of options, and prints a Markdown table of the medians and of the ratios
to capsules in the same turn, with their least and largest. The first look is of 640 x 480 pixels and one sample, straight from
G-code; the picture has no option but the model. Times are those of whole processes; reading is the part of the first look's
before its first ray's preparations. Files go to DIR: /dev/shm leaves the disk out.
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
    "typical": ["--printer", "typical"],
}


def run(command):
    start = time.perf_counter()
    subprocess.run(command, check=True)
    return time.perf_counter() - start


def file(options, print_file, model, folder):
    """Seconds to the level set's file."""
    return run([os.path.join(options.bin, "gcode2vdb"), print_file, *MODELS[model], "--quiet", "--voxel-size",
                str(options.voxel_size), "-o", os.path.join(folder, "part.vdb")])


def first_look(options, print_file, model, folder):
    """Seconds to a first look, seconds of reading, beads."""
    report = os.path.join(folder, "stats.json")
    seconds = run([os.path.join(options.bin, "vdbtrace"), print_file, *MODELS[model], "--quiet", "--voxel-size",
                   str(options.voxel_size), "--size", "640x480", "--spp", "1", "-o", os.path.join(folder, "part.png"),
                   "--stats", report])
    with open(report, encoding="utf-8") as stream:
        stats = json.load(stream)
    return seconds, stats["seconds"]["load"], stats["input"]["beads"]


def picture(options, print_file, model, folder):
    """Seconds to the picture that vdbtrace makes by default."""
    return run([os.path.join(options.bin, "vdbtrace"), print_file, *MODELS[model], "--quiet", "-o",
                os.path.join(folder, "part.png")])


def ratio(values, base):
    ratios = [value / other for value, other in zip(values, base)]
    return f"{statistics.median(ratios):.2f} ({min(ratios):.2f}..{max(ratios):.2f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--voxel-size", type=float, default=0.1, help="mm")
    parser.add_argument("--folder", help="for what is written")
    options = parser.parse_args()
    print(f"voxels of {options.voxel_size} mm, {options.runs} runs in turns\n")
    print("| print | beads are | beads | reading s | file s | of capsules | first look s | of capsules "
          "| picture s | of capsules |")
    print("|---|---|---|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory(prefix="stratum_cost_", dir=options.folder) as folder:
        for print_file in options.files:
            runs = {model: [] for model in MODELS}
            for _ in range(options.runs):
                for model, rows in runs.items():
                    rows.append((file(options, print_file, model, folder), *first_look(options, print_file, model, folder),
                                 picture(options, print_file, model, folder)))
            name = os.path.basename(print_file).removesuffix(".gcode")
            base = list(zip(*runs["capsule"]))
            for model, rows in runs.items():
                files, looks, reading, beads, pictures = zip(*rows)
                print(f"| {name} | {model} | {beads[0]} | {statistics.median(reading):.3f} | {statistics.median(files):.2f} "
                      f"| {ratio(files, base[0])} | {statistics.median(looks):.2f} | {ratio(looks, base[1])} "
                      f"| {statistics.median(pictures):.2f} | {ratio(pictures, base[4])} |", flush=True)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Memory and time of kept and culled grids for the twelve models of the corpus, as a table for docs/benchmarks.md.

    bench/models.py BIN_FOLDER CORPUS_FOLDER SCRATCH_FOLDER

Slices each model with the real prusa-slicer (0.2 mm layers, 15 % grid infill, its built-in settings) at the scale of its
class, once, into the scratch folder, and runs bench_exterior at 0.2, 0.1 and 0.05 mm.
"""
import gzip
import pathlib
import re
import subprocess
import sys

CLASSES = {
    1.0: ["3DBenchy", "gearwheel", "candleStand", "turned_example007"],
    2.15443: ["fox", "bottle_fuze", "CSG", "bob_small"],
    4.64159: ["quadknot", "tower_example005", "spot", "roundbox_example006"],
}
SIZES = {1.0: 10, 2.15443: 100, 4.64159: 1000}


def sliced(model, scale, corpus, scratch):
    out = scratch / f"{model}.gcode"
    if out.exists():
        return out
    stl = corpus / "models" / f"{model}.stl"
    if not stl.exists():
        stl = scratch / f"{model}.stl"
        stl.write_bytes(gzip.decompress((corpus / "models" / f"{model}.stl.gz").read_bytes()))
    subprocess.run(["prusa-slicer", "--export-gcode", "--layer-height", "0.2", "--first-layer-height", "0.2",
                    "--fill-density", "15%", "--fill-pattern", "grid", "--bed-shape", "0x0,600x0,600x600,0x600",
                    "--max-print-height", "900", "--center", "300,300", "--scale", str(scale), str(stl),
                    "-o", str(out)], check=True, capture_output=True)
    return out


def main():
    binaries, corpus, scratch = map(pathlib.Path, sys.argv[1:4])
    print("| model | cm³ | voxel mm | active, M, keep | cull | leaves, k, keep | cull | peak GB, keep | cull | s, keep | cull |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for scale, models in CLASSES.items():
        for model in models:
            gcode = sliced(model, scale, corpus, scratch)
            for voxel in (0.2, 0.1, 0.05):
                found = {}
                for mode in ("cull", "keep"):
                    # A process each: the peak is its own.
                    extra = ["--no-keep"] if mode == "cull" else ["--no-cull", "--no-peer"]
                    run = subprocess.run([binaries / "bench_exterior", gcode, "--voxel-size", str(voxel), *extra],
                                         capture_output=True, text=True)
                    text = run.stdout
                    if run.returncode != 0:
                        # Refused: more than the machine has.
                        print(run.stderr, file=sys.stderr)
                        continue
                    found[mode] = re.search(mode + r": ([\d.]+) s .*?, ([\d.]+) M active, (\d+) k leaves .* peak ([\d.]+) GB",
                                            text).groups()
                cell = lambda mode, n: found[mode][n] if mode in found else "–"
                print(f"| {model} | {SIZES[scale]} | {voxel} | " + " | ".join(
                    cell(mode, n) for n in (1, 2, 3, 0) for mode in ("keep", "cull")) + " |", flush=True)


main()

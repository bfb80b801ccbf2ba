#!/usr/bin/env python3
"""Writes the tables of README.md from the studies' CSV files.

    scripts/readme_tables.py STUDIES_FOLDER README.md [--check]

Each table stands between <!-- NAME.csv --> and <!-- /NAME.csv -->. --check writes nothing and fails if the file would change.
"""
import csv
import pathlib
import re
import statistics
import sys


def rows(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def millions(text):
    value = float(text) / 1e6
    return f"{value:.0f} M" if value >= 100 else f"{value:.1f} M"


def table(header, lines):
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [header, ["---"] * len(header), *lines])


def memory(folder):
    lines = []
    for row in rows(folder / "memory.csv"):
        if row["status"] != "ok" or row["voxels_per_layer"] not in ("2", "4") or row["interior"] not in ("keep", "cull"):
            continue
        lines.append([row["print"], f"{float(row['part_mm3']) / 1000:.1f}", f"{float(row['voxel_mm']):g}", row["interior"],
                      millions(row["active_voxels"]), f"{float(row['voxelize_seconds']):.2f} s",
                      f"{float(row['write_seconds']):.2f} s", f"{float(row['float_file_bytes']) / 1e6:.0f} MB",
                      f"{float(row['peak_rss_bytes']) / 1e9:.2f} GB"])
    return table(["print", "cm³", "voxel mm", "interior", "active voxels", "voxelize", "write", "file", "peak memory"], lines)


SHOWN = {
    "brick": "path, `--march brick`",
    "sphere": "path, `--march sphere`",
    "vdb": "path, `--march vdb`",
    "denoised": "path, brick, `--denoise`",
    "direct": "direct light alone, brick",
}


def render(folder):
    groups = {}
    for row in rows(folder / "render.csv"):
        groups.setdefault((row["variant"], int(row["spp"])), []).append(row)
    most = max(spp for name, spp in groups if name == "brick")
    lines = []
    for variant, name in SHOWN.items():
        group = groups.get((variant, most))
        if not group:
            continue
        cpu = statistics.median(float(r["cpu_seconds"]) for r in group)
        rays = statistics.median(float(r["rays"]) for r in group)
        error = statistics.mean(float(r["rel_mse"]) for r in group)
        spread = statistics.stdev(float(r["rel_mse"]) for r in group) if len(group) > 1 else 0
        flip = statistics.mean(float(r["flip"]) for r in group)
        lines.append([name, str(most), f"{cpu:.2f} s", f"{rays / cpu / 1e6:.2f} M", f"{error:.2e} ± {spread:.0e}",
                      f"{flip:.3f}"])
    return table(["picture", "samples a pixel", "CPU time", "rays a CPU second", "relMSE", "FLIP"], lines)


def main():
    folder, readme = map(pathlib.Path, sys.argv[1:3])
    old = text = readme.read_text(encoding="utf-8")
    for name, make in (("memory", memory), ("render", render)):
        pattern = re.compile(rf"(<!-- {name}\.csv -->\n).*?(<!-- /{name}\.csv -->)", re.S)
        if not pattern.search(text):
            sys.exit(f"{readme}: has no place for {name}.csv")
        text = pattern.sub(lambda m: m.group(1) + "\n" + make(folder) + "\n\n" + m.group(2), text)
    if "--check" in sys.argv:
        sys.exit(0 if text == old else f"{readme}: its tables are not those of {folder}; run scripts/readme_tables.py")
    readme.write_text(text, encoding="utf-8")


main()

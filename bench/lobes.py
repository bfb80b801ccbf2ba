#!/usr/bin/env python3
"""Draws what bench_lobes writes: reflectance in the plane of incidence, on a logarithmic scale.

    build/release/bin/bench_lobes FILE.bsdf.gz... pla-blue silk-pink | python3 bench/lobes.py lobes.png
"""
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

MEASURED = {0: "#4477aa", 20: "#228833", 40: "#ccaa22", 60: "#ee6677"}
BETWEEN = (30, 50, 75)

rows = list(csv.DictReader(sys.stdin))
names = list(dict.fromkeys(row["material"] for row in rows))
across = min(3, len(names))
down = -(-len(names) // across)
figure, axes = plt.subplots(down, across, figsize=(4.3 * across, 3.2 * down), squeeze=False, sharex=True)
for axis in axes.flat[len(names):]:
    axis.set_axis_off()
for axis, name in zip(axes.flat, names):
    def curve(what, light):
        chosen = [row for row in rows if (row["material"], row["what"]) == (name, what) and float(row["light_degrees"]) == light]
        values = [0.2126 * float(row["r"]) + 0.7152 * float(row["g"]) + 0.0722 * float(row["b"]) for row in chosen]
        return [float(row["detector_degrees"]) for row in chosen], values

    for light in BETWEEN:
        axis.plot(*curve("table", light), color="#999999", lw=0.9, ls="--")
    for light, color in MEASURED.items():
        axis.plot(*curve("table", light), color=color, lw=1.3)
        axis.plot(*curve("reading", light), color=color, ls="", marker="o", ms=2.6)
        axis.axvline(light, color=color, lw=0.5, alpha=0.5)
    axis.set_yscale("log")
    axis.set_title(name, fontsize=10)
    axis.set_xlim(-90, 90)
    axis.set_xticks(range(-90, 91, 30))
    axis.grid(alpha=0.25)
for axis in axes[-1]:
    axis.set_xlabel("detector, degrees from the normal")
for axis in axes[:, 0]:
    axis.set_ylabel("f, 1/sr")
handles = [plt.Line2D([], [], color=color, label=f"light at {light}°") for light, color in MEASURED.items()]
handles += [plt.Line2D([], [], color="#999999", ls="--", lw=0.9, label="at " + ", ".join(f"{x}°" for x in BETWEEN)),
            plt.Line2D([], [], color="#555555", ls="", marker="o", ms=3, label="readings")]
figure.legend(handles=handles, loc="upper center", ncol=6, fontsize=9, frameon=False)
figure.tight_layout(rect=(0, 0, 1, 0.95))
figure.savefig(sys.argv[1], dpi=110)

"""Error against time a ray, from the files that bench_march --json wrote.

  /usr/bin/python3 bench/march_plot.py OUT.png TITLE=FILE.json ...

Needs python3-matplotlib. Error is the mean distance along a primary ray from the exact hit, in voxels, where both hit;
the exact intersectors stand on the bound that the tests hold them to.
"""

import json
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

EXACT = 1e-4  # voxel: what the long tests check against a brute-force march in double precision
MARKERS = "o*s^DdPv<>"

out, *inputs = sys.argv[1:]
names = {}
figure, axes = plt.subplots(1, len(inputs), figsize=(5.2 * len(inputs), 4.6), sharey=True, squeeze=False)
for axis, argument in zip(axes[0], inputs):
    title, path = argument.split("=", 1)
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    primary = report["sets"]["primary"]
    for name, row in ((n, r) for n, r in primary.items() if n != "rays"):
        error = max(row["mean_error_voxels"], EXACT)
        x = 1e3 / row["mrays_per_second"]
        index = names.setdefault(name, len(names))
        axis.errorbar(x, error, xerr=[[x - 1e3 / row["most"]], [1e3 / row["least"] - x]], marker=MARKERS[index % len(MARKERS)],
                      color=f"C{(index + 3 * (index // len(MARKERS))) % 10}", ms=8, capsize=2, ls="none", alpha=0.85, label=name)
    axis.axhline(EXACT, color="tab:red", lw=0.6, ls=":")
    axis.set_xscale("log")
    axis.set_xticks([10, 20, 50, 100, 200, 500], ["10", "20", "50", "100", "200", "500"])
    axis.set_xticks([], minor=True)
    axis.margins(x=0.08)
    axis.set_yscale("log")
    axis.set_xlabel("ns a primary ray, 2 threads")
    axis.set_title(f"{title}\n{report['active_voxels'] / 1e6:.0f} M active voxels", fontsize=10)
    axis.grid(True, which="both", lw=0.3)
axes[0][0].set_ylabel("mean error of the hit, voxels (exact: bound of the tests)")
handles, labels = axes[0][0].get_legend_handles_labels()
figure.legend(handles, labels, loc="center right", fontsize=9)
figure.tight_layout(rect=(0, 0, 1 - 2.0 / figure.get_figwidth(), 1))
figure.savefig(out, dpi=110)

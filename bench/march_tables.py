"""The tables of docs/benchmarks.md, "Rays", from the files that bench_march --json wrote.

  python3 bench/march_tables.py TITLE=FILE.json ...

A table of all peers for each print, one of all prints, and the ratios of the table at a glance. Other answers are hits
that the exact intersector does not have, and those that it has and the peer has not.
"""

import json
import sys


def rate(row):
    return f"{row['mrays_per_second']:.2f} ({row['least']:.2f}–{row['most']:.2f})"


def per_million(row, rays):
    return [round(1e6 * row[kind] / rays) for kind in ("missed", "extra")]


def all_peers(report):
    sets = report["sets"]
    print("| | " + " | ".join(sets) + " |\n|---" + "|---" * len(sets) + "|")
    for peer in report["peers"]:
        cells = []
        for rays in sets.values():
            missed, extra = per_million(rays[peer], rays["rays"])
            cells.append(rate(rays[peer]) + (f"; {missed} + {extra}" if missed or extra else ""))
        print(f"| {peer} | " + " | ".join(cells) + " |")


def fastest(rays, start):
    return max((peer for peer in rays if peer.startswith(start)), key=lambda peer: rays[peer]["mrays_per_second"])


def ratio(rays, peer):
    return rays["brick"]["mrays_per_second"] / rays[peer]["mrays_per_second"]


def in_short(reports):
    print("| print | rays | brick | OpenVDB | Embree's best, its other answers | Embree's beads, their other answers | "
          "times OpenVDB | times Embree's best | times its beads | scalar, times OpenVDB |")
    print("|---" * 10 + "|")
    for title, report in reports:
        for name, rays in report["sets"].items():
            best, beads = fastest(rays, "embree"), fastest(rays, "embree beads")
            other = {peer: sum(per_million(rays[peer], rays["rays"])) / 1e4 for peer in (best, beads)}
            scalar = rays["brick scalar"]["mrays_per_second"] / rays["vdb"]["mrays_per_second"]
            print(f"| {title} | {name} | {rate(rays['brick'])} | {rays['vdb']['mrays_per_second']:.2f} | "
                  f"{rays[best]['mrays_per_second']:.2f} ({best.removeprefix('embree ')}), {other[best]:.2f} % | "
                  f"{rays[beads]['mrays_per_second']:.2f}, {other[beads]:.2f} % | {ratio(rays, 'vdb'):.2f} | "
                  f"{ratio(rays, best):.2f} | {ratio(rays, beads):.2f} | {scalar:.2f} |")


def at_a_glance(reports):
    for kind in ("primary", "AO", "mirror"):
        cells = []
        for title, report in reports:
            sets = [rays for name, rays in report["sets"].items() if name.startswith(kind)]
            spans = []
            for start in ("embree beads", "embree"):
                found = sorted(f"{ratio(rays, fastest(rays, start)):.2f}" for rays in sets)
                spans.append(found[0] if len(found) == 1 else f"{found[0]} to {found[-1]}")
            cells.append(f"{title.split(',')[0]} {'; '.join(spans)}")
        print(f"{kind}: {', '.join(cells)}")


def main():
    reports = []
    for argument in sys.argv[1:]:
        title, path = argument.split("=", 1)
        with open(path, encoding="utf-8") as file:
            reports.append((title, json.load(file)))
    for title, report in reports:
        print(f"**{title}**: {report['active_voxels'] / 1e6:.0f} M active voxels. Mrays/s on 2 threads (least–most of 3 rounds); "
              "then missed + extra answers of a million.\n")
        all_peers(report)
        print()
    in_short(reports)
    print()
    at_a_glance(reports)


main()

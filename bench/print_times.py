"""print_times.py GCODE2VDB FILE... -- planned print times beside those that the files state, as a table.

Runs the tool on each file with --stats and a coarse voxel, and prints file, rule, stated, planned and difference.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile


def clock(seconds):
    seconds = round(seconds)
    return f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"


def main():
    tool, *files = sys.argv[1:]
    print("| file | rule | stated | planned | difference |\n|---|---|---|---|---|")
    shares = []
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            stats = os.path.join(folder, "stats.json")
            run = subprocess.run([tool, file, "-o", os.path.join(folder, "part.vdb"), "--layers", "1:2", "--voxel-size",
                                  "2", "--stats", stats, "--quiet"], capture_output=True, text=True, check=False)
            if run.returncode != 0:
                sys.exit(run.stderr)
            with open(stats, encoding="utf-8") as report:
                time = json.load(report)["time"]
            planned, stated = time["planned_of_stated_s"] or time["planned_s"], time["stated_s"]
            share = (planned - stated) / stated if stated else None
            name = os.path.basename(file)
            if share is not None:
                shares.append(abs(share))
            print(f"| {name} | {time['rule_of_stated'] or time['rule']} | {clock(stated) if stated else '–'} | {clock(planned)} | "
                  f"{f'{100 * share:+.2f} %' if share is not None else '–'} |")
    if shares:
        print(f"\nMedian of the sizes {100 * statistics.median(shares):.2f} %, largest {100 * max(shares):.2f} %.")


main()

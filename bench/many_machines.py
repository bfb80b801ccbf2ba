"""What shards cost, and a model of the time on many nodes: the table and the plot of docs/many_machines.md.

  /usr/bin/python3 bench/many_machines.py measure OUT.json --bin build/release/bin [--turns 3] CASE ...
  /usr/bin/python3 bench/many_machines.py table FILE.json ...
  /usr/bin/python3 bench/many_machines.py plot OUT.svg FILE.json ...        (needs python3-matplotlib)

A CASE is NAME=KIND:SHARDS:COMMAND, e.g. "picture=picture:2,16:hull.gcode --size 1280x960", of a KIND
  picture  vdbtrace COMMAND -o w.png, shards, vdbmerge
  film     vdbtrace COMMAND -o w.png, which must make a series; nothing is merged
Each turn runs one process, then all shards of each number and their merge, compares the results, and runs a shard that
has (almost) nothing to do. Times are those of the processor, user and system, with --threads 1: what a node of one core
takes, whatever else this machine does.

The model: n nodes take  again + longest * work / n + merge.  `again` is what each shard does anew: it starts, loads,
and makes bricks that another one makes too. `longest` is the longest share of the work by the mean one. All are those of
the largest number of shards that was measured; up to that number `longest` grows from 1 with the logarithm of n. More
nodes than pieces (tiles, pictures) are of no use.
"""

import argparse
import datetime
import glob
import json
import math
import os
import platform
import shlex
import statistics
import subprocess
import tempfile

NODES = (1, 2, 10, 100, 1000)
TILE = 32  # pixels: shade/integrator/tile.h


def seconds(command):
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{shlex.join(command)}: status {status}")
    return usage.ru_utime + usage.ru_stime


def same_files(ones, others):
    return [open(a, "rb").read() for a in sorted(ones)] == [open(b, "rb").read() for b in sorted(others)]


def remove(*patterns):
    for pattern in patterns:
        for name in glob.glob(pattern):
            os.remove(name)


def same_file(one, other):
    return subprocess.run(["cmp", "-s", one, other]).returncode == 0


def measure_case(binaries, name, kind, counts, options, turns):
    tool = os.path.join(binaries, "vdbtrace")
    merge = os.path.join(binaries, "vdbmerge")
    base = [tool, *options, "--threads", "1", "--quiet"]
    nothing = ["--crop", "0,0,1,1", "--no-denoise"]
    case = {"name": name, "kind": kind, "command": shlex.join([os.path.basename(tool), *map(os.path.basename, options)]),
            "one": [], "start": [], "shards": {str(count): [] for count in counts}}
    for _ in range(turns):
        case["one"].append(seconds([*base, "-o", "w.png"]))
        if kind != "film":
            case["start"].append(seconds([*base, "-o", "e.png", *nothing]))
        for count in counts:
            each = [seconds([*base, "-o", "p.png", "--shard", f"{n}/{count}"]) for n in range(count)]
            joined = 0.0
            if kind == "film":
                same = same_files(glob.glob("w_*.png"), glob.glob("p_*.png"))
            else:
                joined = seconds([merge, "m.png", *glob.glob(f"p.*of{count}.exr"), "--quiet", "--threads", "1"])
                same = same_file("m.png", "w.png")
            if not same:
                raise SystemExit(f"{name}: {count} shards: other bytes than one process")
            case["shards"][str(count)].append({"each": each, "merge": joined})
            remove("p*.exr", "m.png")
            remove("p_*.png")
        if kind == "film":
            case["pieces"] = len(glob.glob("w_*.png"))
        remove("w*", "e*")
    if kind != "film":
        case["pieces"] = pieces_of(options)
    return case


def pieces_of(options):
    width, height = map(int, options[options.index("--size") + 1].split("x"))
    return -(-width // TILE) * -(-height // TILE)


def measure(arguments):
    cases = []
    binaries = os.path.abspath(arguments.bin)
    output = os.path.abspath(arguments.out)
    texts = []
    for text in arguments.case:
        name, rest = text.split("=", 1)
        kind, counts, command = rest.split(":", 2)
        options = shlex.split(command)
        options = [os.path.abspath(option) if os.path.exists(option) else option for option in options]
        texts.append((name, kind, [int(count) for count in counts.split(",")], options))
    with tempfile.TemporaryDirectory(prefix="many_machines_", dir=arguments.scratch) as folder:
        os.chdir(folder)
        for name, kind, counts, options in texts:
            cases.append(measure_case(binaries, name, kind, counts, options, arguments.turns))
            print(table([cases[-1]]), flush=True)
    report = {"date": datetime.date.today().isoformat(), "machine": machine(), "turns": arguments.turns, "cases": cases}
    with open(output, "w", encoding="utf-8") as file:
        json.dump(report, file, indent=1)


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        model = next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), platform.machine())
    return f"{model}, {os.cpu_count()} cores"


def parts_of(case):
    """The parts of the model, seconds, from medians of the turns."""
    one = statistics.median(case["one"])
    count = max(map(int, case["shards"]))
    runs = case["shards"][str(count)]
    merge = statistics.median(run["merge"] for run in runs)
    start = statistics.median(case["start"]) if case["start"] else None
    all_shards = statistics.median(sum(run["each"]) for run in runs)
    # One process does the denoising itself, which shards leave to the merge.
    end = merge if case["kind"] == "picture" else 0.0
    lasting = one - end
    # all = n again + work, one = again + work
    again = max((all_shards - lasting) / (count - 1), 0.0)
    work = lasting - again
    longest = statistics.median(max(run["each"]) for run in runs)
    return {"one": one, "start": start, "again": again, "work": work, "merge": merge, "count": count,
            "uneven": max((longest - again) * count / work, 1.0)}


def modelled(case, nodes):
    p = parts_of(case)
    if nodes == 1:
        return p["again"] + p["work"] + (p["merge"] if case["kind"] == "picture" else 0.0)
    pieces = min(nodes, case["pieces"])
    uneven = 1 + (p["uneven"] - 1) * min(math.log(pieces) / math.log(p["count"]), 1.0)
    return p["again"] + uneven / pieces * p["work"] + p["merge"]


def spread(values, form="{:.2f}"):
    middle = form.format(statistics.median(values))
    return f"{middle} ({form.format(min(values))}–{form.format(max(values))})"


def table(cases):
    lines = ["| | shards | one process, s | all shards by it | merge by it | longest shard, s | a shard of nothing, s |",
             "|---|---|---|---|---|---|---|"]
    for case in cases:
        for count, runs in case["shards"].items():
            all_by_one = [sum(run["each"]) / one for run, one in zip(runs, case["one"])]
            merge_by_one = [run["merge"] / one for run, one in zip(runs, case["one"])]
            start = f"{statistics.median(case['start']):.2f}" if case["start"] else ""
            lines.append(f"| {case['name']} | {count} | {statistics.median(case['one']):.1f} | {spread(all_by_one)} | "
                         f"{spread(merge_by_one) if case['kind'] != 'film' else ''} | "
                         f"{statistics.median(max(run['each']) for run in runs):.2f} | {start} |")
    return "\n".join(lines)


def model_table(cases):
    lines = ["| | again | work | longest by mean | merge | " + " | ".join(f"{n} nodes" if n > 1 else "1 node" for n in NODES) +
             " | measured: 1 | 2 |", "|---|---|---|---|---|" + "---|" * (len(NODES) + 2)]
    for case in cases:
        p = parts_of(case)
        two = case["shards"].get("2")
        found = f"{statistics.median(max(r['each']) + r['merge'] for r in two):.1f}" if two else ""
        lines.append(f"| {case['name']} | {p['again']:.2f} | {p['work']:.1f} | {p['uneven']:.2f} | {p['merge']:.2f} | " +
                     " | ".join(f"{modelled(case, n):.1f}" for n in NODES) + f" | {p['one']:.1f} | {found} |")
    return "\n".join(lines)


def plot(out, cases):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    matplotlib.rcParams["svg.hashsalt"] = "stratum"
    figure, axis = plt.subplots(figsize=(7.2, 4.6))
    nodes = [1, *(2 * 500 ** (k / 80) for k in range(81))]
    for n, case in enumerate(cases):
        axis.plot(nodes, [modelled(case, x) for x in nodes], color=f"C{n}", label=case["name"])
        found = {1: statistics.median(case["one"])}
        for count, runs in case["shards"].items():
            found[int(count)] = statistics.median(max(run["each"]) + run["merge"] for run in runs)
        axis.plot(list(found), list(found.values()), "o", color=f"C{n}", mfc="white")
    first = max(statistics.median(case["one"]) for case in cases)
    axis.plot([1, 1000], [first, first / 1000], color="0.6", lw=0.8, ls="--", label="without loss")
    axis.set(xscale="log", yscale="log", xlabel="nodes of one core", ylabel="seconds to the merged result", xlim=(0.9, 1100))
    axis.set_ylim(bottom=0.1)
    axis.grid(True, which="both", lw=0.3)
    axis.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(out, metadata={"Date": None} if out.endswith(".svg") else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verb = verbs.add_parser("measure")
    verb.add_argument("out")
    verb.add_argument("case", nargs="+")
    verb.add_argument("--bin", default="build/release/bin")
    verb.add_argument("--turns", type=int, default=3)
    verb.add_argument("--scratch", help="folder for the files, of which the largest is on the disk three times")
    verbs.add_parser("table").add_argument("files", nargs="+")
    verb = verbs.add_parser("plot")
    verb.add_argument("out")
    verb.add_argument("files", nargs="+")
    arguments = parser.parse_args()
    if arguments.verb == "measure":
        measure(arguments)
        return
    cases = []
    for name in arguments.files:
        with open(name, encoding="utf-8") as file:
            cases += json.load(file)["cases"]
    if arguments.verb == "table":
        print(table(cases), model_table(cases), sep="\n\n")
    else:
        plot(arguments.out, cases)


main()

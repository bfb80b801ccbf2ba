#!/usr/bin/env python3
"""A flame graph as text: where the processor time of a command goes, callers above what they call.

    bench/flame.py [--least PERCENT] [--depth N] [--runs N] -- COMMAND...

Samples of all threads by `perf record --call-graph dwarf`, needs Debian's linux-perf. A line is a function, its share of the command's
processor time with all that it calls, and a bar; what has less than --least percent is left out. Frames of threads, of the standard
library and of TBB between two functions are skipped, and functions that do nothing but call one other are, too.
"""
import argparse
import collections
import re
import subprocess
import sys
import tempfile

SKIPPED = re.compile(r"^(_start|__libc_start|main$|clone|start_thread|std::|tbb::|__|operator\(\)|void std|void tbb|\[unknown\]|0x"
                     r"|entry_SYSCALL|do_syscall|asm_|exc_|x64_sys|parallelFor|handle_|ksys_|_dl_start_user|stratum::parallelFor)")


def plain(symbol):
    """A function's name without namespaces, arguments and template arguments."""
    name = symbol
    while True:  # arguments of templates, innermost first
        shorter = re.sub(r"<[^<>]*>", "", name)
        if shorter == name:
            break
        name = shorter
    name = re.sub(r"\(anonymous namespace\)::|\{lambda.*", "", name)
    while True:
        shorter = re.sub(r"\([^()]*\)", "", name)
        if shorter == name:
            break
        name = shorter
    name = name.replace(" const", "").split(" ")[-1].strip(":&*")
    parts = [p for p in name.split("::") if p and p not in ("stratum", "openvdb", "v10_0") and not p.startswith("N_")]
    return "::".join(parts[-2:])


class Node:
    def __init__(self):
        self.weight, self.below = 0, collections.defaultdict(Node)


def add(root, frames, weight):
    node = root
    node.weight += weight
    last = None
    for frame in frames:
        if frame == last:
            continue
        node, last = node.below[frame], frame
        node.weight += weight


def stacks(path):
    """(frames from the outermost to the innermost, weight) of every sample."""
    script = subprocess.Popen(["perf", "script", "-i", path, "-F", "comm,period,ip,sym", "--no-inline"], stdout=subprocess.PIPE, text=True,
                              stderr=subprocess.DEVNULL)
    frames, weight = None, 0
    for line in script.stdout:
        if not line.strip():
            if frames is not None:
                yield frames[::-1], weight
            frames = None
        elif frames is None:
            frames, weight = [], int(re.search(r"(\d+)\s*:?\s*$", line).group(1))
        else:
            frames.append(line.strip().split(" ", 1)[1] if " " in line.strip() else "[unknown]")
    if frames is not None:
        yield frames[::-1], weight
    script.wait()


def named(frames):
    """Names from the outermost in. What a task of all threads does stands by itself, whichever thread began it."""
    task = next((n for n, frame in enumerate(frames) if "tbb::" in frame), -1)
    names = []
    for frame in frames[task + 1:]:
        if re.match(r"asm_exc|entry_SYSCALL|asm_sysvec", frame):
            names.append("(the system: fresh memory)" if "exc_page" in frame else "(the system: calls)")
            break
        if not SKIPPED.match(frame):
            names.append(plain(frame))
    return [name for name in names if name]


def merge(node, other):
    node.weight += other.weight
    for name, child in other.below.items():
        merge(node.below[name], child)


def callees(node):
    """What a function calls, without functions that do nothing but call one other."""
    found = collections.defaultdict(Node)
    for name, child in node.below.items():
        while child.below:
            inner, only = max(child.below.items(), key=lambda item: item[1].weight)
            if only.weight < 0.95 * child.weight:
                break
            name, child = inner, only
        merge(found[name], child)
    return sorted(found.items(), key=lambda item: -item[1].weight)


def show(node, total, least, depth, indent=0):
    for name, child in callees(node):
        share = 100 * child.weight / total
        if share < least:
            break
        print(f"{'  ' * indent + name:<48.48} {share:5.1f} %  {'#' * max(1, round(share / 2))}")
        if depth > 1:
            show(child, total, least, depth - 1, indent + 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--least", type=float, default=2, help="percent (default 2)")
    parser.add_argument("--depth", type=int, default=6, help="calls below each other (default 6)")
    parser.add_argument("--runs", type=int, default=3, help="runs of the command (default 3)")
    parser.add_argument("command", nargs="+")
    options = parser.parse_args()
    root, seconds = Node(), []
    for _ in range(options.runs):
        with tempfile.NamedTemporaryFile(suffix=".data") as data:
            subprocess.run(["perf", "record", "-q", "-F", "997", "-e", "task-clock", "--call-graph", "dwarf,16384", "-o", data.name, "--",
                            *options.command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            before = root.weight
            for frames, weight in stacks(data.name):
                add(root, named(frames), weight)
            seconds.append((root.weight - before) * 1e-9)
    print(f"{sum(seconds) / len(seconds):.2f} s of processor time, the mean of {len(seconds)}")
    show(root, root.weight, options.least, options.depth)
    return 0


if __name__ == "__main__":
    sys.exit(main())

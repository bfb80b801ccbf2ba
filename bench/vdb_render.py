"""Whole processes: OpenVDB's vdb_render against vdbtrace on one .vdb, normals, the same camera, in turns.

    python3 bench/vdb_render.py build/release/bin/vdbtrace part.vdb [--spp 1,4,16] [--runs 3] [--size 1280x960]
"""
import argparse
import itertools
import json
import math
import pathlib
import resource
import statistics
import subprocess
import tempfile
import time

FOV = 28.0  # degrees, vertical
AWAY = (0.5505, -0.7207, 0.4204)  # from the print to the camera, of length 1


def boxOf(vdb):
    """The world-space box of the active voxels, by vdb_print."""
    text = subprocess.run(["vdb_print", "-l", "-m", vdb], check=True, capture_output=True, text=True).stdout
    index = []
    size = None
    for line in text.splitlines():
        if "Bounding box of active voxels" in line:
            index = [json.loads(part) for part in line.split(":", 1)[1].split("->")]
        if "voxel dimensions" in line.lower() or "voxel size" in line.lower():
            size = float(line.split("[" if "[" in line else ":")[1].split(",")[0].strip(" ]"))
    if not index or size is None:
        raise SystemExit(f"vdb_print says no box of {vdb}")
    return [[size * c for c in corner] for corner in index]


def fills(eye, middle, low, high, width, height):
    """Whether all corners of the box are inside the frame less a twentieth on each side."""
    forward = [m - e for e, m in zip(eye, middle)]
    length = math.hypot(*forward)
    forward = [f / length for f in forward]
    across = math.hypot(forward[0], forward[1])
    right = [forward[1] / across, -forward[0] / across, 0.0]
    up = [-forward[2] * forward[0] / across, -forward[2] * forward[1] / across, across]
    reach = 0.9 * math.tan(math.radians(FOV / 2))
    for corner in itertools.product(*zip(low, high)):
        ray = [c - e for e, c in zip(eye, corner)]
        x, y, z = (sum(a * b for a, b in zip(axis, ray)) for axis in (right, up, forward))
        if z <= 0 or abs(y) > reach * z or abs(x) > reach * z * width / height:
            return False
    return True


def seconds(command):
    """Wall seconds and CPU seconds of a process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def row(values):
    return f"{statistics.median(values):.2f} ({min(values):.2f}-{max(values):.2f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vdbtrace")
    parser.add_argument("vdb")
    parser.add_argument("--spp", default="1,4,16")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--size", default="1280x960")
    args = parser.parse_args()

    low, high = boxOf(args.vdb)
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    width, height = (int(n) for n in args.size.split("x"))
    distance = 100 * math.dist(low, high)  # from far away as near as the box fits
    while fills(near := [m + 0.99 * distance * a for m, a in zip(middle, AWAY)], middle, low, high, width, height):
        eye = near
        distance *= 0.99
    horizontal = 2 * math.degrees(math.atan(math.tan(math.radians(FOV / 2)) * width / height))

    def place(point):
        return ",".join(f"{c:.6g}" for c in point)

    print("| samples a pixel | `vdb_render` s | `vdbtrace` s | times | CPU s | times |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        out = str(pathlib.Path(scratch) / "picture.exr")
        for spp in args.spp.split(","):
            peer = ["vdb_render", args.vdb, out, "-shader", "normal", "-res", args.size, "-samples", spp,
                    "-translate", place(eye), "-lookat", place(middle), "-up", "0,0,1", "-fov", f"{horizontal:.6g}",
                    "-cpus", "2"]
            own = [args.vdbtrace, args.vdb, "-o", out, "--integrator", "normal", "--no-bed", "--size", args.size,
                   "--spp", spp, "--eye", place(eye), "--look-at", place(middle), "--fov", str(FOV), "--threads", "2",
                   "--quiet"]
            theirs, ours = [], []
            for _ in range(args.runs):
                theirs.append(seconds(peer))
                ours.append(seconds(own))
            wall = [[t[0] for t in side] for side in (theirs, ours)]
            cpu = [statistics.median(t[1] for t in side) for side in (theirs, ours)]
            times = statistics.median(a / b for a, b in zip(*wall))
            print(f"| {spp} | {row(wall[0])} | {row(wall[1])} | {times:.1f} | {cpu[0]:.1f}, {cpu[1]:.1f} "
                  f"| {cpu[0] / cpu[1]:.1f} |", flush=True)


main()

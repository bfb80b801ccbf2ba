"""The same scene in vdbtrace and in Blender's Cycles: a level set under a map of light, Lambert, one camera.

    /usr/bin/python3 bench/cycles.py --bin build/release/bin --vdb part.vdb --env hills.hdr -o out same
    /usr/bin/python3 bench/cycles.py ... -o out time

`same` renders it in both with many samples, two seeds each, and compares them. `time` measures seconds and noise, which
is taken from two pictures of the same program, so that the mesh's facets count as nobody's error.
"""

import argparse
import json
import os
import re
import subprocess
import sys

import numpy as np
import pyopenvdb

HERE = os.path.dirname(os.path.abspath(__file__))
ALBEDO = (0.6, 0.3, 0.12)


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr}")
    return done.stdout


def camera_of(vdb):
    """A view from the front right, above: the print fills most of the picture's height."""
    grid = pyopenvdb.readGridMetadata(vdb, "surface")
    low = np.array(grid.transform.indexToWorld(grid.metadata["file_bbox_min"]))
    high = np.array(grid.transform.indexToWorld(grid.metadata["file_bbox_max"]))
    middle, reach = (low + high) / 2, np.linalg.norm(high - low) / 2
    way = np.array([0.55, -0.75, 0.45])
    eye = middle + way / np.linalg.norm(way) * reach * 3.2
    return [round(float(x), 3) for x in eye], [round(float(x), 3) for x in middle]


class Scene:
    def __init__(self, o):
        self.o = o
        self.eye, self.look_at = camera_of(o.vdb)
        self.path = lambda name: os.path.join(o.output, name)

    def trace(self, name, spp, seed, *more):
        """Returns the picture and the seconds of rendering and of all."""
        o = self.o
        report = run(os.path.join(o.bin, "vdbtrace"), o.vdb, "-o", self.path(name), "--size", "x".join(map(str, o.size)),
                     "--spp", spp, "--seed", seed, "--no-bed", "--env", o.env, "--bounces", o.bounces,
                     "--brdf", "lambert:" + ",".join(map(str, ALBEDO)), "--threads", o.threads, "--fov", 28,
                     "--eye", ",".join(map(str, self.eye)), "--look-at", ",".join(map(str, self.look_at)),
                     "--quiet", "--stats", "-", *more)
        seconds = json.loads(report)["seconds"]
        return {"output": self.path(name), "spp": spp, "seconds": seconds["render"], "total": seconds["total"]}

    def cycles(self, shots):
        o = self.o
        job = {"vdb": os.path.abspath(o.vdb), "env": os.path.abspath(o.env), "size": o.size, "eye": self.eye,
               "look_at": self.look_at, "fov": 28, "albedo": ALBEDO, "bounces": o.bounces, "threads": o.threads,
               "refine": o.refine,
               "shots": [{"output": os.path.abspath(self.path(name)), "spp": spp, "seed": seed}
                         for name, spp, seed in shots]}
        with open(self.path("cycles.json"), "w", encoding="utf-8") as file:
            json.dump(job, file)
        text = run("blender", "--background", "--factory-startup", "--python-exit-code", 1, "--python",
                   os.path.join(HERE, "cycles_inside.py"), "--", self.path("cycles.json"))
        print("  ".join(line for line in text.splitlines() if line.startswith("MESH")))
        return [json.loads(line[5:]) for line in text.splitlines() if line.startswith("SHOT ")]

    def errors(self, reference, *pictures):
        """relMSE, RMSE, bias, mean relative difference and 99.9th percentile of each picture."""
        text = run(os.path.join(self.o.bin, "bench_picture_error"), reference, *pictures)
        return [[float(x) for x in line.split()[:5]] for line in text.splitlines()[1:]]


def same(scene, spp):
    ours = [scene.trace(f"ours_{seed}.exr", spp, seed)["output"] for seed in (1, 2)]
    theirs = [shot["output"] for shot in scene.cycles([(f"cycles_{seed}.exr", spp, seed) for seed in (1, 2)])]
    pairs = {"vdbtrace, another seed": (ours[0], ours[1]), "Cycles, another seed": (theirs[0], theirs[1]),
             "vdbtrace against Cycles": (theirs[0], ours[0])}
    print(f"{'':26} {'relMSE':>10} {'bias':>9} {'mean |d|':>9} {'99.9 %':>8}")
    for name, (reference, picture) in pairs.items():
        rel_mse, _, bias, mean, worst = scene.errors(reference, picture)[0]
        print(f"{name:26} {rel_mse:10.3e} {bias:+9.5f} {mean:9.5f} {worst:8.4f}")


def noise(scene, pair):
    """relMSE of one of two independent pictures: half of their own, so that no converged picture is needed."""
    return scene.errors(*pair)[0][0] / 2


def time(scene, spp, ours):
    """Seconds and noise, from which follows the time to any error: noise falls as the samples."""
    for count in ours:
        shots = [scene.trace(f"time_ours_{seed}.exr", count, seed) for seed in (1, 2)]
        print(f"vdbtrace {count:4} spp: {min(shot['seconds'] for shot in shots):8.2f} s (loading and all "
              f"{min(shot['total'] for shot in shots):.2f} s), relMSE {noise(scene, [s['output'] for s in shots]):.3e}",
              flush=True)
    # The first picture takes over the mesh and builds its tree; persistent data keep both for the others.
    first, *shots = scene.cycles([("warm.exr", 1, 0)] + [(f"time_cycles_{seed}.exr", spp, seed) for seed in (1, 2)])
    print(f"Cycles   {spp:4} spp: {min(shot['seconds'] for shot in shots):8.2f} s (its first sample "
          f"{first['seconds']:.2f} s), relMSE {noise(scene, [shot['output'] for shot in shots]):.3e}")


def parser():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--bin", required=True)
    p.add_argument("--vdb", required=True)
    p.add_argument("--env", required=True)
    p.add_argument("-o", "--output", required=True)
    p.add_argument("--size", default="640x480")
    p.add_argument("--spp", type=int, default=1024)
    p.add_argument("--our-spp", type=lambda text: [int(x) for x in text.split(",")], default=[8, 16, 32])
    p.add_argument("--bounces", type=int, default=3)
    p.add_argument("--refine", type=int, default=1, help="mesh the field on a lattice this many times as fine")
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("what", choices=["same", "time"])
    return p


if __name__ == "__main__":
    options = parser().parse_args()
    options.size = [int(x) for x in re.fullmatch(r"(\d+)x(\d+)", options.size).groups()]
    os.makedirs(options.output, exist_ok=True)
    if options.what == "same":
        same(Scene(options), options.spp)
    else:
        time(Scene(options), options.spp, options.our_spp)

"""Mutated files of every kind through the real tools: they end by themselves with 0, 1, 2 or 3, in bounded time and memory.

STRATUM_MUTATIONS is how many of each kind are run (6), STRATUM_MUTATION_SEED where the random numbers begin; a finding is
kept, and its command is printed."""

import gzip
import io
import json
import os
import random
import re
import shutil
import subprocess
import tempfile
import time
import zipfile

from run_tools import BIN, SOURCE, check, gcode, write_box

FOLDER = tempfile.mkdtemp(prefix="stratum_mutation_")
KEPT = os.environ.get("STRATUM_FINDINGS", os.path.join(tempfile.gettempdir(), "stratum_findings"))
COUNT = int(os.environ.get("STRATUM_MUTATIONS", "6"))
SEED = int(os.environ.get("STRATUM_MUTATION_SEED", "1"))
CPU_SECONDS = 10.0  # of a run beyond its honest twin
WALL_SECONDS = 120.0
MEMORY = 256e6  # bytes beyond twice the honest twin's
TOOL = {name: os.path.join(BIN, name) for name in ("gcode2vdb", "vdbtrace", "vdbmerge")}
SMALL = ["--size", "24x18", "--spp", "1", "--no-denoise"]
COARSE = ["--voxel-size", "0.4", "--force"]
NUMBERS = [b"0", b"-1", b"1e30", b"-1e30", b"1e308", b"nan", b"inf", b"1e-30", b"4294967296", b"-2147483649", b"0.000001", b"99999"]


def path(name):
    return os.path.join(FOLDER, name)


def read(name):
    with open(name if os.path.isabs(name) else path(name), "rb") as file:
        return file.read()


def write(name, data):
    with open(path(name), "wb") as file:
        file.write(data)


def run(command):
    """Exit status (negative: a signal), CPU seconds, peak bytes, what was said."""
    with open(path("said"), "wb") as said:
        begun = time.monotonic()
        process = subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=said, stdin=subprocess.DEVNULL)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                break
            if time.monotonic() - begun > WALL_SECONDS:
                process.kill()
            time.sleep(0.005)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, read("said").decode(errors="replace")


def mutated(data, other, rng, text):
    """The same bytes with one to four changes."""
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        at = rng.randrange(len(data) + 1)
        length = rng.choice((1, 1, 4, 8, 64, 1000, max(1, len(data) // 4)))
        what = rng.randrange(9 if text else 7)
        if what == 0:
            del data[at:]
        elif what == 1:
            del data[at : at + length]
        elif what == 2:
            data[at : at + 1] = bytes([rng.randrange(256)])
        elif what == 3:
            data[at : at + 4] = rng.choice((b"\0\0\0\0", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80"))
        elif what == 4:
            data[at:at] = data[at : at + length] * rng.choice((1, 2, 50))
        elif what == 5:
            begin = rng.randrange(len(other) + 1)
            data[at : at + length] = other[begin : begin + length]
        elif what == 6:
            data[at : at + 1] = bytes([data[at] ^ 1 << rng.randrange(8)]) if at < len(data) else b""
        elif what == 7:
            found = list(re.finditer(rb"-?\d+\.?\d*", bytes(data[: 1 << 20])))
            if found:
                number = rng.choice(found)
                data[number.start() : number.end()] = rng.choice(NUMBERS)
        else:
            lines = bytes(data).split(b"\n")
            line = rng.randrange(len(lines))
            lines.insert(rng.randrange(len(lines) + 1), lines[line])
            data = bytearray(b"\n".join(lines))
        if not data:
            data = bytearray(b"\n")
    return bytes(data)


def prepare():
    """Honest files of every kind: (kind, file name, command, whether it is text)."""
    for name, options in (("t.vdb", ["--voxel-size", "0.2", "--grids", "color,feature"]), ("m.3mf", ["--voxel-size", "0.3"]),
                          ("m.obj", ["--voxel-size", "0.4"]), ("m.stl", ["--voxel-size", "0.4"])):
        subprocess.run([TOOL["gcode2vdb"], gcode("tile.gcode"), "-o", path(name), *options], check=True, capture_output=True)
    text = read(gcode("tile.gcode"))
    write("t.gcode", text)
    write("t.gcode.gz", gzip.compress(text))
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("Metadata/plate_1.gcode", text)
        packed.writestr("[Content_Types].xml", "<Types/>")
    write("t.gcode.3mf", archive.getvalue())
    for n in range(2):
        subprocess.run([TOOL["vdbtrace"], "t.vdb", "-o", "part.png", "--shard", f"{n}/2", "--size", "200x150", "--spp", "1"],
                       cwd=FOLDER, check=True, capture_output=True)
    subprocess.run([TOOL["vdbtrace"], "t.vdb", "-o", "part.png", "--write-brdf", "b.exr", *SMALL], cwd=FOLDER, check=True,
                   capture_output=True)
    exrs = sorted(name for name in os.listdir(FOLDER) if name.startswith("part.") and name.endswith(".exr"))
    way = {"keys": [{"time": t, "eye": [30 + t, -60, 40], "look_at": [10, 10, 2], "fov": 30} for t in (0, 1)]}
    write("way.json", json.dumps(way, indent=1).encode())
    scene = {"print": "t.vdb", "size": [24, 18], "spp": 1, "bed": True, "camera": {"view": "front"},
             "environment": {"map": "light.exr", "exposure": 1}}
    write("scene.json", json.dumps(scene, indent=1).encode())
    fuzz = os.path.join(SOURCE, "tests", "fuzz")
    for name in os.listdir(os.path.join(fuzz, "brdf")):
        shutil.copy(os.path.join(fuzz, "brdf", name), path("brdf_" + name))
    maps = [name for name in sorted(os.listdir(os.path.join(fuzz, "map"))) if name.endswith((".exr", ".hdr"))]
    for name in maps:
        shutil.copy(os.path.join(fuzz, "map", name), path("map_" + name))
    shutil.copy(path("map_" + next(name for name in maps if name.endswith(".exr"))), path("light.exr"))
    write("printer.json", json.dumps({"limits": {"acceleration_mm_s2": [2000, 2000, 100, 5000]}}, indent=1).encode())
    write_box(path("box.stl"), 20, 20, 4)
    convert = lambda name: [TOOL["gcode2vdb"], name, "-o", "out.vdb", *COARSE]
    trace = lambda name, *more: [TOOL["vdbtrace"], name, "-o", "out.png", "--force", *SMALL, *more]
    kinds = [("G-code", "t.gcode", convert, True), ("G-code, pictured", "t.gcode", lambda name: trace(name, "--voxel-size", "0.4"), True),
             ("gzip", "t.gcode.gz", convert, False), ("3MF package", "t.gcode.3mf", convert, False),
             ("level set", "t.vdb", trace, False), ("attributes", "t.vdb", lambda name: trace(name, "--color-by", "feature"), False),
             ("level set, whole", "t.vdb", lambda name: trace(name, "--march", "vdb"), False),
             ("camera path", "way.json", lambda name: [TOOL["vdbtrace"], "t.vdb", "--film", "out.png", "--camera-path", name,
                                                      "--seconds", "1", "--fps", "2", "--force", *SMALL], True),
             ("scene", "scene.json", lambda name: [TOOL["vdbtrace"], name, "-o", "out.png", "--force"], True),
             ("printer", "printer.json", lambda name: [TOOL["gcode2vdb"], "t.gcode", "--printer", name, "-o", "out.vdb", *COARSE], True),
             ("model, STL", "box.stl", lambda name: [TOOL["gcode2vdb"], "t.gcode", "--compare", name, "-o", "out.vdb", *COARSE], True)]
    for name in ("m.3mf", "m.obj", "m.stl"):
        kinds.append((f"model, {name}", name, lambda given: [TOOL["gcode2vdb"], "t.gcode", "--compare", given, "-o", "out.vdb", *COARSE],
                      name.endswith("obj")))
    if exrs:
        kinds.append(("part of a picture", exrs[0], lambda name: [TOOL["vdbmerge"], "out.png", name, *exrs[1:], "--force"], False))
    for name in sorted(os.listdir(FOLDER)):
        if name.startswith("brdf_") and not name.endswith("merl.binary"):
            kinds.append((name, name, lambda given: trace("t.vdb", "--brdf", given), not name.endswith((".gz", ".exr"))))
        if name.startswith("map_"):
            kinds.append((name, name, lambda given: trace("t.vdb", "--env", given), False))
    return kinds


def main():
    rng = random.Random(SEED)
    kinds = prepare()
    everything = [read(name) for _, name, _, _ in kinds]
    runs = findings = 0
    for kind, name, command, text in kinds:
        honest_status, honest_seconds, honest_bytes, said = run(command(name))
        check(honest_status in (0, 3), f"{kind}: the honest file: {honest_status} {said.strip()[-200:]}")
        data = read(name)
        stem, ending = name.split(".", 1)
        ends = {}
        for _ in range(COUNT):
            bad = f"bad_{stem}.{ending}"
            write(bad, mutated(data, rng.choice(everything), rng, text))
            status, seconds, memory, said = run(command(bad))
            ends[status] = ends.get(status, 0) + 1
            runs += 1
            slow = seconds > honest_seconds + CPU_SECONDS
            large = memory > 2 * honest_bytes + MEMORY
            if status in (0, 1, 2, 3) and not slow and not large and (status == 0 or said.strip()):
                continue
            findings += 1
            os.makedirs(KEPT, exist_ok=True)
            kept = os.path.join(KEPT, f"{SEED}_{runs}_{bad}")
            shutil.copy(path(bad), kept)
            print(f"FINDING: {kind}: {status}, {seconds:.1f} s, {memory * 1e-6:.0f} MB ({honest_bytes * 1e-6:.0f}): "
                  f"{' '.join(command(kept))}\n  {said.strip()[-300:]}", flush=True)
        print(f"{kind}: {COUNT} mutations: {dict(sorted(ends.items()))}", flush=True)
    shutil.rmtree(FOLDER)
    check(findings == 0, f"{runs} mutated files: {findings} findings")


main()

"""Mutated files of every kind through the real tools: they end by themselves with 0, 1, 2 or 3, in bounded time and memory.

STRATUM_MUTATIONS is how many of each kind are run (2), STRATUM_MUTATION_SEED where the random numbers begin,
STRATUM_MUTATION_KINDS a regular expression that the kinds match (all); a finding is kept, and its command is printed."""

import gzip
import json
import os
import random
import re
import shutil
import struct
import subprocess
import tempfile
import time
import zipfile

from packed_gcode import bgcode, gx, zipped
from run_tools import BIN, SOURCE, Scratch, check, gcode, write_box

SCRATCH = Scratch("mutation")
FOLDER, path = SCRATCH.folder, SCRATCH.path
KEPT = os.environ.get("STRATUM_FINDINGS", os.path.join(tempfile.gettempdir(), "stratum_findings"))
COUNT = int(os.environ.get("STRATUM_MUTATIONS", "2"))
SEED = int(os.environ.get("STRATUM_MUTATION_SEED", "1"))
KINDS = re.compile(os.environ.get("STRATUM_MUTATION_KINDS", ""))
CPU_SECONDS = 10.0  # of a run beyond its honest twin
MOST_CPU_SECONDS = 60.0
STILL_SECONDS = 300.0  # without any progress: a hang, not a busy machine
LARGE = 10e6  # bytes: of such a file a twentieth of the mutations
MEMORY = 256e6  # bytes beyond twice the honest twin's
TOOL = {name: os.path.join(BIN, name) for name in ("gcode2vdb", "vdbtrace", "vdbmerge")}
SMALL = ["--size", "24x18", "--spp", "1", "--no-denoise"]
COARSE = ["--voxel-size", "0.4", "--force"]
NUMBERS = [b"0", b"-1", b"1e30", b"-1e30", b"1e308", b"nan", b"inf", b"1e-30", b"4294967296", b"-2147483649", b"0.000001", b"99999"]


def read(name):
    with open(name if os.path.isabs(name) else path(name), "rb") as file:
        return file.read()


def write(name, data):
    with open(path(name), "wb") as file:
        file.write(data)


def cpu_seconds(process):
    """Of a process that was not waited for, and of its children that were."""
    with open(f"/proc/{process}/stat", encoding="ascii", errors="replace") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return sum(int(field) for field in fields[11:15]) / os.sysconf("SC_CLK_TCK")


def run(command):
    """Exit status (negative: a signal), CPU seconds, peak bytes, what was said."""
    with open(path("said"), "wb") as said:
        process = subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=said, stdin=subprocess.DEVNULL)
        spent, moved = 0.0, time.monotonic()
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                break
            now = cpu_seconds(process.pid)
            if now > spent:
                spent, moved = now, time.monotonic()
            if spent > MOST_CPU_SECONDS or time.monotonic() - moved > STILL_SECONDS:
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
        what = rng.choice((0, 1, 2, 3, 4, 5, 6) + (7, 7, 7, 7, 8) * text)
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


def prepare_files():
    """Honest files of every kind."""
    write("merl.binary", struct.pack("<3I", 90, 90, 180) + struct.pack("<d", 100.0) * (3 * 90 * 90 * 180))
    for name, options in (("t.vdb", ["--voxel-size", "0.2", "--grids", "color,feature"]), ("m.3mf", ["--voxel-size", "0.3"]),
                          ("m.obj", ["--voxel-size", "0.4"]), ("m.stl", ["--voxel-size", "0.4"])):
        subprocess.run([TOOL["gcode2vdb"], gcode("tile.gcode"), "-o", path(name), *options], check=True, capture_output=True)
    text = read(gcode("tile.gcode"))
    for name, content in (("t.gcode", text), ("t.gcode.gz", gzip.compress(text)),
                          ("t.gcode.3mf", zipped({"Metadata/plate_1.gcode": text, "[Content_Types].xml": "<Types/>"})),
                          ("t.ufp", zipped({"/3D/model.gcode": text, "/Metadata/thumbnail.png": b"\x89PNG"})),
                          ("t.gx", gx(text)), ("plain.bgcode", bgcode(text, 0)),
                          ("deflate.bgcode", bgcode(text, 1, checksum=False)),
                          ("heatshrink.bgcode", bgcode(text, 2, checksum=False)),
                          ("meatpack.bgcode", bgcode(text, 3, 2, checksum=False))):
        write(name, content)
    for n in range(2):
        subprocess.run([TOOL["vdbtrace"], "t.vdb", "-o", "part.png", "--shard", f"{n}/2", "--size", "200x150", "--spp", "1"],
                       cwd=FOLDER, check=True, capture_output=True)
    subprocess.run([TOOL["vdbtrace"], "t.vdb", "-o", "part.png", "--write-brdf", "b.exr", *SMALL], cwd=FOLDER, check=True,
                   capture_output=True)
    way = {"keys": [{"time": t, "eye": [30 + t, -60, 40], "look_at": [10, 10, 2], "fov": 30} for t in (0, 1)]}
    write("way.json", json.dumps(way, indent=1).encode())
    scene = {"print": "t.vdb", "size": [24, 18], "spp": 1, "bed": True, "camera": {"view": "front"},
             "environment": {"map": "light.exr", "exposure": 1}}
    write("scene.json", json.dumps(scene, indent=1).encode())
    for folder, endings in (("brdf", ("",)), ("map", (".exr", ".hdr")), ("printer", ("",)), ("vdb", ("",)), ("scene", ("s.json",))):
        for name in os.listdir(os.path.join(SOURCE, "tests", "fuzz", folder)):
            if name.endswith(endings):
                shutil.copy(os.path.join(SOURCE, "tests", "fuzz", folder, name), path(f"{folder}_{name}"))
    shutil.copy(path("map_map_c0.exr"), path("light.exr"))
    write_box(path("box.stl"), 20, 20, 4)


def prepare():
    """(kind, file name, command, whether it is text[, what packs the changed bytes]) of each."""
    prepare_files()
    convert = lambda name, *more: [TOOL["gcode2vdb"], name, "-o", "out.vdb", *COARSE, *more]
    trace = lambda name, *more: [TOOL["vdbtrace"], name, "-o", "out.png", "--force", *SMALL, *more]
    compare = lambda name: convert("t.gcode", "--compare", name)
    kinds = [("G-code", "t.gcode", convert, True), ("G-code, pictured", "t.gcode", lambda name: trace(name, "--voxel-size", "0.4"), True),
             ("G-code, settled", "t.gcode", lambda name: convert(name, "--beads", "settled"), True),
             ("G-code, report", "t.gcode", lambda name: convert(name, "--report", "out.json"), True),
             ("G-code, elements", "t.gcode", lambda name: [TOOL["gcode2vdb"], name, "-o", "out.inp", *COARSE], True),
             ("G-code, flow", "t.gcode", lambda name: convert(name, "--flow-lag", "0.05", "--sag", "0.1", "--strings"), True)]
    kinds += [(name, name, convert, False) for name in ("t.gcode.gz", "t.gcode.3mf", "t.ufp", "t.gx", "plain.bgcode", "deflate.bgcode",
                                                        "heatshrink.bgcode", "meatpack.bgcode")]
    kinds += [(f"{name}, thumbnail", name, lambda given, ending=name.split(".", 1)[1]: [
        TOOL["gcode2vdb"], given, "-o", f"out.{ending}", "--thumbnail", "80x60", "--force"], name == "t.gcode")
              for name in ("t.gcode", "t.gcode.3mf", "t.ufp", "t.gx", "deflate.bgcode")]
    kinds += [("level set", "t.vdb", trace, False), ("attributes", "t.vdb", lambda name: trace(name, "--color-by", "feature"), False),
              ("level set, whole", "t.vdb", lambda name: trace(name, "--march", "vdb"), False),
              ("camera path", "way.json", lambda name: [TOOL["vdbtrace"], "t.vdb", "--film", "out.png", "--camera-path", name,
                                                       "--seconds", "1", "--fps", "2", "--force", *SMALL], True),
              ("scene", "scene.json", lambda name: [TOOL["vdbtrace"], name, "-o", "out.png", "--force"], True),
              ("printer", "printer_printer.json", lambda name: convert("t.gcode", "--printer", name), True),
              ("merl.binary", "merl.binary", lambda name: trace("t.vdb", "--brdf", name), False)]
    kinds += [(f"model, {name}", name, compare, name in ("box.stl", "m.obj")) for name in ("box.stl", "m.3mf", "m.obj", "m.stl")]
    with zipfile.ZipFile(path("m.3mf")) as package:
        entries = {name: package.read(name) for name in package.namelist()}
    inside = next(name for name in entries if name.endswith(".model"))
    write("inside.3mf", entries[inside])
    kinds.append(("model, inside of m.3mf", "inside.3mf", compare, True, lambda data: zipped({**entries, inside: data})))
    exrs = sorted(name for name in os.listdir(FOLDER) if name.startswith("part.") and name.endswith(".exr"))
    check(len(exrs) == 2, "there are two parts of a picture")
    for n in range(2):
        kinds.append((f"part {n} of a picture", exrs[n], lambda name, n=n: [TOOL["vdbmerge"], "out.png", name, exrs[1 - n], "--force"], False))
    for name in sorted(os.listdir(FOLDER)):
        if name.startswith("brdf_"):
            kinds.append((name, name, lambda given: trace("t.vdb", "--brdf", given), not name.endswith((".gz", ".exr", ".binary"))))
        elif name.startswith("map_"):
            kinds.append((name, name, lambda given: trace("t.vdb", "--env", given), False))
        elif name.startswith("vdb_"):
            kinds.append((name, name, trace, False))
        elif name.startswith("scene_"):
            kinds.append((name, name, lambda given: [TOOL["vdbtrace"], given, "-o", "out.png", "--force", *SMALL], True))
        elif name.startswith("printer_") and name != "printer_printer.json":
            kinds.append((name, name, lambda given: convert("t.gcode", "--printer", given), True))
    return kinds


def main():
    rng = random.Random(SEED)
    kinds = prepare()
    everything = [read(kind[1]) for kind in kinds]
    runs = findings = 0
    for kind, name, command, text, *packing in kinds:
        if not KINDS.search(kind):
            continue
        data = read(name)
        pack = packing[0] if packing else bytes
        write(name, pack(data))
        honest_status, honest_seconds, honest_bytes, said = run(command(name))
        check(honest_status in (0, 3), f"{kind}: the honest file: {honest_status} {said.strip()[-200:]}")
        stem, ending = name.split(".", 1)
        ends = {}
        begun = time.monotonic()
        count = COUNT if len(data) < LARGE else (COUNT + 19) // 20
        for _ in range(count):
            bad = f"bad_{stem}.{ending}"
            write(bad, pack(mutated(data, rng.choice(everything), rng, text)))
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
        print(f"{kind}: {count} mutations in {time.monotonic() - begun:.1f} s: {dict(sorted(ends.items()))}", flush=True)
    shutil.rmtree(FOLDER)
    check(findings == 0, f"{runs} mutated files: {findings} findings")


main()

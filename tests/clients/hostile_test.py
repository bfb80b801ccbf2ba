"""What other programs do to the files of a run while it works: inputs that shrink or are rewritten, pipes, closed and full
streams, too little memory, outputs that are somebody else's."""

import os
import shutil
import subprocess
import threading
import time

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("hostile")
FOLDER, path, read = SCRATCH.folder, SCRATCH.path, SCRATCH.read
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
VDBMERGE = os.path.join(BIN, "vdbmerge")
TILE = gcode("tile.gcode")
COARSE = ["--voxel-size", "0.2"]
SMALL = ["--size", "64x48", "--spp", "1"]
TRIALS = int(os.environ.get("STRATUM_HOSTILE_TRIALS", "8"))


def call(*command, **options):
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "timeout": 120, "cwd": FOLDER, **options}
    return subprocess.run(command, check=False, **options)


def does(*command, **options):
    done = call(*command, **options)
    check(done.returncode == 0, f"{' '.join(map(os.path.basename, command))}: {done.returncode} {done.stderr}")
    return done


def write(name, data):
    with open(path(name), "wb") as file:
        file.write(data)


# --- inputs that change -------------------------------------------------------------------------------------------------
with open(TILE, "rb") as tile:
    TEXT = tile.read()
LONG = TEXT * (1 + 12_000_000 // len(TEXT))
does(GCODE2VDB, TILE, "-o", "fine.vdb", "--voxel-size", "0.05")
VDB = read("fine.vdb")
does(GCODE2VDB, TILE, "-o", "coarse.vdb", *COARSE)


def changes(name, data, command, change):
    """Runs the command on a file that is changed again and again: it ends by itself, with a message."""
    ends = set()
    for trial in range(TRIALS):
        write(name, data)
        with open(path("said"), "wb") as said:
            running = subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=said)
        while running.poll() is None:
            time.sleep(0.003 * trial)
            change()
            write(name, data)
        said = read("said").decode(errors="replace")
        ends.add(running.returncode)
        check(running.returncode in (0, 3) or (running.returncode == 2 and said),
              f"  {trial}: ends with {running.returncode}: {said.strip()}")
    check(ends <= {0, 2, 3}, f"{os.path.basename(command[0])} on {name} while it changes: {sorted(ends)}")


def shrink(name):
    return lambda: os.truncate(path(name), 4096)


def rewrite(name, source):
    return lambda: shutil.copyfile(path(source), path(name))


write("short.gcode", TEXT)
for change in (shrink("long.gcode"), rewrite("long.gcode", "short.gcode")):
    changes("long.gcode", LONG, [GCODE2VDB, "long.gcode", "-o", "out.vdb", "--layers", "1:1", *COARSE], change)
for change in (shrink("v.vdb"), rewrite("v.vdb", "coarse.vdb")):
    changes("v.vdb", VDB, [VDBTRACE, "v.vdb", "-o", "out.png", "--size", "400x300", "--spp", "4"], change)

# --- pipes --------------------------------------------------------------------------------------------------------------
subprocess.run(["gzip", "-kf", path("short.gcode")], check=True)
done = call("bash", "-c", f"'{GCODE2VDB}' <(zcat short.gcode.gz) -o piped.vdb --voxel-size 0.2")
check(done.returncode == 0 and read("piped.vdb")[:4] == VDB[:4], f"<(zcat part.gcode.gz) is an input: {done.stderr}")
done = call("bash", "-c", f"'{VDBTRACE}' <(zcat short.gcode.gz) -o piped.png --voxel-size 0.2 {' '.join(SMALL)}")
check(done.returncode == 0 and read("piped.png")[:4] == b"\x89PNG", f"also of vdbtrace: {done.stderr}")
done = call("bash", "-c", f"'{GCODE2VDB}' <(zcat short.gcode.gz)")
check(done.returncode == 2 and b"-o" in done.stderr, "which has no name to call an output by")
for name in ("pipe.vdb", "pipe.json"):
    os.mkfifo(path(name))
for name, command in (("pipe.vdb", [GCODE2VDB, TILE, "-o", "pipe.vdb", *COARSE]),
                      ("pipe.json", [GCODE2VDB, TILE, "-o", "coarse.vdb", "--stats", "pipe.json", *COARSE])):
    taken = []
    reader = threading.Thread(target=lambda name=name: taken.append(read(name)))
    reader.start()
    done = call(*command)
    reader.join(timeout=10)
    check(done.returncode == 0 and len(taken[0]) > 100, f"{' '.join(command[1:])}: a pipe gets all: {done.stderr}")

# --- streams that are closed or full ------------------------------------------------------------------------------------
for redirection in ("2>/dev/full", "2>&-", "<&- 2>&-", "2>/dev/full </dev/null"):
    for command in (f"'{GCODE2VDB}' '{TILE}' -o closed.vdb --voxel-size 0.2",
                    f"'{VDBTRACE}' coarse.vdb -o closed.png {' '.join(SMALL)}"):
        done = call("bash", "-c", f"rm -f closed.*; {command} {redirection} && ls closed.*")
        check(done.returncode == 0 and b"closed." in done.stdout, f"{redirection}: the work is done: {done.returncode}")
    done = call("bash", "-c", f"'{GCODE2VDB}' missing.gcode -o closed.vdb {redirection}")
    check(done.returncode == 3, f"{redirection}: a bad input is one: {done.returncode}")
    done = call("bash", "-c", f"'{GCODE2VDB}' {redirection}")
    check(done.returncode == 2, f"{redirection}: the usage: {done.returncode}")
done = call("bash", "-c", f"'{GCODE2VDB}' '{TILE}' -o closed.vdb --voxel-size 0.2 >&-")
check(done.returncode in (0, 1), f"standard output closed: {done.returncode}")
check(read("closed.vdb")[:4] == VDB[:4], "  and nothing that is said gets into the file")

# --- too little memory --------------------------------------------------------------------------------------------------
for kilobytes in (60_000, 102_400, 160_000, 300_000, 600_000):
    for command in ([GCODE2VDB, TILE, "-o", "little.vdb"], [VDBTRACE, "coarse.vdb", "-o", "little.png", *SMALL],
                    [VDBTRACE, TILE, "-o", "little.png", *SMALL]):
        done = call("bash", "-c", 'ulimit -v "$0"; exec "$@"', str(kilobytes), *command)
        loaded = b"error while loading shared libraries" not in done.stderr
        check(done.returncode in (0, 1, 2, 3) or not loaded,
              f"ulimit -v {kilobytes}: {os.path.basename(command[0])} ends with {done.returncode} {done.stderr[-200:]}")

# --- outputs that are somebody else's -----------------------------------------------------------------------------------
THEIRS = b"somebody else's work"


def guarded(name, *command):
    """The file of that name stays, unless --force is given; what the tool wrote itself is replaced."""
    write(name, THEIRS)
    refused = call(*command)
    check(refused.returncode == 2 and b"--force" in refused.stderr and read(name) == THEIRS,
          f"{name}: {refused.returncode} {refused.stderr.decode().strip()[-120:]}")
    does(*command, "--force")
    check(read(name) != THEIRS, f"  {name}: --force replaces it")
    does(*command)


for ending in ("stl", "ply", "obj", "3mf", "glb", "vdb", "inp"):
    guarded(f"part.{ending}", GCODE2VDB, TILE, "-o", f"part.{ending}", "--voxel-size", "0.3")
guarded("named.usda", GCODE2VDB, TILE, "-o", "named.vdb", "--usda", *COARSE)
guarded("table.csv", GCODE2VDB, TILE, "-o", "named.vdb", "--dump-toolpath", "table.csv", *COARSE)
guarded("stats.json", GCODE2VDB, TILE, "-o", "named.vdb", "--stats", "stats.json", *COARSE)
for ending in ("json", "md", "html"):
    guarded(f"report.{ending}", GCODE2VDB, TILE, "-o", "named.vdb", "--report", f"report.{ending}", *COARSE)
for ending in ("png", "jpg", "webp", "exr"):
    guarded(f"picture.{ending}", VDBTRACE, "coarse.vdb", "-o", f"picture.{ending}", *SMALL)
guarded("brdf.exr", VDBTRACE, "coarse.vdb", "-o", "p.png", "--write-brdf", "brdf.exr", *SMALL)
FILM = ["--turntable", "3", "--fps", "3", "--size", "64x48", "--spp", "1"]
films = ["png"] + (["mp4", "webm", "gif"] if shutil.which("ffmpeg") else [])
for ending in films:
    guarded(f"film.{ending}", VDBTRACE, "coarse.vdb", "--film", f"film.{ending}", *FILM)
write("copy.gcode", THEIRS)
thumbnail = [GCODE2VDB, TILE, "-o", "copy.gcode", "--thumbnail", "32x32/PNG"]
check(call(*thumbnail).returncode == 2 and read("copy.gcode") == THEIRS, "a print stays, too")
does(*thumbnail, "--force")
shutil.copy(TILE, path("own.gcode"))
does(GCODE2VDB, "own.gcode", "--thumbnail", "32x32/PNG", "--in-place")

# --- symbolic links -----------------------------------------------------------------------------------------------------
os.mkdir(path("elsewhere"))
for name, command in (("link.vdb", [GCODE2VDB, TILE, "-o", "link.vdb", *COARSE]),
                      ("link.png", [VDBTRACE, "coarse.vdb", "-o", "link.png", *SMALL])):
    os.symlink("elsewhere/" + name, path(name))
    does(*command)
    check(os.path.islink(path(name)) and len(read("elsewhere/" + name)) > 100, f"{name}: the link stays, its file is written")
    write("elsewhere/" + name, THEIRS)
    check(call(*command).returncode == 2 and read("elsewhere/" + name) == THEIRS, "  or stays, if it is somebody else's")
check(not [name for name in os.listdir(path("elsewhere")) if name.endswith(".part")], "nothing is left beside them")

# --- parts --------------------------------------------------------------------------------------------------------------
for n in range(2):
    does(VDBTRACE, "coarse.vdb", "-o", "whole.png", "--shard", f"{n}/2", "--size", "64x32", "--spp", "1")
parts = sorted(name for name in os.listdir(FOLDER) if name.startswith("whole") and name.endswith(".exr"))
check(len(parts) == 2, f"parts: {parts}")
good = read(parts[0])
for at in range(0, len(good), max(1, len(good) // 40)):
    write(parts[0], good[:at] + bytes([good[at] ^ 0x10]) + good[at + 1 :])
    done = call(VDBMERGE, "merged.png", *parts, "--force")
    check(done.returncode in (0, 3), f"a damaged part, byte {at}: {done.returncode} {done.stderr[-160:]}")

# --- models -------------------------------------------------------------------------------------------------------------
does(GCODE2VDB, TILE, "-o", "model.3mf", "--voxel-size", "0.3")
model = read("model.3mf")
for at in range(0, len(model), max(1, len(model) // 60)):
    write("bad.3mf", model[:at] + bytes([model[at] ^ 0x55]) + model[at + 1 :])
    done = call(GCODE2VDB, TILE, "-o", "cmp.vdb", "--voxel-size", "0.3", "--compare", "bad.3mf")
    check(done.returncode in (0, 1, 2, 3), f"--compare with a damaged model, byte {at}: {done.returncode} {done.stderr[-160:]}")

# --- parts that lie far apart -------------------------------------------------------------------------------------------
def towers(name, corners):
    lines = ["; generated by PrusaSlicer 2.5.0", "; layer_height = 0.2", "; nozzle_diameter = 0.4", "; filament_diameter = 1.75", "G90", "M83"]
    for layer in range(1, 11):
        lines += [";LAYER_CHANGE", f";Z:{0.2 * layer:.1f}", ";HEIGHT:0.2", ";TYPE:External perimeter", ";WIDTH:0.45"]
        for corner in corners:
            lines.append(f"G0 X{corner} Y{corner} Z{0.2 * layer:.1f} F9000")
            lines += [f"G1 X{corner + x} Y{corner + y} E.1 F1800" for x, y in ((3, 0), (3, 3), (0, 3), (0, 0))]
    write(name, "\n".join(lines + ["; estimated printing time (normal mode) = 1m 0s", ""]).encode())


def peak(*command):
    """Exit status and peak bytes."""
    running = subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(running.pid, 0)
    running.returncode = os.waitstatus_to_exitcode(status)
    return running.returncode, 1024 * usage.ru_maxrss


towers("near.gcode", (10, 30))
towers("far.gcode", (10, 90000))
for options in (["-o", "t.vdb"], ["-o", "t.vdb", "--beads", "settled"], ["-o", "t.vdb", "--interior", "cull"], ["-o", "t.stl"],
                ["-o", "t.vdb", "--grids", "layer"], ["--report", "t.json"], ["-o", "t.inp", "--voxel-size", "0.2"],
                ["-o", "t.gcode", "--thumbnail", "32x32/PNG"]):
    near, far = (peak(GCODE2VDB, name, *options, "--force") for name in ("near.gcode", "far.gcode"))
    # Rays need a table of the space between, and refuse.
    ends = 2 if "--thumbnail" in options else 0
    check(near[0] == 0 and far[0] == ends and far[1] < 2 * near[1],
          f"towers 90 m apart, {' '.join(options)}: {far[0]}, {far[1] * 1e-6:.0f} MB, side by side {near[1] * 1e-6:.0f} MB")

shutil.rmtree(FOLDER)

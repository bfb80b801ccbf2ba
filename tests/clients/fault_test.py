"""What users, disks and machines do: never a half file under the final name, never a lost older file.

STRATUM_FAULT_TRIALS sets how many runs are killed; 200 make the long mode."""

import os
import random
import resource
import shutil
import signal
import subprocess
import tempfile
import time

from run_tools import BIN, check, gcode

FOLDER = tempfile.mkdtemp(prefix="stratum_fault_")
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
TRIALS = int(os.environ.get("STRATUM_FAULT_TRIALS", "20"))
TILE = gcode("tile.gcode")
OLD = b"an older file by Stratum 1.0 that somebody needs"
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def conversion(output, *options):
    return [GCODE2VDB, TILE, "-o", output, "--voxel-size", "0.1", "--layers", "1:8", *options]


def read(path):
    with open(path, "rb") as file:
        return file.read()


def put_old(path):
    with open(path, "wb") as file:
        file.write(OLD)


def unfinished(folder):
    return [name for name in os.listdir(folder) if name.endswith(".part")]


def writing(pid, folder):
    """Whether a process or its child has a file without a name in that folder: is at work, and has not put it in place."""
    try:
        with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
            pids = [pid, *map(int, file.read().split())]
        for each in pids:
            for fd in os.listdir(f"/proc/{each}/fd"):
                target = os.readlink(f"/proc/{each}/fd/{fd}")
                if target.startswith(os.path.realpath(folder)) and target.endswith("(deleted)"):
                    return True
    except OSError:
        pass  # it has just ended
    return bool(unfinished(folder))


def fails(done, *fragments):
    check(done.returncode == 1, f"  ends with 1: {done.returncode} {done.stderr.strip()}")
    for fragment in fragments:
        check(fragment in done.stderr, f"  says {fragment!r}")


# --- kill -9 --------------------------------------------------------------------------------------------------------
random.seed(7)
for extension in ("vdb", "stl"):
    out = os.path.join(FOLDER, "print." + extension)
    start = time.perf_counter()
    subprocess.run(conversion(out), check=True, **QUIET)
    seconds = time.perf_counter() - start
    whole = read(out)
    kept = new = 0
    for _ in range(TRIALS // 2):
        put_old(out)
        process = subprocess.Popen(conversion(out), **QUIET)
        time.sleep(random.uniform(0, 1.2 * seconds))
        process.kill()
        process.wait()
        found = read(out)
        kept += found == OLD
        new += found == whole
    check(kept + new == TRIALS // 2, f"kill -9 on .{extension}: {TRIALS // 2} trials, {kept} old files, {new} new ones, 0 half")
    subprocess.run(conversion(out), check=True, **QUIET)
    check(not unfinished(FOLDER), "  and after the next run nothing unfinished")

# --- a checkpointed render, killed and taken up again -------------------------------------------------------------------
vdb = os.path.join(FOLDER, "print.vdb")
render = [VDBTRACE, vdb, "--size", "200x150", "--spp", "16", "--quiet"]
subprocess.run(conversion(vdb), check=True, **QUIET)
whole_vdb = read(vdb)
start = time.perf_counter()
subprocess.run([*render, "-o", os.path.join(FOLDER, "whole.exr")], check=True, **QUIET)
seconds = time.perf_counter() - start
resumed = [*render, "-o", os.path.join(FOLDER, "resumed.exr"), "--checkpoint", os.path.join(FOLDER, "ck")]
for _ in range(max(3, TRIALS // 10)):
    process = subprocess.Popen(resumed, **QUIET)
    time.sleep(random.uniform(0.2, 0.8) * seconds)
    process.kill()
    process.wait()
subprocess.run(resumed, check=True, **QUIET)
check(read(os.path.join(FOLDER, "whole.exr")) == read(os.path.join(FOLDER, "resumed.exr")), "a killed render resumes to the same bytes")
check(not unfinished(FOLDER), "  nothing unfinished")

# --- signals ---------------------------------------------------------------------------------------------------------
out = os.path.join(FOLDER, "print.vdb")
put_old(out)
slow = [GCODE2VDB, gcode("hull.gcode"), "-o", out, "--voxel-size", "0.04"]
# The whole group gets the signal, as from a terminal; the shell stays to tell how its child ended.
shell = ["bash", "-c", 'trap : INT; "$@"; exit $?', "bash", *slow]
process = subprocess.Popen(shell, start_new_session=True, **QUIET)
while not writing(process.pid, FOLDER) and process.poll() is None:
    time.sleep(0.01)
os.killpg(process.pid, signal.SIGINT)
check(process.wait() == 130, f"SIGINT: a shell sees {process.returncode}")
check(read(out) == OLD and not unfinished(FOLDER), "  the old file stays, nothing unfinished")

# A reader that goes away. What the tool says may reach the pipe before the file is there, or at the very end.
process = subprocess.Popen(conversion(out), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
process.stdout.close()
process.wait()
check(process.returncode in (0, -signal.SIGPIPE), f"SIGPIPE ends it quietly: {process.returncode}")
check(read(out) == OLD or read(out) == whole_vdb, "  the old file stays, or a whole new one")
check(not unfinished(FOLDER), "  nothing unfinished")

# --- too little memory -------------------------------------------------------------------------------------------------
put_old(out)
# With a grid of attributes, which are made in memory; the level set alone needs little.
done = subprocess.run([*slow, "--grids", "layer"], capture_output=True, text=True,
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (400 << 20, 400 << 20)))
print("ulimit -v:", done.returncode, done.stderr.strip())
check(done.returncode in (1, 2) and "voxel" in done.stderr, "a memory limit: says what to do")
check(read(out) == OLD and not unfinished(FOLDER), "  the old file stays, nothing unfinished")

# --- a limit on the size of files, which any user can have --------------------------------------------------------------
done = subprocess.run(conversion(out), capture_output=True, text=True,
                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (50000, 50000)))
check(done.returncode in (1, -signal.SIGXFSZ), f"a limit on file sizes: {done.returncode} {done.stderr.strip()}")
check(read(out) == OLD and not unfinished(FOLDER), "  the old file stays, nothing unfinished")

# --- two runs on one output ----------------------------------------------------------------------------------------------
pair = [subprocess.Popen(conversion(out), **QUIET) for _ in range(2)]
check([process.wait() for process in pair] == [0, 0], "two runs on one output both end well")
subprocess.run(conversion(os.path.join(FOLDER, "alone.vdb")), check=True, **QUIET)
check(read(out) == read(os.path.join(FOLDER, "alone.vdb")), "  and one of them is there, whole")

# --- folders -------------------------------------------------------------------------------------------------------------
gone = os.path.join(FOLDER, "gone")
os.mkdir(gone)
process = subprocess.Popen([GCODE2VDB, gcode("hull.gcode"), "-o", os.path.join(gone, "x.vdb"), "--voxel-size", "0.08"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
while not writing(process.pid, gone) and process.poll() is None:
    time.sleep(0.01)
shutil.rmtree(gone)
_, text = process.communicate()
check(process.returncode == 1 and "x.vdb" in text, f"a folder that vanishes: {process.returncode} {text.strip()}")


def mounted(*options):
    """A small file system of memory; None if this user may not make one."""
    folder = tempfile.mkdtemp(dir=FOLDER)
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", folder], capture_output=True)
    return folder if done.returncode == 0 else None


full = mounted("size=64k")
if full is None:
    print("skipped: disk full, read-only folder (mount needs root)")
else:
    try:
        for name, command in (("vdb", conversion(os.path.join(full, "a.vdb"))), ("stl", conversion(os.path.join(full, "a.stl"))),
                              ("exr", [VDBTRACE, vdb, "-o", os.path.join(full, "a.exr"), "--size", "400x300", "--spp", "1"]),
                              ("png", [VDBTRACE, vdb, "-o", os.path.join(full, "a.png"), "--size", "640x480", "--spp", "1"])):
            put_old(os.path.join(full, "a." + name))
            done = subprocess.run(command, capture_output=True, text=True)
            print(f"disk full, .{name}")
            fails(done, "a." + name, "disk")
            check(read(os.path.join(full, "a." + name)) == OLD and not unfinished(full), "  the old file stays, nothing unfinished")
        subprocess.run(["mount", "-o", "remount,ro", full], check=True)
        done = subprocess.run(conversion(os.path.join(full, "a.vdb")), capture_output=True, text=True)
        print("read-only folder")
        fails(done, "a.vdb", "another place")
        check(read(os.path.join(full, "a.vdb")) == OLD, "  the old file stays")
    finally:
        subprocess.run(["umount", full], check=True)
shutil.rmtree(FOLDER)

"""The job scripts on a real Slurm of two nodes on this machine: tasks are killed and requeued, a node is drained, and the
merged picture and the film have the bytes of one process."""

import getpass
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time

from process_tree import adopt_orphans, descendants, end_descendants
from run_tools import BIN, SOURCE, Scratch, check, gcode, run

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "scancel")
SYSTEM = os.pathsep.join((os.environ.get("PATH", ""), "/usr/sbin", "/sbin"))
missing = [name for name in NEEDED if shutil.which(name, path=SYSTEM) is None]
if missing:
    print(f"skipped: {', '.join(missing)}: not installed; scripts/packages.sh has the packages")
    sys.exit(77)  # SKIP_RETURN_CODE of CTest

SCRATCH = Scratch("slurm")
FOLDER, path, same = SCRATCH.folder, SCRATCH.path, SCRATCH.same
# munged refuses a socket in a folder that others may not enter.
os.chmod(FOLDER, 0o755)
SCRIPTS = os.path.join(SOURCE, "scripts", "slurm")
VDBTRACE = os.path.join(BIN, "vdbtrace")
VDBMERGE = os.path.join(BIN, "vdbmerge")
TILE = gcode("tile.gcode")
PICTURE = ["--size", "256x192", "--voxels-per-layer", "2", "--spp", "64"]
FILM = ["--size", "96x72", "--voxels-per-layer", "2", "--spp", "32", "--turntable", "12"]
TASKS = 8
LONGEST = 180  # seconds that anything is waited for; it takes a tenth of that
# A requeued job waits for as long as a credential of its first run is valid: two minutes, if nothing is said.
CREDENTIAL = 6


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def configure():
    host = socket.gethostname().split(".")[0]
    control, *nodes = free_ports(3)
    lines = [
        "ClusterName=stratum", f"SlurmctldHost={host}(127.0.0.1)", f"SlurmUser={getpass.getuser()}",
        f"SlurmdUser={getpass.getuser()}", f"SlurmctldPort={control}", "AuthType=auth/munge", "CryptoType=crypto/munge",
        f"AuthInfo=socket={path('munge.socket')},cred_expire={CREDENTIAL}", "MpiDefault=none", "ReturnToService=2",
        "ProctrackType=proctrack/linuxproc", "TaskPlugin=task/none", "JobAcctGatherType=jobacct_gather/none",
        "SelectType=select/cons_tres", "SlurmdParameters=config_overrides", "SchedulerParameters=sched_interval=1",
        "KillWait=2", "SwitchType=switch/none",
        f"StateSaveLocation={path('state')}", f"SlurmctldPidFile={path('slurmctld.pid')}",
        f"SlurmdSpoolDir={path('spool.%n')}", f"SlurmdPidFile={path('slurmd.%n.pid')}",
        *(f"NodeName=n{n} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1" for n, port in enumerate(nodes, 1)),
        "PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP"]
    with open(path("slurm.conf"), "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    with open(path("cgroup.conf"), "w", encoding="ascii") as file:
        file.write("CgroupPlugin=cgroup/v1\n")
    with open(path("munge.key"), "wb") as file:
        file.write(os.urandom(128))
    os.chmod(path("munge.key"), 0o400)
    for name in ("state", "spool.n1", "spool.n2"):
        os.mkdir(path(name))


# Of an array that this test may itself be a task of, nothing is inherited.
ENVIRONMENT = {name: value for name, value in os.environ.items() if not re.match("SLURM_|SBATCH_", name)}
ENVIRONMENT.update(PATH=SYSTEM, SLURM_CONF=path("slurm.conf"), STRATUM_BIN=BIN)


def start(*command):
    log = open(path(os.path.basename(command[0]) + ".out"), "ab")
    subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, cwd=FOLDER, env=ENVIRONMENT)


def ask(*command, may_fail=False):
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=FOLDER, env=ENVIRONMENT)
    if done.returncode != 0 and not may_fail:
        raise RuntimeError(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout.strip()


def wait_for(what, holds):
    end = time.monotonic() + LONGEST
    while not holds():
        if time.monotonic() > end:
            raise RuntimeError(f"waited {LONGEST} s for {what}\n" + ask("squeue", "--array", may_fail=True))
        time.sleep(0.1)


def tasks(job):
    """Task -> (state, node, reason) of an array, those that have ended too; other jobs are task 0."""
    found = {}
    for text in ask("scontrol", "--oneliner", "show", "job", job).splitlines():
        field = dict(word.split("=", 1) for word in text.split() if "=" in word)
        number = field.get("ArrayTaskId", "0")
        if number.isdigit():  # else those that wait together
            found[int(number)] = (field["JobState"], field["NodeList"], field["Reason"])
    return found


def state(job, task=0):
    return tasks(job).get(task, ("PENDING", "", ""))[0]


def finished(job, count=1):
    now = tasks(job)
    failed = {number: task for number, task in now.items() if task[0] in ("FAILED", "CANCELLED", "NODE_FAIL", "TIMEOUT")}
    if failed or any("NeverSatisfied" in task[2] for task in now.values()):
        raise RuntimeError(f"job {job}: {now}")
    return sum(task[0] == "COMPLETED" for task in now.values()) == count


def submit(*options):
    return ask("sbatch", "--parsable", "--cpus-per-task=1", "--output", path("job.%j.out"), *options)


def kill_program(task):
    """Kills vdbtrace of a task, as the kernel does when memory is short; False if the task has not started it yet."""
    for process in descendants():
        try:
            with open(f"/proc/{process}/cmdline", "rb") as line, open(f"/proc/{process}/environ", "rb") as environment:
                started = line.read().startswith(VDBTRACE.encode() + b"\0")
                if started and f"SLURM_ARRAY_TASK_ID={task}".encode() in environment.read().split(b"\0"):
                    os.kill(process, signal.SIGKILL)
                    return True
        except OSError:
            pass  # it ended
    return False


def start_slurm():
    configure()
    start("munged", "--foreground", "--force", "--key-file", path("munge.key"), "--socket", path("munge.socket"),
          "--pid-file", path("munged.pid"), "--log-file", path("munged.log"), "--seed-file", path("munged.seed"))
    wait_for("munged", lambda: os.path.exists(path("munge.socket")))
    start("slurmctld", "-D", "-f", path("slurm.conf"))
    for node in ("n1", "n2"):
        start("slurmd", "-D", "-N", node, "-f", path("slurm.conf"))
    wait_for("two idle nodes", lambda: ask("sinfo", "-h", "-t", "idle", "-o", "%D", may_fail=True) == "2")
    print("ok: a Slurm of two nodes")


def picture():
    """An array of eight tiles. Task 0 is killed and requeued while it runs; then a node is drained."""
    job = submit(f"--array=0-{TASKS - 1}", os.path.join(SCRIPTS, "picture.sh"), TILE, *PICTURE, "-o", "part.png")
    merge = submit(f"--dependency=afterok:{job}", "--wrap", f"{VDBMERGE} merged.png part.*of{TASKS}.exr --quiet")
    for task in (0, 1):
        wait_for(f"task {task} to run", lambda: state(job, task) == "RUNNING")
    check({task[1] for task in tasks(job).values()} >= {"n1", "n2"}, "the tasks run on both nodes")
    ask("scontrol", "requeue", f"{job}_0")
    check(not os.path.exists(path(f"part.0of{TASKS}.exr")), "task 0 is killed, leaves no part, and is requeued")

    wait_for("a task on n2 that is finished", lambda: ("COMPLETED", "n2") in {task[:2] for task in tasks(job).values()})
    ask("scontrol", "update", "NodeName=n2", "State=DRAIN", "Reason=test")
    before = {number for number, task in tasks(job).items() if task[0] in ("RUNNING", "COMPLETED", "COMPLETING")}
    check(0 not in before and len(before) < TASKS - 1, f"n2 is drained when {len(before)} of {TASKS} tasks are started")
    check(tasks(merge)[0][::2] == ("PENDING", "Dependency"), "  and the merge waits")
    wait_for("the array", lambda: finished(job, TASKS))
    after = {number: task[1] for number, task in tasks(job).items() if number not in before}
    check(set(after.values()) == {"n1"}, f"the other {len(after)} run on n1, task 0 among them")
    wait_for("the merge", lambda: finished(merge))
    check(same("merged.png", "whole.png"), f"a picture of {TASKS} tasks has the bytes of one process")


def film():
    """Four tasks of three pictures. Task 0 fails after its first picture, is requeued, and makes the other two."""
    ask("scontrol", "update", "NodeName=n2", "State=RESUME")
    os.mkdir(path("film"))
    job = submit("--array=0-3", os.path.join(SCRIPTS, "film.sh"), TILE, *FILM, "-o", "film/f.png")
    after = submit(f"--dependency=afterok:{job}", "--wrap", "true")
    wait_for("the first picture", lambda: os.path.exists(path("film/f_000.png")))
    wait_for("the program of task 0", lambda: kill_program(0))
    wait_for("task 0 to fail", lambda: state(job, 0) == "FAILED")
    first = os.stat(path("film/f_000.png")).st_ino
    ask("scontrol", "requeue", f"{job}_0")
    wait_for("the film", lambda: finished(job, 4))
    check(os.stat(path("film/f_000.png")).st_ino == first, "a task that fails and is requeued goes on where it was")
    check({task[1] for task in tasks(job).values()} == {"n1", "n2"}, "n2 is resumed, the film is of both nodes")
    names = [f"f_{n:03}.png" for n in range(12)]
    check([name for name in sorted(os.listdir(path("film"))) if name.endswith(".png")] == names, "the film has 12 pictures")
    check(all(same(f"film/{name}", f"one/{name}") for name in names), "  of the bytes of one process")
    wait_for("what depends on it", lambda: "NeverSatisfied" in tasks(after)[0][2])
    ask("scontrol", "update", f"JobId={after}", f"Dependency=afterany:{job}")
    wait_for("what depends on it, after the update", lambda: state(after) == "COMPLETED")
    print("ok: afterok counts a failure that was repaired, afterany does not")


def show_logs():
    for name in sorted(os.listdir(FOLDER)):
        if name.endswith((".log", ".out")):
            with open(path(name), encoding="utf-8", errors="replace") as file:
                print(f"--- {name}\n{''.join(file.readlines()[-20:])}", file=sys.stderr)


adopt_orphans()  # jobs outlive the daemon that starts them: they must be found when it is gone
begin = time.monotonic()
done = False
try:
    start_slurm()
    os.mkdir(path("one"))
    run(VDBTRACE, TILE, *PICTURE, "-o", path("whole.png"), "--quiet")
    run(VDBTRACE, TILE, *FILM, "-o", path("one/f.png"), "--quiet")
    picture()
    film()
    done = True
finally:
    if not done:
        show_logs()
    end_descendants()
    shutil.rmtree(FOLDER)
print(f"ok: nothing is left running, after {time.monotonic() - begin:.0f} s")

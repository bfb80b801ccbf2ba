"""A watched folder: prints get their thumbnails and move on, other files are refused with their reason; the units are valid."""

import os
import re
import shutil
import subprocess
import tempfile
import time

from run_tools import BIN, SOURCE, check, gcode

FARM = os.path.join(SOURCE, "data", "print_farm")
FOLDER = tempfile.mkdtemp(prefix="stratum_farm_")
INCOMING = os.path.join(FOLDER, "incoming")
ENVIRONMENT = dict(os.environ, PATH=f"{BIN}:{os.environ['PATH']}", STRATUM_THUMBNAILS="32x32")


def names(folder):
    return sorted(os.listdir(os.path.join(FOLDER, folder)))


def arrive(name, source=None, text="", age=10):
    path = os.path.join(INCOMING, name)
    if source:
        shutil.copyfile(source, path)
    else:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
    os.utime(path, (time.time() - age,) * 2)


def one_round():
    done = subprocess.run([os.path.join(FARM, "stratum-thumbnails"), FOLDER], env=ENVIRONMENT, capture_output=True, text=True)
    check(done.returncode == 0 and done.stderr == "", f"a round: {done.stderr}")


os.mkdir(INCOMING)
tile = gcode("tile.gcode")
arrive("tile.gcode", tile)
arrive("a name with $(spaces) & more.gcode", tile)
arrive("-rf", tile)
arrive("letter.gcode", text="Dear printer,\nprint me.\n")
arrive("half.gcode.part", tile)
arrive("just now.gcode", tile, age=0)
one_round()
good = ["-rf", "a name with $(spaces) & more.gcode", "tile.gcode"]
check(names("ready") == good, f"ready: {names('ready')}")
check(names("refused") == ["letter.gcode", "letter.gcode.txt"], f"refused: {names('refused')}")
check(names("incoming") == ["half.gcode.part", "just now.gcode"], f"left: {names('incoming')}")
with open(os.path.join(FOLDER, "refused", "letter.gcode.txt"), encoding="utf-8") as file:
    check("letter.gcode" in file.read(), "  with the reason")
for name in good:
    with open(os.path.join(FOLDER, "ready", name), encoding="utf-8") as file:
        written = file.read()
    with open(tile, encoding="utf-8") as file:
        moves = [line for line in file.read().splitlines() if re.match("G[0-3] ", line)]
    check("thumbnail begin 32x32" in written and [l for l in written.splitlines() if re.match("G[0-3] ", l)] == moves,
          f"{name} has its picture and its moves")

# The same name again, complete now.
arrive("tile.gcode", tile)
os.rename(os.path.join(INCOMING, "half.gcode.part"), os.path.join(INCOMING, "half.gcode"))
arrive("just now.gcode", tile)
one_round()
check(len(names("ready")) == 5 and names("incoming") == [], f"a second round: {names('ready')}")

if shutil.which("systemd-analyze"):
    units = os.path.join(FOLDER, "units")
    os.mkdir(units)
    for kind in ("path", "service"):
        with open(os.path.join(FARM, f"stratum-thumbnails@.{kind}"), encoding="utf-8") as file:
            text = file.read()
        # It looks for programs in the system's folders alone.
        text = text.replace("ExecStart=stratum-thumbnails", f"ExecStart={FARM}/stratum-thumbnails")
        with open(os.path.join(units, f"stratum-thumbnails@.{kind}"), "w", encoding="utf-8") as file:
            file.write(text)
    done = subprocess.run(["systemd-analyze", "verify", "--man=no", os.path.join(units, "stratum-thumbnails@srv-prints.path"),
                           os.path.join(units, "stratum-thumbnails@srv-prints.service")], capture_output=True, text=True)
    check(done.returncode == 0 and "stratum" not in done.stderr, f"systemd takes the units: {done.stderr}")
else:
    print("systemd is not there: its check of the units was left out")
shutil.rmtree(FOLDER)

"""Progress on a terminal: every long step has a line of its own, and nothing is left of it among what is said."""

import fcntl
import os
import pty
import re
import shutil
import struct
import subprocess
import tempfile
import termios

from run_tools import BIN, check, gcode

FOLDER = tempfile.mkdtemp(prefix="stratum_progress_")
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
VDBTRACE = os.path.join(BIN, "vdbtrace")
SMALL = ["--size", "64x48", "--spp", "1"]


def on_terminal(*command, columns=80):
    """All that the command writes to a terminal of so many columns."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, cwd=FOLDER)
    os.close(theirs)
    parts = []
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:  # the terminal is gone: its last writer has ended
            break
        if not part:
            break
        parts.append(part)
    os.close(ours)
    text = b"".join(parts).decode()
    check(process.wait() == 0, f"{' '.join(map(os.path.basename, command))}: {process.returncode} {text}")
    return text


def screen(text):
    """The lines as a person sees them in the end."""
    lines = []
    for raw in text.split("\n"):
        line = ""
        column = 0
        for piece in re.findall(r"\r|\x1b\[K|[^\r\x1b]", raw):
            if piece == "\r":
                column = 0
            elif piece == "\x1b[K":
                line = line[:column]
            else:
                line = line[:column] + piece + line[column + 1:]
                column += 1
        lines.append(line)
    return lines


def steps(text):
    """The labels of the lines that were shown, in their order, each run once."""
    labels = re.findall(r"\r\x1b\[K([a-z]+(?: [a-z]+)*)", text)
    return [label for n, label in enumerate(labels) if n == 0 or labels[n - 1] != label]


def clean(text, quiet):
    seen = [line for line in screen(text) if line]
    said = [line for line in quiet.splitlines() if line]
    check(not any("━" in line or "─" in line for line in seen), "  no bar is left")
    check(len(seen) == len(said), f"  what is said is as without a terminal: {seen} {said}")
    # Times differ from run to run; what goes to two streams comes in another order where neither is a terminal.
    plain = [sorted(re.sub(r"[0-9.]+", "", line) for line in lines) for lines in (seen, said)]
    check(plain[0] == plain[1], "  line by line")


def piped(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=FOLDER)
    check("\x1b" not in done.stdout and "\r" not in done.stdout, "no progress where there is no terminal")
    return done.stdout


shutil.copy(gcode("tile.gcode"), os.path.join(FOLDER, "tile.gcode"))
for command, expected in (
        ([GCODE2VDB, "tile.gcode", "--voxel-size", "0.2", "--grids", "layer,color", "--stats", "s.json"],
         ["reading", "voxelizing", "grids", "writing", "measuring"]),
        ([GCODE2VDB, "tile.gcode", "--voxel-size", "0.2", "-o", "tile.stl"], ["reading", "voxelizing", "meshing", "writing"]),
        ([GCODE2VDB, "tile.gcode", "--voxel-size", "0.2", "--interior-distance"], ["reading", "voxelizing", "distances", "writing"]),
        ([VDBTRACE, "tile.vdb", *SMALL], ["loading", "laying out", "preparing", "rendering", "writing"]),
        ([VDBTRACE, "tile.gcode", *SMALL, "--voxel-size", "0.2"], ["reading", "preparing", "rendering", "writing"])):
    text = on_terminal(*command)
    check([step for step in steps(text) if step in expected] == expected, f"  shows {steps(text)}")
    check(text.rstrip("\n").rfind("\r\x1b[K") >= text.rfind("writing"), "  the last line is cleared")
    clean(text, piped(*command))
# What fills the last column wraps, and what wraps is not cleared.
for columns in (1, 12, 40, 80):
    for command in ([VDBTRACE, "tile.gcode", "--size", "320x240", "--spp", "16", "--no-denoise", "--voxel-size", "0.2"],
                    [GCODE2VDB, "tile.gcode", "--voxel-size", "0.2", "--interior-distance"]):
        text = on_terminal(*command, columns=columns)
        lines = re.findall(r"\r\x1b\[K([^\r\x1b]*)(?=\r\x1b)", text)
        check(lines and max(map(len, lines)) < max(2, columns), f"{columns} columns: at most {max(map(len, lines))}")
        if columns >= 40 and command[0] == VDBTRACE:
            check(any("━" in line and line.endswith("s left") for line in lines), "  with a bar and what is left")
check("\x1b" not in on_terminal(GCODE2VDB, "tile.gcode", "--voxel-size", "0.2", "--quiet"), "--quiet: nothing")
shutil.rmtree(FOLDER)

"""What the client tests share: paths and running the project's tools."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.environ["STRATUM_BIN"]


def skip_without(programs=(), modules=()):
    """Ends the test as skipped, and says why, unless these programs and Python modules are there. Debian's modules are
    for Debian's interpreter, which need not be the first one: the test is begun again with that."""
    absent = [name for name in modules if importlib.util.find_spec(name) is None]
    if absent and sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
        sys.stdout.flush()
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])
    absent += [name for name in programs if shutil.which(name) is None]
    if absent:
        print(f"skipped: {', '.join(absent)}: not installed; scripts/packages.sh has the packages")
        sys.exit(77)  # SKIP_RETURN_CODE of CTest


def run(*command):
    """Runs a command, returns its standard output, and shows everything if it fails."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def gcode(name):
    return os.path.join(SOURCE, "data", "gcode", name)


def corpus(name):
    """A real G-code file of the corpus; None, and a word of it, if it is not there."""
    folder = os.environ.get("STRATUM_CORPUS", os.path.join(SOURCE, "..", "shared", "corpus"))
    path = os.path.join(folder, "gcode", name)
    if os.path.exists(path):
        return path
    print(f"skipped: corpus file {name} is not there")
    return None


def convert(source, *options):
    """Converts G-code in a fresh folder; returns the .vdb and the report."""
    folder = tempfile.mkdtemp(prefix="stratum_client_")
    vdb = os.path.join(folder, "print.vdb")
    report = run(os.path.join(BIN, "gcode2vdb"), source, "-o", vdb, "--stats", "-", *options)
    return vdb, json.loads(report)


def write_box(path, x, y, z):
    """A box from the origin as ASCII STL: two triangles a face."""
    corners = [(a, b, c) for a in (0, x) for b in (0, y) for c in (0, z)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    with open(path, "w", encoding="ascii") as file:
        file.write("solid box\n")
        for a, b, c, d in faces:
            for triangle in ((a, b, c), (a, c, d)):
                file.write("facet normal 0 0 0\nouter loop\n")
                for corner in triangle:
                    file.write("vertex %g %g %g\n" % corners[corner])
                file.write("endloop\nendfacet\n")
        file.write("endsolid box\n")


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)
    print("ok: " + text)


class Scratch:
    """A folder of the test's own, and what is done in it. `tool`: words in front of each call."""

    def __init__(self, name, *tool):
        self.kept = tempfile.TemporaryDirectory(prefix=f"stratum_{name}_")  # goes with the process
        self.folder = self.kept.name
        self.tool = tool

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def same(self, one, other):
        return self.read(one) == self.read(other)

    def contents(self):
        return {name: self.read(name) for name in os.listdir(self.folder) if os.path.isfile(self.path(name))}

    def call(self, *command, text=True, **options):
        return subprocess.run([*self.tool, *command], capture_output=True, text=text, errors="replace" if text else None,
                              timeout=300, cwd=self.folder, **options)

    def does(self, *command, **options):
        done = self.call(*command, **options)
        check(done.returncode == 0, f"{' '.join(map(os.path.basename, command))}: {done.returncode} {done.stderr.strip()}")
        return done

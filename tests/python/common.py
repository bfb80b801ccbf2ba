"""What the tests of the Python module share."""

import os
import subprocess
import sys
import tempfile

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.environ["STRATUM_BIN"]
sys.path.append(os.path.join(SOURCE, "tests", "clients"))  # png_file
CORPUS = os.environ.get("STRATUM_CORPUS", os.path.join(os.path.dirname(SOURCE), "shared", "corpus"))
SCRATCH = tempfile.TemporaryDirectory(prefix="stratum_python_")  # goes with the process
FOLDER = SCRATCH.name


def path_of(name):
    return os.path.join(FOLDER, name)


def gcode(name):
    return os.path.join(SOURCE, "data", "gcode", name)


def tool(name, *arguments):
    """Runs a tool; returns its standard output."""
    done = subprocess.run([os.path.join(BIN, name), *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{name} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def python(code, *arguments, **environment):
    """Runs Python with this module; returns the finished process."""
    return subprocess.run([sys.executable, "-c", code, *map(str, arguments)], capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})


def read_bytes(path):
    with open(path, "rb") as file:
        return file.read()

"""What the client tests share: paths and running the project's tools."""

import json
import os
import subprocess
import sys
import tempfile

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.environ["STRATUM_BIN"]


def run(*command):
    """Runs a command, returns its standard output, and shows everything if it fails."""
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)} ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def gcode(name):
    return os.path.join(SOURCE, "data", "gcode", name)


def convert(source, *options):
    """Converts G-code in a fresh folder; returns the .vdb and the report."""
    folder = tempfile.mkdtemp(prefix="stratum_client_")
    vdb = os.path.join(folder, "print.vdb")
    report = run(os.path.join(BIN, "gcode2vdb"), source, "-o", vdb, "--stats", "-", *options)
    return vdb, json.loads(report)


def check(condition, text):
    if not condition:
        sys.exit("FAILED: " + text)
    print("ok: " + text)

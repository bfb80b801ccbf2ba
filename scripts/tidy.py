#!/usr/bin/env python3
"""clang-tidy over the units that are named on standard input, one a line. Usage: tidy.py BUILD_FOLDER

Most of a unit's time goes to headers. So units of one folder are written one after the other into one file, and that is
analysed; when anything is found in it, or when two of them use one name, each is analysed by itself, and what is found
then counts. Exit status 1 if there is a finding.
"""

import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MOST = 12  # units in a file
CLANG = ["--quiet"]


def batches(units, commands):
    """Lists of units that may stand in one file: of one folder and one target."""
    result, open_ones = [], {}
    for unit in units:
        with open(os.path.join(ROOT, unit), encoding="utf-8") as file:
            alone = "foreach_target.h" in file.read()  # includes itself, once a target
        if alone or unit not in commands:
            result.append([unit])
            continue
        key = (os.path.dirname(unit), tuple(commands[unit]))
        if key not in open_ones or len(open_ones[key]) == MOST:
            open_ones[key] = []
            result.append(open_ones[key])
        open_ones[key].append(unit)
    return result


def main(build):
    units = [line.strip() for line in sys.stdin if line.strip()]
    commands = {}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        for entry in json.load(file):
            words = shlex.split(re.sub(r" -o \S+ -c \S+", "", entry["command"]))[1:]
            commands[os.path.relpath(entry["file"], ROOT)] = words
    os.makedirs(os.path.join(build, "batches"), exist_ok=True)

    def alone(unit):
        done = subprocess.run(["clang-tidy", "-p", build, *CLANG, unit], cwd=ROOT, capture_output=True, text=True)
        return done.stdout if done.returncode else ""

    def check(numbered):
        number, batch = numbered
        if len(batch) > 1:
            path = os.path.join(build, "batches", f"{number}.cpp")
            with open(path, "w", encoding="utf-8") as out:
                for unit in batch:
                    with open(os.path.join(ROOT, unit), encoding="utf-8") as file:
                        out.write(file.read())
            done = subprocess.run(["clang-tidy", *CLANG, path, "--", *commands[batch[0]], "-I" + os.path.dirname(batch[0])],
                                  cwd=ROOT, capture_output=True, text=True)
            if done.returncode == 0:
                return []
        return [found for found in map(alone, batch) if found]

    failed = False
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(check, enumerate(batches(units, commands))):
            failed = failed or bool(found)
            print("".join(found), end="", flush=True)
    sys.exit(1 if failed else 0)


main(os.path.abspath(sys.argv[1]))

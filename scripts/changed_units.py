"""Prints the units (.cpp of src and tools) that clang-tidy must see anew since a commit: those that changed, and for each
header that changed one unit that includes it, for a header's findings show in any of them. All units, if the commit is
unknown here (a shallow clone) or if .clang-tidy changed. Usage: changed_units.py COMMIT"""

import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True, text=True).stdout.split("\n")


def includes_of(path):
    """Files of this project that a file includes, relative to the root."""
    found = []
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        for name in re.findall(r'^#include "([^"]+)"', file.read(), re.MULTILINE):
            for folder in ("src", "tools", "tools/command_line", os.path.dirname(path)):
                candidate = os.path.normpath(os.path.join(folder, name))
                if os.path.exists(os.path.join(ROOT, candidate)):
                    found.append(candidate)
                    break
    return found


def includers(headers, files):
    """header -> units that include it, directly or not."""
    direct = {path: includes_of(path) for path in files}
    result = {header: [] for header in headers}
    for unit in (path for path in files if path.endswith(".cpp")):
        seen, todo = set(), [unit]
        while todo:
            for name in direct.get(todo.pop(), []):
                if name not in seen:
                    seen.add(name)
                    todo.append(name)
        for header in headers & seen:
            result[header].append(unit)
    return result


def main(commit):
    files = [path for path in git("ls-files", "src", "tools") if path.endswith((".cpp", ".h"))]
    units = [path for path in files if path.endswith(".cpp")]
    try:
        changed = set(git("diff", "--name-only", commit, "--"))
    except subprocess.CalledProcessError:
        return units
    if ".clang-tidy" in changed:
        return units
    wanted = changed & set(units)
    headers = {path for path in changed & set(files) if path.endswith(".h")}
    for header, candidates in includers(headers, files).items():
        if candidates and not wanted.intersection(candidates):
            stem = os.path.splitext(header)[0]
            wanted.add(min(candidates, key=lambda unit: (not stem.startswith(os.path.splitext(unit)[0]), unit)))
    return sorted(wanted)


if __name__ == "__main__":
    print("\n".join(main(sys.argv[1])))

"""Prints a regular expression for ctest -E: the suites of which nothing changed since a commit, and nothing if there is none.
Usage: unchanged_suites.py [--programs] [COMMIT]; without a commit, the one that scripts/checked_commit names. With
--programs the test programs of rooms that do run, as a list for CMake's STRATUM_TEST_PROGRAMS, instead; "none" if there is none.

- A room's suites are left out if no file of the room, of the rooms that it includes, or of its tests changed.
- Programs that take long are left out if nothing changed of what they test: LONG says where that is. All tools are linked
  from nearly all rooms, so this is a choice, not a proof: scripts/test.sh without arguments runs them all.

Nothing is left out if the commit is unknown here (a shallow clone), or if something changed that all of them share."""

import glob
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Nothing that a suite runs depends on these, but for the programs in LONG that name them.
APART = (".ci/", "docs/", "bench/", "examples/", "scripts/", "tools/", "tests/clients/", "tests/python/", "tests/house_test.py",
         "tests/pages_test.py", "tests/counts_test.py", "tests/suites_test.py", ".clang-tidy", ".gitignore", "NOTICE",
         "LICENSE")
SHARED = ("scripts/packages.sh",)
# Executables of tests/CMakeLists.txt whose tests lie in the folder of another room.
FOLDER_OF = {"prints": "voxelize", "march_long": "march"}

VIEWER = ("src/view/", "src/serve/", "src/assemble/", "tools/vdbview.cpp")
FILES = ("src/base/", "src/gcode/", "src/march/file/", "src/export/", "src/shade/measured/", "src/shade/environment/",
         "src/shade/film/", "src/assemble/", "src/compare/", "src/deposit/", "tools/")
SHARDS = ("src/animate/", "src/assemble/", "src/shade/film/", "src/base/", "tools/vdbtrace.cpp", "tools/vdbmerge.cpp",
          "scripts/slurm/")
PACKAGES = ("tools/", "scripts/bind_own_functions.py", "examples/", "src/python/", "NOTICE")
LONG = {
    "Client.view_own": VIEWER,
    "Client.view_moves": VIEWER,
    "Client.view_keys": VIEWER,
    "Client.view_panel": VIEWER,
    "Client.view_faults": VIEWER,
    "Client.view_memory": VIEWER,
    "Client.view_soak": VIEWER,
    "Client.packages": PACKAGES,
    "Client.install": (*PACKAGES, "docs/"),
    "Client.mutation": FILES,
    "Client.hostile": FILES,
    "Client.film": SHARDS,
    "Client.shard": SHARDS,
    "Client.slurm": SHARDS,
    "Client.elements": ("src/mechanics/", "src/voxelize/", "tools/gcode2vdb.cpp"),
    "Studies": ("src/study/", "tools/vdbstudy.cpp", "scripts/study.sh", "scripts/studies_page.py"),
}
LONG["Client.studies"] = LONG["Studies"]


def changed_since(commit):
    """Paths, None if they cannot be told."""
    try:
        return [path for words in (("diff", "--name-only", commit, "--"), ("ls-files", "--others", "--exclude-standard"))
                for path in subprocess.run(["git", "-C", ROOT, *words], check=True, capture_output=True,
                                           text=True).stdout.split("\n") if path]
    except (OSError, subprocess.CalledProcessError):
        return None


def includes(folder):
    """The rooms that the sources in a folder include."""
    found = set()
    for place, _, names in os.walk(os.path.join(ROOT, folder)):
        for name in names:
            if name.endswith((".cpp", ".h")):
                with open(os.path.join(place, name), encoding="utf-8") as file:
                    found.update(re.findall(r'^#include "(\w+)/', file.read(), re.M))
    return found


def below(rooms):
    """For each room all that its sources include, directly or not, with itself."""
    direct = {room: includes(f"src/{room}") & rooms for room in rooms}

    def closure(room):
        seen, todo = {room}, [room]
        while todo:
            new = direct[todo.pop()] - seen
            seen |= new
            todo += new
        return seen

    return {room: closure(room) for room in rooms}


def changed_rooms(paths, rooms):
    """Those of whose own files or tests one changed; all, if something changed that is of no room."""
    found = set()
    for path in paths:
        of_room = re.match(r"(?:src|tests)/(\w+)/", path)
        if path.endswith(".md") or (path.startswith(APART) and not path.startswith(SHARED)):
            continue
        # Headers of tests are included by those of other rooms.
        if of_room is None or of_room[1] not in rooms or (path.startswith("tests/") and path.endswith(".h")):
            return set(rooms)
        found.add(of_room[1])
    return found


def programs(changed, rooms):
    """(those to which a change of these rooms can matter, the others): test programs by the names of their suites."""
    sources = below(rooms)
    tested = {room for room in rooms if glob.glob(os.path.join(ROOT, "tests", room, "**", "*_test.cpp"), recursive=True)}
    run, left_out = [], []
    for program in sorted(tested | FOLDER_OF.keys()):
        room = FOLDER_OF.get(program, program)
        used = set().union(*(sources[other] for other in (includes(f"tests/{room}") & rooms) | {room}))
        (run if used & changed else left_out).append(program)
    return run, left_out


def unchanged(paths, rooms):
    """Patterns of the names of suites."""
    changed = changed_rooms(paths, rooms)
    if changed == rooms:
        return []
    patterns = [rf"{program}\..*" for program in programs(changed, rooms)[1]]
    # What the programs of tests/clients import may be of all of them.
    if not any(path.startswith("tests/clients/") and not path.endswith("_test.py") for path in paths):
        patterns += [re.escape(name) for name, places in LONG.items()
                     if not any(path.startswith((*places, f"tests/clients/{name.split('.')[-1].lower()}_test.py"))
                                for path in paths)]
    return patterns


def main(commit, only_programs):
    rooms = {name for name in os.listdir(os.path.join(ROOT, "src")) if os.path.isdir(os.path.join(ROOT, "src", name))}
    paths = changed_since(commit)
    if only_programs:
        print(";".join(programs(rooms if paths is None else changed_rooms(paths, rooms), rooms)[0]) or "none")
    elif patterns := unchanged(paths, rooms) if paths is not None else []:
        print(f"Suites of which nothing changed since {commit} are left out: {', '.join(patterns)}", file=sys.stderr)
        print(f"^({'|'.join(patterns)})$")


if __name__ == "__main__":
    with open(os.path.join(ROOT, "scripts", "checked_commit"), encoding="utf-8") as checked:
        given = [word for word in sys.argv[1:] if word != "--programs"]
        main(given[0] if given else checked.read().strip(), "--programs" in sys.argv)

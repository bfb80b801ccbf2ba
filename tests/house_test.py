"""The house keeps its order: arrows between rooms run one way; folders and functions stay small; docs name files that exist."""

import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Which rooms a room may include from. march and voxelize meet only in openvdb::FloatGrid and, brick by brick, in
# ondemand; shade knows the seam, trace, and nobody who is behind it.
MAY_INCLUDE = {
    "base": set(),
    "vdb": set(),  # not to be included from: part of the precompiled headers
    "gcode": {"base"},
    "motion": {"base", "gcode"},
    "deposit": {"base", "gcode", "motion"},
    "voxelize": {"base", "gcode"},
    "export": {"base", "gcode", "voxelize"},
    "report": {"base", "gcode", "motion", "voxelize"},
    "compare": {"base", "export"},
    "mechanics": {"base", "gcode", "voxelize"},
    "trace": {"base"},
    "march": {"base", "trace"},
    "ondemand": {"base", "gcode", "voxelize", "trace", "march"},
    "shade": {"base", "trace"},
    "assemble": {"base", "gcode", "motion", "deposit", "voxelize", "trace", "march", "ondemand", "shade"},
    "animate": {"base", "trace", "shade", "assemble"},
    "serve": {"base"},
    "python": {"compare", "report", "base", "gcode", "motion", "deposit", "voxelize", "export", "trace", "march", "ondemand", "shade", "assemble"},
    "view": {"base", "gcode", "voxelize", "trace", "march", "ondemand", "shade", "assemble", "serve"},
    "study": {"base", "gcode", "motion", "deposit", "voxelize", "export", "report", "trace", "march", "ondemand", "shade", "assemble"},
}
WITHOUT_OPENVDB = {"base", "gcode", "motion", "deposit", "trace", "shade", "serve"}
MOST_FILES = 30  # of code, in one folder
MOST_FUNCTION_LINES = 80
OF_OTHERS = {"bbs_3mf.cpp"}  # sources of other projects, named as ours are

# Folders of one room that include from each other: a layer stack owns the field of its swell, whose sums are over columns
# of leaves, which ask it. No others may.
BOTH_WAYS = {("voxelize/beads", "voxelize/swell"), ("voxelize/leaf", "voxelize/swell")}

problems = []
files = 0
includes = set()  # of folders: from, to


def indent(line):
    return len(line) - len(line.lstrip())


def functions(lines):
    """(line number, lines, first line) of functions and methods, by the indents that clang-format gives them."""
    for end, line in enumerate(lines):
        if line.strip() != "}" or indent(line) not in (0, 4):
            continue
        begin = end - 1
        while begin >= 0 and (not lines[begin].strip() or indent(lines[begin]) > indent(line)):
            begin -= 1
        first = lines[begin].strip()
        if begin < 0 or "(" not in first or indent(lines[begin]) != indent(line):
            continue
        if not re.match(r"namespace|class|struct|enum|union|extern|public|private|#|//|}", first):
            yield begin + 1, end - begin + 1, first


def check_functions(place, lines):
    for number, length, first in functions(lines):
        if length > MOST_FUNCTION_LINES:
            problems.append(f"{place}:{number}: {length} lines in one function, {first}")


for room, allowed in MAY_INCLUDE.items():
    for folder, _, names in os.walk(os.path.join(ROOT, "src", room)):
        place = os.path.relpath(folder, ROOT)
        names = sorted(name for name in names if name.endswith((".h", ".cpp")))
        if len(names) > MOST_FILES:
            problems.append(f"{place}: {len(names)} files; divide them")
        for name in names:
            files += 1
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                lines = file.read().splitlines()
            check_functions(f"{place}/{name}", lines)
            # Headers that Highway includes once a target have guards that toggle.
            guard = any("HWY_TARGET_TOGGLE" in line for line in lines) if name.endswith("-inl.h") else "#pragma once" in lines
            if name.endswith(".h") and not guard:
                problems.append(f"{place}/{name}: no include guard")
            for number, line in enumerate(lines, 1):
                match = re.match(r'#include "(\w+)/', line)
                if match and match.group(1) == room:
                    includes.add((place[len("src/"):], os.path.dirname(line.split('"')[1])))
                if match and match.group(1) != room and match.group(1) not in allowed:
                    problems.append(f"{place}/{name}:{number}: {room} must not include from {match.group(1)}")
                if room in WITHOUT_OPENVDB and re.match(r"#include <openvdb", line):
                    problems.append(f"{place}/{name}:{number}: {room} knows no OpenVDB")
for folder in ("tools", "tools/command_line", "tools/convert"):
    names = [name for name in os.listdir(os.path.join(ROOT, folder)) if name.endswith((".h", ".cpp"))]
    if len(names) > MOST_FILES:
        problems.append(f"{folder}: {len(names)} files; divide them")
    for name in names:
        with open(os.path.join(ROOT, folder, name), encoding="utf-8") as file:
            lines = file.read().splitlines()
        check_functions(f"{folder}/{name}", lines)
for room in os.listdir(os.path.join(ROOT, "src")):
    if room not in MAY_INCLUDE:
        problems.append(f"src/{room}: is no room of this list")
both_ways = {(a, b) for a, b in includes if a < b and (b, a) in includes}
problems += [f"src/{a} and src/{b} include from each other" for a, b in sorted(both_ways - BOTH_WAYS)]
problems += [f"src/{a} and src/{b} do not include from each other any more: take them out of BOTH_WAYS" for a, b in sorted(BOTH_WAYS - both_ways)]
names = {}  # of all sources: where files of that name are
for top in ("src", "tools", "tests", "bench", "examples"):
    for folder, _, found in os.walk(os.path.join(ROOT, top)):
        for name in found:
            names.setdefault(name, []).append(os.path.relpath(os.path.join(folder, name), ROOT))
pages = [os.path.join(ROOT, name) for name in ("README.md", "CONTRIBUTING.md")]
pages += [os.path.join(ROOT, "docs", name) for name in os.listdir(os.path.join(ROOT, "docs")) if name.endswith(".md")]
for page in pages:
    with open(page, encoding="utf-8") as file:
        text = file.read()
    for path in re.findall(r"`([a-z0-9_/-]+\.(?:h|cpp))`", text):
        if path not in OF_OTHERS and not any(("/" + place).endswith("/" + path) for place in names.get(os.path.basename(path), [])):
            problems.append(f"{os.path.relpath(page, ROOT)}: there is no {path}")
print("\n".join(problems) or f"{files} files in {len(MAY_INCLUDE)} rooms: arrows run one way")
sys.exit(1 if problems else 0)

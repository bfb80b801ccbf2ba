"""The house keeps its order: arrows between rooms run one way, folders and files stay small."""

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
    "voxelize": {"base", "gcode"},
    "export": {"base", "gcode", "voxelize"},
    "trace": {"base"},
    "march": {"base", "trace"},
    "ondemand": {"base", "gcode", "voxelize", "trace", "march"},
    "shade": {"base", "trace"},
    "assemble": {"base", "gcode", "motion", "voxelize", "trace", "march", "ondemand", "shade"},
    "study": {"base", "gcode", "voxelize", "export", "trace", "march", "ondemand", "shade", "assemble"},
}
WITHOUT_OPENVDB = {"base", "gcode", "motion", "trace", "shade"}
MOST_LINES = 450
MOST_FILES = 30  # of code, in one folder

problems = []
files = 0
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
            if len(lines) > MOST_LINES:
                problems.append(f"{place}/{name}: {len(lines)} lines; split it by idea")
            # Headers that Highway includes once a target have guards that toggle.
            guard = any("HWY_TARGET_TOGGLE" in line for line in lines) if name.endswith("-inl.h") else "#pragma once" in lines
            if name.endswith(".h") and not guard:
                problems.append(f"{place}/{name}: no include guard")
            for number, line in enumerate(lines, 1):
                match = re.match(r'#include "(\w+)/', line)
                if match and match.group(1) != room and match.group(1) not in allowed:
                    problems.append(f"{place}/{name}:{number}: {room} must not include from {match.group(1)}")
                if room in WITHOUT_OPENVDB and re.match(r"#include <openvdb", line):
                    problems.append(f"{place}/{name}:{number}: {room} knows no OpenVDB")
for folder in ("tools", "tools/command_line"):
    count = sum(name.endswith((".h", ".cpp")) for name in os.listdir(os.path.join(ROOT, folder)))
    if count > MOST_FILES:
        problems.append(f"{folder}: {count} files; divide them")
for room in os.listdir(os.path.join(ROOT, "src")):
    if room not in MAY_INCLUDE:
        problems.append(f"src/{room}: is no room of this list")
print("\n".join(problems) or f"{files} files in {len(MAY_INCLUDE)} rooms: arrows run one way")
sys.exit(1 if problems else 0)

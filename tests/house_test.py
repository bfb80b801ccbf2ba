"""The house keeps its order: arrows between rooms run one way, and files stay readable."""

import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Which rooms a room may include from. march and voxelize meet only in openvdb::FloatGrid and, brick by brick, in
# ondemand.
MAY_INCLUDE = {
    "io": set(),
    "parallel": set(),
    "gcode": {"io"},
    "motion": {"io", "parallel", "gcode"},
    "voxelize": {"io", "parallel", "gcode"},
    "march": {"io", "parallel"},
    "ondemand": {"io", "parallel", "gcode", "voxelize", "march"},
    "shade": {"io", "parallel", "march"},
    "study": {"io", "parallel", "gcode", "voxelize", "march", "ondemand", "shade"},
}
WITHOUT_OPENVDB = {"io", "parallel", "gcode", "motion", "shade"}
MOST_LINES = 500

problems = []
files = 0
for room, allowed in MAY_INCLUDE.items():
    folder = os.path.join(ROOT, "src", room)
    for name in sorted(os.listdir(folder)):
        if not name.endswith((".h", ".cpp")):
            continue
        files += 1
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            lines = file.read().splitlines()
        if len(lines) > MOST_LINES:
            problems.append(f"src/{room}/{name}: {len(lines)} lines; split it by idea")
        # Headers that Highway includes once a target have guards that toggle.
        guard = any("HWY_TARGET_TOGGLE" in line for line in lines) if name.endswith("-inl.h") else "#pragma once" in lines
        if name.endswith(".h") and not guard:
            problems.append(f"src/{room}/{name}: no include guard")
        for number, line in enumerate(lines, 1):
            match = re.match(r'#include "(\w+)/', line)
            if match and match.group(1) != room and match.group(1) not in allowed:
                problems.append(f"src/{room}/{name}:{number}: {room} must not include from {match.group(1)}")
            if room in WITHOUT_OPENVDB and re.match(r"#include <openvdb", line):
                problems.append(f"src/{room}/{name}:{number}: {room} knows no OpenVDB")
print("\n".join(problems) or f"{files} files in {len(MAY_INCLUDE)} rooms: arrows run one way")
sys.exit(1 if problems else 0)

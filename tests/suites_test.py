"""scripts/unchanged_suites.py: which suites a change leaves out."""

import glob
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import unchanged_suites  # noqa: E402

ROOMS = {name for name in os.listdir(os.path.join(ROOT, "src")) if os.path.isdir(os.path.join(ROOT, "src", name))}


def runs(suite, *paths):
    """Whether a suite runs after a change of these files."""
    return not any(re.fullmatch(pattern, suite) for pattern in unchanged_suites.unchanged(list(paths), ROOMS))


for suite, paths, expected in (
    # Rooms: by what they include, directly or not.
    ("shade.Plastic", ["src/base/error.h"], True),
    ("voxelize.Voxelizer", ["src/gcode/toolpath/toolpath.h"], True),
    ("gcode.Reader", ["src/voxelize/leaf/leaf_column.cpp"], False),
    ("prints.RealPrints", ["src/voxelize/leaf/leaf_column.cpp"], True),
    ("prints.RealPrints", ["src/view/page/page.js"], False),
    ("gcode.Reader", ["tests/gcode/reader_test.cpp"], True),
    ("gcode.Reader", ["tests/voxelize/some_shapes.h"], True),
    ("gcode.Reader", ["README.md", "docs/gcode.md", "src/view/README.md"], False),
    # What is of no room may be of all.
    ("gcode.Reader", ["CMakeLists.txt"], True),
    ("gcode.Reader", ["data/gcode/hull.gcode"], True),
    ("Client.packages", ["scripts/packages.sh"], True),
    # Long programs: by the table. Others always run.
    ("Client.view_own", ["src/view/page/page.js"], True),
    ("Client.view_own", ["src/voxelize/leaf/leaf_column.cpp"], False),
    ("Client.view_own", ["tests/clients/view_own_test.py"], True),
    ("Client.view_memory", ["tests/clients/page_memory.py"], True),
    ("Studies", ["tests/clients/studies_test.py"], True),
    ("Client.slurm", ["scripts/slurm/film.sh"], True),
    ("Client.command_line", ["README.md"], True),
    ("House", ["README.md"], True),
):
    assert runs(suite, *paths) == expected, f"{suite} after a change of {paths}: expected to run: {expected}"

# The programs that a change can matter to: those whose suites run.
for paths, expected in (
    (["src/view/page/page.js"], "view"),
    (["src/shade/film/png.cpp"], "animate assemble prints shade study view voxelize"),
    (["README.md"], ""),
):
    found = unchanged_suites.programs(unchanged_suites.changed_rooms(paths, ROOMS), ROOMS)[0]
    assert " ".join(found) == expected, f"programs after a change of {paths}: {found}"

# The table names suites and places that there are.
with open(os.path.join(ROOT, "tests", "CMakeLists.txt"), encoding="utf-8") as file:
    cmake = file.read()
for name, places in unchanged_suites.LONG.items():
    assert re.search(rf"\b{name.split('.')[-1]}\b", cmake), f"no suite {name}"
    for place in places:
        assert glob.glob(os.path.join(ROOT, place + "*")), f"{name}: no {place}"
assert unchanged_suites.changed_since("0" * 40) is None
print("suites: as expected")

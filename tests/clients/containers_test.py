"""One print in every container, from a pipe, as one plate of several and as single objects: the same toolpath, said so."""

import gzip
import json
import os
import subprocess

from packed_gcode import bgcode, gx, zipped
from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("containers")
FOLDER, path = SCRATCH.folder, SCRATCH.path
GCODE2VDB = os.path.join(BIN, "gcode2vdb")
with open(gcode("tile.gcode"), "rb") as file:
    TEXT = file.read()


def call(*arguments, stdin=b""):
    return subprocess.run([GCODE2VDB, *arguments], input=stdin, capture_output=True, timeout=300, cwd=FOLDER)


def convert(source, *options, stdin=b""):
    """Report and CSV of the beads."""
    done = call(source, "-o", "out.vdb", "--voxel-size", "0.5", "--stats", "-", "--dump-toolpath", "out.csv", *options,
                stdin=stdin)
    check(done.returncode == 0, f"{source} {' '.join(options)}: {done.stderr.decode(errors='replace').strip()[-300:]}")
    with open(path("out.csv"), encoding="utf-8") as rows:
        return json.loads(done.stdout), rows.read()


def refused(arguments, status, *fragments):
    done = call(*arguments, "-o", "refused.vdb")
    text = done.stderr.decode(errors="replace")
    check(done.returncode == status, f"{' '.join(arguments)}: exit {done.returncode}: {text.strip()}")
    for fragment in fragments:
        check(fragment in text, f"  says {fragment!r}")
    check(not os.path.exists(path("refused.vdb")), "  leaves no file behind")


# --- every container, told apart by content: the names all lie -------------------------------------------------------
expected_report, expected = convert(gcode("tile.gcode"))
check(expected.count("\n") > 100, "the tile has beads")
FILES = {
    "ascii": TEXT,
    "gzip": gzip.compress(TEXT),
    "3mf": zipped({"3D/3dmodel.model": b"<model/>", "Metadata/plate_1.gcode": TEXT}),
    "ufp": zipped({"/3D/model.gcode": TEXT, "/Metadata/thumbnail.png": b"\x89PNG"}),
    "gx": gx(TEXT),
    "bgcode": bgcode(TEXT, 0),
    "bgcode ": bgcode(TEXT, 1),
    "bgcode  ": bgcode(TEXT, 2),
    "bgcode   ": bgcode(TEXT, 3, 2),
}
for kind, content in FILES.items():
    with open(path("part.stl"), "wb") as out:
        out.write(content)
    report, beads = convert("part.stl")
    check(report["input"]["format"] == kind.strip(), f"the report calls it {report['input']['format']}")
    check(beads == expected, f"{kind}: the beads of the text, line for line")
    check(report["toolpath"]["features"] == expected_report["toolpath"]["features"], "  and its features")
    piped, beads = convert("-", stdin=content)
    check(beads == expected and piped["input"]["format"] == kind.strip(), f"{kind} from standard input")

# --- the report ------------------------------------------------------------------------------------------------------
toolpath = expected_report["toolpath"]
features = toolpath["features"].values()
check(abs(sum(f["volume_mm3"] for f in features) - toolpath["volume_mm3"]) < 1e-6 * toolpath["volume_mm3"],
      "the features' volumes add up to the whole")
check(abs(sum(f["length_mm"] for f in features) - toolpath["length_mm"]) < 1e-6 * toolpath["length_mm"],
      "and their lengths")
check(sum(t["filament_mm"] for t in toolpath["tools"]) > 0.999 * toolpath["filament_mm"], "and the tools' filament")
for key in ("footer_mm", "firmware", "firmware_reason", "extrusion", "objects", "warnings", "cut_short"):
    check(key in toolpath, f"the toolpath's report has {key}: {toolpath[key]}")

# --- plates ------------------------------------------------------------------------------------------------------------
other = b"M83\nG1 Z.2\nG1 X10 E1\nG1 X20 E1\n"
with open(path("plates.gcode.3mf"), "wb") as out:
    out.write(zipped({"Metadata/plate_2.gcode": TEXT, "Metadata/plate_5.gcode": other}))
refused(["plates.gcode.3mf"], 2, "2 plates (2, 5)", "--plate 2")
refused(["plates.gcode.3mf", "--plate", "1"], 2, "no such plate", "2, 5")
refused([gcode("tile.gcode"), "--plate", "1"], 2, "only a .gcode.3mf has plates")
check(convert("plates.gcode.3mf", "--plate", "2")[1] == expected, "plate 2 is the tile")
check(convert("plates.gcode.3mf", "--plate", "5")[0]["toolpath"]["beads"] == 2, "plate 5 is the other")

# --- standard input without anything in it, or without a name -----------------------------------------------------------
refused(["-"], 3, "standard input", "empty")
done = call("-", stdin=TEXT)
check(done.returncode == 2 and b"-o" in done.stderr, "standard input needs -o")

# --- objects -------------------------------------------------------------------------------------------------------------
with open(path("two.gcode"), "w", encoding="utf-8") as out:
    out.write("M83\nEXCLUDE_OBJECT_DEFINE NAME=cube\nEXCLUDE_OBJECT_DEFINE NAME=7\nG1 Z.2\n"
              "G1 X20 E1\nEXCLUDE_OBJECT_START NAME=cube\nG1 X30 E2\nEXCLUDE_OBJECT_END\n"
              "EXCLUDE_OBJECT_START NAME=7\nG1 X40 E3\nG1 X50 E3\nEXCLUDE_OBJECT_END\n")


def kept(*options):
    report, _ = convert("two.gcode", *options)
    return report["files"][0]["beads"]


check(kept() == 4, "both objects and what belongs to none")
check(kept("--object", "cube") == 1 and kept("--object", "1") == 1, "an object by name and by number")
check(kept("--object", "7") == 2, "a name that looks like a number")
check(kept("--object", "cube", "--object", "2") == 3, "two objects")
check(kept("--object", "0") == 1, "what belongs to none")
refused(["two.gcode", "--object", "sphere"], 2, "no such object", "1: cube", "2: 7")
refused([gcode("tile.gcode"), "--object", "sphere", "--features", "+perimeter"], 2, "--object sphere")
# Names are UTF-8, or else Latin-1; the report is UTF-8.
with open(path("names.gcode"), "wb") as out:
    out.write("M83\nG1 Z.2\n; printing object Würfel\nG1 X20 E1\n".encode() + b"; printing object Kr\xfcmel\nG1 X30 E1\n")
names = [o["name"] for o in convert("names.gcode")[0]["toolpath"]["objects"]]
check(names == ["Würfel", "Krümel"], f"names in any encoding: {names}")
for name in names:
    check(convert("names.gcode", "--object", name)[0]["files"][0]["beads"] == 1, f"an object by the name {name}")
report, _ = convert("two.gcode")
check([(o["number"], o["name"], o["beads"]) for o in report["toolpath"]["objects"]] == [(1, "cube", 1), (2, "7", 2)],
      f"the report lists them: {report['toolpath']['objects']}")

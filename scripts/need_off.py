#!/usr/bin/env python3
"""How many instructions the tools take while every capability is off, as need_off.csv for `vdbstudy need`.

    scripts/need_off.py BIN_FOLDER PRINT.gcode OUTPUT.csv

Runs the least conversion, the least picture of a level set and the least picture straight from G-code under valgrind's
callgrind, which counts the instructions within main: the figures are the same every time. Each is told beside the one that
OUTPUT.csv has, if it is of the same print: what is new and off must not add more than 1 %.
"""
import csv
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

LEAST = ["--size", "160x120", "--spp", "4", "--no-denoise", "--brdf", "lambert:0.5,0.5,0.5", "--env", "constant:1,1,1",
         "--no-bed", "--threads", "1", "--quiet"]
COLUMNS = ["work", "sha256", "instructions", "before", "percent", "verdict"]


def counted(command, out):
    """Callgrind's total."""
    subprocess.run(["valgrind", "--trace-children=yes", "--tool=callgrind", "--toggle-collect=main",
                    f"--callgrind-out-file={out}", *command], check=True, capture_output=True)
    return int(re.search(r"^(?:totals|summary): (\d+)", out.read_text(encoding="utf-8"), re.M).group(1))


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    binaries, print_file, csv_path = map(pathlib.Path, sys.argv[1:])
    if shutil.which("valgrind") is None:
        print("need_off: no valgrind, so nothing is counted; install it to have this part of the study")
        return
    digest = hashlib.sha256(print_file.read_bytes()).hexdigest()[:12]
    before = {}
    if csv_path.exists():
        with csv_path.open(newline="", encoding="utf-8") as file:
            before = {row["work"]: int(row["instructions"]) for row in csv.DictReader(file) if row.get("sha256") == digest}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        grid = folder / "print.vdb"
        convert = [binaries / "gcode2vdb", print_file, "--voxels-per-layer", "2", "--threads", "1", "--quiet", "-o"]
        subprocess.run([*convert, grid], check=True)
        runs = {"conversion": [*convert, folder / "again.vdb"],
                "picture of a level set": [binaries / "vdbtrace", grid, "-o", folder / "a.png", *LEAST],
                "picture from G-code": [binaries / "vdbtrace", print_file, "-o", folder / "b.png", "--voxels-per-layer", "2",
                                        *LEAST]}
        rows = []
        for work, command in runs.items():
            try:
                count = counted(command, folder / "callgrind.out")
            except subprocess.CalledProcessError as error:
                # Debian's libhwy reads the clock by RDTSCP on some processors, for which valgrind 3.19 has no emulation.
                if b"Unrecognised instruction" not in error.stderr:
                    raise
                print("need_off: valgrind does not know an instruction that is used on this processor, so nothing is counted")
                return
            change = 100 * (count / before[work] - 1) if work in before else 0
            rows.append([work, digest, count, before.get(work, ""), f"{change:+.3f}", "over 1 %" if change > 1 else "ok"])
    csv_path.parent.mkdir(parents=True, exist_ok=True)
    with csv_path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


main()

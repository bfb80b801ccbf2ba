#!/usr/bin/env python3
"""How many instructions each capability of the tools takes while it is off, as need_off.csv for `vdbstudy need`.

    scripts/need_off.py BIN_FOLDER PRINT.gcode OUTPUT.csv

Runs the least conversion, the least picture of a level set and the least picture straight from G-code under valgrind's
callgrind, which counts instructions: the figures are the same every time. Of the program's own instructions (the loader's
and the C library's start are left out) those inside the functions of a capability are summed, with all that they call: an
upper bound, for what one of them calls is counted twice. Functions that were merged into their callers can't be told apart.
"""
import concurrent.futures
import csv
import datetime
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# Capability -> the functions that nothing else needs. Classes end with "::" where others take them as arguments.
PICTURE = {
    "attributes": r"AttributeGrid|attribute_grid|summarize\(|AnnotatedTracer|Annotated",
    "smooth normals": r"SmoothNormal",
    "measured materials": r"TableBrdf|HalfDiffTable|ScanInterpolant|Lobes::|LobeFit|fitLobe",
    "environment tables": r"SphereDistribution|MapEnvironment|BilinearDistribution|StudioEnvironment|SkyEnvironment",
    "bed": r"BedLight|restingHeight|irradianceFromAbove|Surfaces::onBed",
    "lamps": r"RectangleLight|PointLight|DirectionalLight",
    "layers (AOVs)": r"AovRecorder::|makeLayers\(",
    "denoiser": r"denoise",
    "checkpoints": r"Checkpoint",
    "several objects": r"SceneTracer|MultiTracer|PlacedTracer",
    "shapes by formula": r"SdfTracer|march::\(anonymous namespace\)::(Sphere|Torus|Cylinder)::distance",
    "lens": r"Camera::ray\([^)]*, glm::vec<2, float|Camera::withLens",
    "grid in memory (bricks come from the file)": r"readLevelSet",
    "translucent plastic": r"RandomWalk|random_walk|TranslucentBrdf|RoughInterface",
    "transparent pictures (--background none)": r"catchShadows|addBare|toDisplayWithAlpha|bareBed",
    "films": r"stratum::animate::",
    "shards of pictures": r"shade::(mergePicture|mergeParts|isPartOf|writePart|readPart|piecesOf)|parseShard",
    "reading G-code": r"gcode::readToolpath|gcode::Lexer|motion::Planner|deposit::",
}
STRAIGHT = PICTURE | {
    "planned motion": r"motion::Planner|motion::readTimedToolpath",
    "flow": r"deposit::FlowRecorder|deposit::layFlow|deposit::dividePath",
    "sag": r"deposit::Sag|deposit::sagBeads|findHangingSpans|deposit::BeadSupport",
    "settled beads": r"SettlingCurve|settleColumn|SettlingKernel|settling",
}
del STRAIGHT["reading G-code"]
CONVERSION = {
    "planned motion": r"motion::Planner|motion::readTimedToolpath",
    "flow": r"deposit::FlowRecorder|deposit::layFlow|deposit::dividePath",
    "sag": r"deposit::Sag|deposit::sagBeads|findHangingSpans|deposit::BeadSupport",
    "settled beads": r"SettlingCurve|settleColumn|SettlingKernel|settling",
    "report": r"stratum::report::",
    "comparison with a model": r"stratum::compare::",
    "elements": r"stratum::mechanics::",
    "thumbnails": r"[tT]humbnail",
    "attribute grids": r"voxelize::.*[aA]ttribute",
    "meshes": r"exporter::.*[sS]urfaceMesh|meshSurface|simplif",
    "NanoVDB": r"[nN]ano",
}
# Rooms that a program has nothing of: what is not in it can't cost.
ABSENT = {"vdbtrace": {"viewer": r"stratum::(view|serve)::"}, "gcode2vdb": {"viewer": r"stratum::(view|serve)::"}}
# What a program does before main and besides: not ours to leave out.
OUTSIDE = re.compile(r"^(_dl_|do_lookup|dl_|check_match|_start$|\(below main\)|__libc_start|call_init|_init)")


LEAST = ["--size", "160x120", "--spp", "4", "--no-denoise", "--brdf", "lambert:0.5,0.5,0.5", "--env", "constant:1,1,1",
         "--no-bed", "--threads", "1", "--quiet"]


def profile(command, out):
    subprocess.run(["valgrind", "--trace-children=yes", "--tool=callgrind", f"--callgrind-out-file={out}", *command],
                   check=True, capture_output=True)


def functions(out, inclusive):
    """name -> instructions, as callgrind_annotate tells them."""
    text = subprocess.run(["callgrind_annotate", "--threshold=100", f"--inclusive={'yes' if inclusive else 'no'}", out],
                          check=True, capture_output=True, text=True).stdout
    found = {}
    for line in text.splitlines():
        match = re.match(r"\s*([\d,]+) \(\s*[\d.]+%\)\s+(?:\S*?):(.*?)(?: \[[^\]]*\])?$", line)
        if match:
            name = match.group(2)
            found[name] = found.get(name, 0) + int(match.group(1).replace(",", ""))
    return found


def require_functions(program, capabilities):
    """A pattern that matches nothing of the program would prove nothing; nor would one of ABSENT that matches."""
    names = subprocess.run(["nm", "--demangle", program], check=True, capture_output=True, text=True).stdout
    for capability, pattern in capabilities.items():
        if not re.search(pattern, names):
            sys.exit(f"need_off: {program} has no function of {capability!r}; mend its pattern {pattern}")
    for capability, pattern in ABSENT[program.name].items():
        if re.search(pattern, names):
            sys.exit(f"need_off: {program} has functions of {capability!r}, which it needs for nothing")


def value_in(path, key):
    """The value of a "key : value" line of a system file."""
    with open(path, encoding="utf-8") as file:
        for line in file:
            match = re.match(rf"{key}\s*[:=]\s*(.*)", line)
            if match:
                return match.group(1).strip(' "\n')
    return "unknown"


def machine():
    """As machineLine() of src/study/report/run_log.cpp, but for the compiler."""
    memory = int(value_in("/proc/meminfo", "MemTotal").split()[0]) * 1024e-9
    return (f"{value_in('/proc/cpuinfo', 'model name')}, {os.cpu_count()} threads, {memory:.0f} GB of memory, "
            f"{value_in('/etc/os-release', 'PRETTY_NAME')}")


def run_number(folder, print_file, version):
    """The number of a new line of runs.csv, as src/study/report/run_log.h has it."""
    path = folder / "runs.csv"
    columns = ["run", "date", "version", "machine", "command"]
    rows = []
    if path.exists():
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    number = str(len(rows) + 1)
    date = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC")
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        if not rows:
            writer.writerow(columns)
        writer.writerow([number, date, version, machine(), f"need_off.py {print_file.name}"])
    return number


def counted(what, command, capabilities, out):
    """Rows of work, capability, functions, instructions, per cent of the program's own."""
    profile(command, out)
    own = functions(out, False)
    inclusive = functions(out, True)
    total = sum(count for name, count in own.items() if not OUTSIDE.match(name))
    rows = []
    for capability, pattern in capabilities.items():
        names = [name for name in inclusive if re.search(pattern, name)]
        # One of them may call another: the sum is an upper bound.
        count = sum(inclusive[name] for name in names)
        rows.append([what, capability, len(names), count, f"{100 * count / total:.3f}"])
    return rows + [[what, capability, 0, 0, "0.000"] for capability in ABSENT[pathlib.Path(command[0]).name]]


def main():
    binaries, print_file, csv_path = map(pathlib.Path, sys.argv[1:4])
    if not shutil.which("valgrind"):
        print("need_off: skipped, there is no valgrind", file=sys.stderr)
        return
    binaries, print_file = binaries.resolve(), print_file.resolve()
    require_functions(binaries / "vdbtrace", STRAIGHT | PICTURE)
    require_functions(binaries / "gcode2vdb", CONVERSION)
    version = subprocess.run([binaries / "vdbtrace", "--version"], check=True, capture_output=True, text=True).stdout
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        grid = folder / "print.vdb"
        convert = [binaries / "gcode2vdb", print_file, "--voxels-per-layer", "2", "--threads", "1", "-o", grid, "--quiet"]
        subprocess.run(convert, check=True)
        runs = [("conversion", [*convert[:-2], folder / "again.vdb", "--quiet"], CONVERSION),
                ("picture of a level set", [binaries / "vdbtrace", grid, "-o", folder / "a.png", *LEAST], PICTURE),
                ("picture from G-code", [binaries / "vdbtrace", print_file, "-o", folder / "b.png", "--voxels-per-layer", "2", *LEAST],
                 STRAIGHT)]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:  # valgrind runs one thread at a time
            jobs = [pool.submit(counted, *run, folder / f"callgrind.{n}") for n, run in enumerate(runs)]
            rows = [row for job in jobs for row in job.result()]
    csv_path.parent.mkdir(parents=True, exist_ok=True)
    run = run_number(csv_path.parent, print_file, version.split()[1])
    with csv_path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["work", "capability", "functions", "instructions", "percent", "run"])
        writer.writerows([*row, run] for row in rows)


main()

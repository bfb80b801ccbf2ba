#!/usr/bin/env python3
"""How many instructions each capability of vdbtrace takes while it is off, as need_off.csv for `vdbstudy need`.

    scripts/need_off.py BIN_FOLDER PRINT.gcode OUTPUT.csv

Renders the least picture there is under valgrind's callgrind, which counts instructions: the figures are the same every
time. Of the program's own instructions (the loader's and the C library's start are left out) those inside the functions
of a capability are summed, with all that they call: an upper bound, for what one of them calls is counted twice.
Functions that were merged into their callers can't be told apart.
"""
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# Capability -> the functions that nothing else needs. Classes end with "::" where others take them as arguments.
CAPABILITIES = {
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
}
# What a program does before main and besides: not ours to leave out.
OUTSIDE = re.compile(r"^(_dl_|do_lookup|dl_|check_match|_start$|\(below main\)|__libc_start|call_init|_init)")


def profile(binaries, print_file, scratch):
    grid = scratch / "print.vdb"
    subprocess.run([binaries / "gcode2vdb", print_file, "--voxels-per-layer", "2", "-o", grid, "--quiet"], check=True)
    out = scratch / "callgrind.out"
    subprocess.run(["valgrind", "--trace-children=yes", "--tool=callgrind", f"--callgrind-out-file={out}",
                    binaries / "vdbtrace", grid, "-o", scratch / "picture.png", "--size", "160x120", "--spp", "16",
                    "--brdf", "lambert:0.5,0.5,0.5", "--env", "constant:1,1,1", "--no-bed", "--threads", "1", "--quiet"],
                   check=True, capture_output=True)
    return out


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


def require_functions(program):
    """A pattern that matches nothing of the program would prove nothing."""
    names = subprocess.run(["nm", "--demangle", program], check=True, capture_output=True, text=True).stdout
    for capability, pattern in CAPABILITIES.items():
        if not re.search(pattern, names):
            sys.exit(f"need_off: {program} has no function of {capability!r}; mend its pattern {pattern}")


def main():
    binaries, print_file, csv_path = map(pathlib.Path, sys.argv[1:4])
    if not shutil.which("valgrind"):
        print("need_off: skipped, there is no valgrind", file=sys.stderr)
        return
    require_functions(binaries / "vdbtrace")
    with tempfile.TemporaryDirectory() as folder:
        out = profile(binaries.resolve(), print_file.resolve(), pathlib.Path(folder))
        own = functions(out, False)
        inclusive = functions(out, True)
    total = sum(count for name, count in own.items() if not OUTSIDE.match(name))
    csv_path.parent.mkdir(parents=True, exist_ok=True)
    with csv_path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["capability", "functions", "instructions", "percent"])
        for capability, pattern in CAPABILITIES.items():
            names = [name for name in inclusive if re.search(pattern, name)]
            # One of them may call another: the sum is an upper bound.
            count = sum(inclusive[name] for name in names)
            writer.writerow([capability, len(names), count, f"{100 * count / total:.3f}"])


main()

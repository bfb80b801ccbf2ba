"""Installed: the tools anywhere, their manuals, and two strangers' projects that use the libraries."""

import gzip
import json
import os
import re
import shutil
import struct
import subprocess
import tempfile
import time

from run_tools import BIN, SOURCE, check, gcode, run

BUILD = os.path.dirname(BIN)
FOLDER = tempfile.mkdtemp(prefix="stratum_install_")
CONSUMER = os.path.join(SOURCE, "examples")
TOOLS = ("gcode2vdb", "vdbtrace", "vdbview", "vdbmerge", "vdbstudy")
# The consumers' own flags; what they compile is looked up first if there is a cache.
CONFIGURE = ["-GNinja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_CXX_FLAGS_DEBUG=-O0"]
if shutil.which("ccache"):
    CONFIGURE.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")

# --- installed in one place, moved to another -----------------------------------------------------------------------
run("cmake", "--install", BUILD, "--prefix", os.path.join(FOLDER, "first"))
prefix = os.path.join(FOLDER, "moved")
os.rename(os.path.join(FOLDER, "first"), prefix)
os.environ.pop("STRATUM_DATA", None)
bin_ = os.path.join(prefix, "bin")



def start_seconds(*command):
    """Processor time of a program that starts and ends, the least of ten: the same as wall time on a machine with nothing else
    to do, and other tests run beside this one."""
    seconds = []
    for _ in range(10):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, _, usage = os.wait4(process.pid, 0)
        seconds.append(usage.ru_utime + usage.ru_stime)
    return min(seconds)


# OpenVDB's own tool loads the same libraries: where it takes long, the machine is slow.
PEER = start_seconds("vdb_print", "-version") if shutil.which("vdb_print") else 0

for tool in TOOLS:
    program = os.path.join(bin_, tool)
    facts = run(program, "--version")
    check(facts.startswith(tool + " "), f"{tool} --version")
    for fact in ("GCC" if "GCC" in facts else "Clang", "SIMD", "OpenVDB", "Highway"):
        check(fact in facts, f"  tells {fact}")
    # A third of 0.1 s is what a quiet machine takes; more than this, and something is done that nobody asked for.
    seconds = start_seconds(program, "--version")
    check(seconds < max(0.1, 3 * PEER), f"  in {seconds * 1e3:.0f} ms, vdb_print in {PEER * 1e3:.0f}")

    brief = run(program, "-h")
    everything = run(program, "--help-all")
    lines = brief.splitlines()
    check(len(lines) <= 50, f"{tool} -h fits a screen: {len(lines)} lines")
    check(max(map(len, lines)) <= 80, f"  of 80 columns: {max(map(len, lines))}")
    examples = everything.split("Examples:")[1].count(f"  {tool} ")
    check(examples >= 3 and brief.split("Examples:")[1].count(f"  {tool} ") >= 3, "  with three examples")

    with gzip.open(os.path.join(prefix, "share/man/man1", tool + ".1.gz"), "rt") as file:
        page = file.read()
    options = {word.rstrip(",") for word in everything.split() if word.startswith("--")}
    for option in options - {"--help-all"}:
        for name in option.split(","):
            check(name.replace("-", "\\-") in page, f"  {name} is in the man page")
    if shutil.which("groff"):
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-"], input=page, capture_output=True, text=True)
        check(done.returncode == 0 and done.stderr == "", f"  the man page is clean: {done.stderr.strip()}")

    def complete(*words):
        script = os.path.join(prefix, "share/bash-completion/completions", tool)
        quoted = " ".join(f"'{word}'" for word in (tool, *words))
        return run("bash", "-c", f"source '{script}'; COMP_WORDS=({quoted}); COMP_CWORD={len(words)}; _{tool}; "
                                 'echo "${COMPREPLY[@]}"').split()

    if tool == "gcode2vdb":
        check(complete("--inte") == ["--interior", "--interior-distance"], "  completes options")
        check(complete("--interior", "c") == ["cull"], "  and their choices")
    if tool == "vdbstudy":
        check(complete("stab") == ["stability"], "  completes commands")
        check("--points" in complete("geometry", "--p"), "  and their options")

    if tool == "gcode2vdb":
        check(complete("--features", "-sk") == ["-skirt"], "  of a list with signs")
        check(complete("--features", "-skirt,+perim") == ["-skirt,+perimeter"], "  also of its end")
        check(complete("--grids", "layer,ti") == ["layer,time"] and complete("--firmware", "k") == ["klipper"], "  and more")
    if tool == "vdbtrace":
        check(complete("--view", "f") == ["front"] and complete("--view", "=", "f") == ["front"], "  views, also after =")
        check(complete("--integrator", "dir") == ["direct"], "  integrators")
        check("pla-blue" in complete("--brdf", "pla") and "studio" in complete("--env", "stu"), "  presets")
        check(complete("--aov", "normal,de") == ["normal,depth"] and complete("--march", "br") == ["brick"], "  layers")

# --- documents: whatever they link to is there --------------------------------------------------------------------------
documents = os.path.join(prefix, "share/doc/stratum")
links = 0
for folder, _, names in os.walk(documents):
    for name in filter(lambda name: name.endswith(".md"), names):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            for target in re.findall(r"\]\(([^)\s]+)\)", file.read()):
                if re.match("https?:|mailto:|#", target):
                    continue
                links += 1
                check(os.path.exists(os.path.join(folder, re.split("[?#]", target)[0])), f"{name}: {target}")
check(links > 40, f"{links} links in the installed documents")

# --- the Python module ------------------------------------------------------------------------------------------------
package = os.path.join(prefix, "lib/python3/dist-packages")
check(os.path.exists(os.path.join(package, "stratum/py.typed")), "the Python package is installed")
said = run("/usr/bin/env", f"PYTHONPATH={package}", "/usr/bin/python3", "-c",
           "import stratum, sys; print(stratum.__file__, len(stratum.read(sys.argv[1])))", gcode("tile.gcode")).split()
check(said[0].startswith(package) and int(said[1]) > 100, f"  and reads a print: {said[1]} beads")

# A table of materials that only the moved tree has.
tables = os.path.join(prefix, "share/stratum/data/brdf")
shutil.copy(os.path.join(tables, "pla-blue.bsdf.gz"), os.path.join(tables, "mine.bsdf.gz"))
vdb = os.path.join(FOLDER, "tile.vdb")
report = json.loads(run(os.path.join(bin_, "gcode2vdb"), gcode("tile.gcode"), "-o", vdb, "--stats", "-"))
run(os.path.join(bin_, "vdbtrace"), vdb, "-o", os.path.join(FOLDER, "tile.png"), "--brdf", "mine", "--size", "64x48", "--spp", "1")
check(os.path.getsize(os.path.join(FOLDER, "tile.png")) > 1000, "renders with a table of its own tree")
run("/usr/bin/env", f"PYTHONPATH={package}", "/usr/bin/python3", "-c",
    "import stratum, sys; stratum.render(sys.argv[1], size=(64, 48), spp=1, brdf='mine')", vdb)
check(True, "  so does the module")
listed = run(os.path.join(bin_, "vdbtrace"), "--colors", "prusament galaxy").splitlines()
check(len(listed) == 5, f"names filaments from its own tree: {len(listed)}")

# --- what is missing is told before anything is compiled -----------------------------------------------------------------
done = subprocess.run(["cmake", "-S", SOURCE, "-B", os.path.join(FOLDER, "missing"), *CONFIGURE, "-DCMAKE_DISABLE_FIND_PACKAGE_PNG=ON",
                       "-DCMAKE_DISABLE_FIND_PACKAGE_hwy=ON"], capture_output=True, text=True)
check(done.returncode != 0 and "apt-get install libpng-dev libhwy-dev" in done.stderr, f"missing libraries: {done.stderr[-400:]}")

# --- strangers ---------------------------------------------------------------------------------------------------------
for name, options in (("find_package", [f"-DCMAKE_PREFIX_PATH={prefix}"]),
                      ("add_subdirectory", [f"-DSTRATUM_SOURCE={SOURCE}"])):
    build = os.path.join(FOLDER, name)
    start = time.perf_counter()
    run("cmake", "-S", CONSUMER, "-B", build, *CONFIGURE, *options)
    run("cmake", "--build", build)
    words = run(os.path.join(build, "consumer"), gcode("tile.gcode")).split()
    print(f"{name}: configured, built and run in {time.perf_counter() - start:.0f} s")
    if name == "find_package":
        check(int(words[0]) == report["toolpath"]["beads"], "  reads the print")
        check(int(words[1]) > 100000 and words[2:] == ["1", "1"], f"  voxelizes and traces: {words[1:]}")
        picture = os.path.join(FOLDER, "stranger.png")
        run(os.path.join(build, "picture"), gcode("tile.gcode"), picture)
        with open(picture, "rb") as file:
            head = file.read(24)
        check(struct.unpack(">II", head[16:]) == (160, 120) and os.path.getsize(picture) > 5000,
              f"  makes a picture of {os.path.getsize(picture)} bytes")
    else:
        check(words == ["1", "3.000", report["input"]["sha256"]], f"  traces and hashes: {words}")
shutil.rmtree(FOLDER)

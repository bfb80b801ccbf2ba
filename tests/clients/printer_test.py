"""A user's own printer, end to end: what --printer reads, beside Python's own parser of such files; bad files; and that a
slip of the pen ends every tool as a slip of the pen."""

import configparser
import json
import os
import random
import subprocess

from run_tools import BIN, Scratch, check, gcode

SCRATCH = Scratch("printer")
FOLDER, path = SCRATCH.folder, SCRATCH.path
TILE = gcode("tile.gcode")
# Two layers, for what needs no print.
TINY = os.path.join(FOLDER, "tiny.gcode")
with open(TINY, "w", encoding="ascii") as file:
    file.write("M83\nG1 Z.2 F600\nG1 X20 E1\nG1 Y20 E1\nG1 Z.4\nG1 X0 E1\n")


def make(name, text):
    with open(path(name), "w", encoding="utf-8", newline="") as file:
        file.write(text)
    return path(name)


def call(tool, *options):
    return subprocess.run([os.path.join(BIN, tool), *options], capture_output=True, text=True, timeout=300, cwd=FOLDER)


def times(program, *options):
    """The report's part about times."""
    done = call("gcode2vdb", program, "-o", path("out.vdb"), "--voxels-per-layer", "2", "--layers", "1:2", "--grids", "time",
                "--stats", "-", "--quiet", *options)
    check(done.returncode == 0, f"--printer {options[-1] if options else 'none'}: {done.stderr.strip()}")
    return json.loads(done.stdout)["time"]


def limits(report):
    return {limit["name"]: limit for limit in report["limits"]}


# --- a slip of the pen -------------------------------------------------------------------------------------------------
for tool in ("gcode2vdb", "vdbtrace", "vdbview"):
    done = call(tool, TILE, "--printer", "tipical")
    check(done.returncode == 2, f"{tool} --printer tipical: exit {done.returncode}")
    check("did you mean 'typical'?" in done.stderr, f"  {done.stderr.strip()}")
    done = call(tool, TILE, "--printer", "x" * 5000)
    check(done.returncode == 2, f"{tool} --printer of 5000 letters: exit {done.returncode}")
    done = call(tool, TILE, "--section", "round")
    check(done.returncode == 2 and "corner radius" in done.stderr, f"{tool} --section round: {done.stderr.strip()}")

# --- bad files ---------------------------------------------------------------------------------------------------------
GOOD = "[printer]\nmax_velocity: 300\nmax_accel: 3000\n"
for name, text, message in (
    ("zero.cfg", "[printer]\nmax_velocity: 0\nmax_accel: 3000\n", "zero.cfg:2: max_velocity is '0'"),
    ("less.cfg", GOOD + "max_z_velocity: -5\n", "less.cfg:4: max_z_velocity is '-5'"),
    ("huge.cfg", "[printer]\n\nmax_velocity: 1e300\n", "huge.cfg:3: max_velocity is '1e300'"),
    ("text.cfg", GOOD + "square_corner_velocity: five\n", "text.cfg:4: square_corner_velocity is 'five'"),
    ("missing.cfg", GOOD + "[include macros.cfg]\n", "missing.cfg:4: the included file"),
    ("cycle.cfg", "[include cycle.cfg]\n", "cycle.cfg:1"),
    ("large.cfg", GOOD + "# much\n" * 1500000, "too many for a printer"),
    ("config.g", "M566 X900\nM203 X0\n", "config.g:2: M203 X is 0"),
    ("m503.txt", "echo:  M92 X80\necho:  M201 X-1\n", "m503.txt:2: M201 X is -1"),
    ("foo.json", '{"limits": {"foo": 1}}', "limits.foo: unknown key"),
    ("broken.json", "{", "no JSON"),
    ("program.gcode", "M203 X500\nG1 X10 Y10 E1\n", "program.gcode:2: a move that prints"),
    ("letter.txt", "Dear printer, print fast.\n", "no limit of a printer in it"),
):
    done = call("gcode2vdb", TILE, "-o", path("out.vdb"), "--printer", make(name, text))
    check(done.returncode == 3, f"{name}: exit {done.returncode}")
    check(message in done.stderr and done.stderr.count("\n") == 1, f"  {done.stderr.strip()}")
    check(not os.path.exists(path("out.vdb")), "  writes nothing")

# --- a user's limits win -----------------------------------------------------------------------------------------------
alone = times(TILE)
check(alone["rule"] == "slicer-jerk", "the file's own rule")
klipper = times(TILE, "--printer", make("printer.cfg", GOOD + "[extruder]\nnozzle_diameter: 0.4\nfilament_diameter: 1.75\n"))
check(klipper["rule"] == "corner-velocity", "printer.cfg: Klipper's rule")
check(limits(klipper)["max_velocity"]["from"].endswith("printer.cfg:2"), "its limits say file and line")
check(limits(klipper)["square_corner_velocity"]["from"] == "Klipper's default", "and what is Klipper's default")
check(klipper["planned_s"] != alone["planned_s"], f"{alone['planned_s']:.1f} s become {klipper['planned_s']:.1f} s")
slow = times(TILE, "--printer", make("slow.cfg", "[printer]\nmax_velocity: 20\nmax_accel: 3000\n"))
check(slow["planned_s"] > 1.5 * klipper["planned_s"], f"max_velocity 20: {slow['planned_s']:.1f} s")
summary = call("gcode2vdb", TILE, "-o", path("out.vdb"), "--summary", "--printer", path("slow.cfg")).stdout
check("slow.cfg:2" in summary and "assumed" in summary, "--summary names the line, and what is assumed without [extruder]")
marlin = times(TILE, "--printer", make("m503.txt", "echo:; Steps per unit:\necho:  M92 X80 Y80 Z400 E93\necho:  M205 J0.02\n"))
check(marlin["rule"] == "junction-deviation", "a report with M205 J")
check(limits(marlin)["junction deviation"]["value"] == 0.02, "  its value")
duet = times(TILE, "--printer", make("config.g", "M584 X0 Y1 Z2 E3\nM566 X900 Y900 Z12 E120\nM203 X6000 Y6000 Z180 E1200\n"))
check(duet["rule"] == "reprap-jerk" and limits(duet)["jerk x"]["value"] == 15, "config.g counts mm/min")

# --- the same values as Python's parser reads, which is Klipper's ---------------------------------------------------------
OPTIONS = ("max_velocity", "max_accel", "square_corner_velocity", "minimum_cruise_ratio", "max_z_velocity", "max_z_accel")
random.seed(5)


def number(option):
    return f"{random.random() * 0.9:.3f}" if "ratio" in option else f"{random.uniform(1, 40) * (100 if option[:5] == 'max_v' or option == 'max_accel' else 1):.3f}"


def odd_lines():
    """Lines of a section [printer] as people write them."""
    for option in random.sample(OPTIONS, len(OPTIONS)) + random.sample(OPTIONS, 2):
        name = random.choice((option, option.upper(), option.title()))
        yield name + random.choice((":", "=", " : ", " = ", ": ", "\t=\t")) + number(option) + random.choice(
            ("", " ; a comment", " # another", "# near", "\t;", "   "))
        if random.random() < 0.3:
            yield random.choice(("", "# [printer]", "; max_accel: 5", "   ", "[gcode_macro A]\ngcode:\n  max_accel: 1\n\n  G1 X{1;2}\n[printer]"))


for trial in range(30):
    lines = ["[printer]", "kinematics: corexy", *odd_lines()]
    text = random.choice(("\n", "\r\n")).join("\n".join(lines).split("\n")) + "\n"
    parser = configparser.RawConfigParser(strict=False, inline_comment_prefixes=(";", "#"))
    parser.read_string("\n".join(line[: line.find("#")] if "#" in line else line for line in text.replace("\r\n", "\n").split("\n")))
    expected = {option: float(parser.get("printer", option)) for option in OPTIONS}
    if expected["max_z_velocity"] > expected["max_velocity"] or expected["max_z_accel"] > expected["max_accel"]:
        continue
    read = limits(times(TINY, "--printer", make("odd.cfg", text)))
    check(all(read[option]["value"] == expected[option] for option in OPTIONS), f"odd.cfg {trial}: as Python reads it")

print("printer: all as expected")

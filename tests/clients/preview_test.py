"""PrusaSlicer's own G-code viewer as the judge: which colors it gives tools and changes of filament, how much filament
and time it counts for each feature, and how many layers it finds."""

import concurrent.futures
import json
import math
import os
import re
import shutil
import subprocess
import tempfile

from run_tools import BIN, check, corpus, gcode, skip_without
from slicer_preview import PROGRAMS, Preview, make_locale

skip_without(programs=[*PROGRAMS, "tesseract"])
FOLDER = tempfile.mkdtemp(prefix="stratum_preview_test_")
LOCALE = make_locale(FOLDER)
NAMES = {"Perimeter": "perimeter", "External perimeter": "external-perimeter", "Internal infill": "infill",
         "Overhang perimeter": "overhang-perimeter", "Solid infill": "solid-infill", "Top solid infill": "top-infill",
         "Bridge infill": "bridge", "Gap fill": "gap-fill", "Support material": "support",
         "Support material interface": "support-interface", "Skirt/Brim": "skirt", "Custom": "custom",
         "Wipe tower": "wipe-tower"}


def unpacked(name):
    """A file of the corpus as plain text with the ending that the viewer wants; None if it is not there."""
    path = corpus(name)
    if not path or not name.endswith(".gz"):
        return path
    plain = os.path.join(FOLDER, name[:-3])
    with open(plain, "wb") as file:
        file.write(subprocess.run(["gzip", "-dc", path], capture_output=True, check=True).stdout)
    return plain


def changed(name, source, settings=(), tags=()):
    """A copy with other settings, and with tags before layers: (number of the layer from 1, text)."""
    with open(source, encoding="utf-8") as file:
        text = file.read()
    for key, value in settings:
        text = re.sub(f"(?m)^; {key} = .*$", f"; {key} = {value}", text)
    parts = text.split(";LAYER_CHANGE")
    for layer, tag in tags:
        parts[layer - 1] += tag + "\n"
    path = os.path.join(FOLDER, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(";LAYER_CHANGE".join(parts))
    return path


def shown(source):
    """What the viewer shows: colors from above, lines of the legend, layers."""
    preview = Preview(source, LOCALE)
    try:
        if not preview.ready(90):
            return None
        return [color for _, color in preview.swatches()], preview.legend(), preview.layers()
    finally:
        preview.close()


def stated(program, source, *options):
    report = os.path.join(tempfile.mkdtemp(dir=FOLDER), "report.json")
    done = subprocess.run([os.path.join(BIN, program), source, "--stats", report, *options], capture_output=True,
                          text=True)
    check(done.returncode == 0, f"{program} reads {os.path.basename(source)} {done.stderr.strip()[-200:]}")
    with open(report, encoding="utf-8") as file:
        return json.load(file)


def drawn_colors(source):
    """By tool, and within one in print order, as a picture of the file has them: pairs of tool and color, and which of
    them the file does not state."""
    picture = stated("vdbtrace", source, "--size", "8x8", "--spp", "1", "-o", os.path.join(FOLDER, "p.png"), "--force")
    rows = [(int(re.search(r"tool (\d+)", one["from"])[1]), one["color"], "palette" in one["from"])
            for one in picture["material"]["colors"]]
    return sorted(rows, key=lambda row: row[0])


def number(pattern, line):
    """A number whose point may be lost between the digits: `pattern` has two groups."""
    found = re.search(pattern, line)
    return float(f"{found[1]}.{found[2]}") if found else None


# --- what is looked at ------------------------------------------------------------------------------------------------

two = gcode("two_tone.gcode")
settings = [("extruder_colour", ";#DB5182"), ("filament_colour", "#102030;#77EE11")]
tags = [(5, ";COLOR_CHANGE,T0,#12AB34\nM600"), (7, ";COLOR_CHANGE,T0\nM600"), (9, ";COLOR_CHANGE,T0\nM0")]
SOURCES = {
    "an empty extruder_colour": changed("settings.gcode", two, settings),
    "changes of colour": changed("changes.gcode", two, tags=tags),
    "all features": gcode("knot.gcode"),
    "a Prusa MMU2S": unpacked("gcode-metadata-mk3s_mmu2s.gcode.gz"),
    "Simplify3D": corpus("filaswitch-mc_testmodel1_S3D.gcode"),
    "a Prusa MINI": corpus("libbgcode-mini_cube_a.gcode"),
    "volumetric E": corpus("volumetric_fwretract.gcode"),
    "AnycubicSlicer": unpacked("AnycubicSlicerImageIntractor-multicolor.gcode.gz"),
}
SOURCES = {name: source for name, source in SOURCES.items() if source}
FLOW = {"a Prusa MINI": 0.95}  # M221 S95, which the viewer does not heed
OTHER_LIMITS = {"AnycubicSlicer"}  # it reads the printer's limits in files of PrusaSlicer and its next kin alone
MOST_LOADED = 0.065  # m: the viewer counts filament that a tool is loaded with

with concurrent.futures.ThreadPoolExecutor(3) as pool:
    shows = dict(zip(SOURCES, pool.map(shown, SOURCES.values())))


def check_colors(source, colors):
    drawn = drawn_colors(source)
    # Of one tool the viewer lists the last color first.
    tools = sorted({tool for tool, _, _ in drawn})
    ours = [row for tool in tools for row in [one for one in drawn if one[0] == tool][::-1]]
    check(len(ours) == len(colors), f"  {len(colors)} colors, {' '.join(colors)}")
    known = [(color, theirs) for (_, color, palette), theirs in zip(ours, colors) if not palette]
    check(all(color == theirs for color, theirs in known), f"  the {len(known)} that the file states are ours")
    unnamed = [color for _, color, palette in ours if palette]
    check(len(set(unnamed)) == len(unnamed), "  the others differ from each other")


def check_tools(lines, report):
    ours = [tool["filament_mm"] / 1000 for tool in report["toolpath"]["tools"] if tool["filament_mm"] > 0]
    theirs = [number(r"(\d)\.?(\d\d) ?m", line) for line in lines if line.startswith("Extruder")]
    check(len(ours) == len(theirs) and all(-0.006 < there - here < MOST_LOADED for here, there in zip(ours, theirs)),
          f"  filament by tool, m: {theirs}")


def check_features(name, lines, report):
    printed = report["toolpath"]["features"]
    time = report["time"]
    area = math.pi * report["toolpath"]["filament_diameter_mm"] ** 2 / 4
    whole = time["planned_of_stated_s"]
    known = 0
    shares = {}
    for line in lines:
        # The longest name that fits: "Support material" begins two.
        label = max((one for one in NAMES if line.startswith(one)), key=len, default=None)
        if label is None:
            continue
        theirs = number(r"(\d)\.?(\d\d) ?m", line)
        if theirs is not None:
            ours = printed[NAMES[label]]["volume_mm3"] / area / 1000 / FLOW.get(name, 1)
            check(abs(ours - theirs) < 0.006, f"  {label}: {theirs} m of filament")
            known += 1
        shares[NAMES[label]] = number(r"(\d+)\.?(\d) ?%", line)
    check(known >= 0.8 * len(printed), f"  {known} of {len(printed)} features could be read")
    if name in OTHER_LIMITS or None in shares.values() or len(shares) < len(printed):
        return
    # The viewer gives travel and retraction to the feature before them, and shows none of what is before the first.
    ours = {feature: 100 * time["features_s"].get(feature, 0) / whole for feature in shares}
    check(all(ours[feature] < share + 0.15 for feature, share in shares.items()), f"  time, per cent: {shares}")
    moves = 100 * (time["travel_s"] + time["retraction_s"] + time["waiting_s"]) / whole
    check(abs(sum(shares.values()) - sum(ours.values()) - moves) < 1, f"  and travel and retraction, {moves:.1f}")


for name, show in shows.items():
    check(show is not None, f"the viewer shows {name}")
    colors, lines, layers = show
    report = stated("gcode2vdb", SOURCES[name], "--summary")
    check(layers == report["toolpath"]["layers"], f"  {layers} layers")
    if any("erimeter" in line for line in lines):
        check_features(name, lines, report)
    else:
        check_colors(SOURCES[name], colors)
    if any(line.startswith("Extruder1") for line in lines):
        check_tools(lines, report)
shutil.rmtree(FOLDER)

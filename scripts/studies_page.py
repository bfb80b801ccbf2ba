#!/usr/bin/env python3
"""Writes the ten lines of docs/studies/README.md from the studies' CSV files.

    scripts/studies_page.py STUDIES_FOLDER [--check]

Every number links to the line of the CSV file that it was measured in (GitHub and browsers show it). Lines whose table is
missing or of an older form say so. --check writes nothing and fails if README.md would change.
"""
import csv
import math
import pathlib
import re
import statistics
import sys

OLD = "not measured here by this version"


class Table:
    """Rows of a CSV file, each with the number of its line."""

    def __init__(self, path):
        self.path, self.rows = path, []
        if not path.exists():
            return
        with path.open(newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            line = 2
            for row in reader:
                self.rows.append(row | {"line": line, "table": path.stem, "folder": path.parent.name})
                line = reader.line_num + 1

    def where(self, **wanted):
        return [r for r in self.rows if all(r.get(key) == value for key, value in wanted.items())]


def prints_table(folder):
    """The comparison of prints on all threads, and on one where it was made."""
    table = Table(folder / "polygons_prints.csv")
    table.rows += Table(folder / "one_thread" / "polygons_prints.csv").rows
    return table


class Number:
    """A number as it is shown, and the row that it is of."""

    def __init__(self, text, row):
        self.text, self.row = text, row


def number(row, key):
    text = row[key]
    return float(text) if text not in ("", None) else math.nan


def law(points):
    """(factor, exponent) of y = factor x^exponent by least squares of the logarithms."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mx = statistics.mean(x for x, _ in logs)
    my = statistics.mean(y for _, y in logs)
    slope = sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)
    return math.exp(my - slope * mx), slope


def percent(value):
    return f"{value:+.2g} %" if abs(value) < 10 else f"{value:+.0f} %"


def micrometres(mm):
    return f"{1e3 * mm:.3g} µm"


# --- the lines: lists of text and numbers ----------------------------------------------------------------------------


def print_total(row, spp=32):
    return number(row, "convert_cpu") + number(row, "build_cpu") + number(row, "render_cpu") * spp / number(row, "spp")


def best_of(rows, level_sets, total, spp):
    """The fastest of a side that is exact enough for a picture of so many samples, if one is: its bias is below the
    noise, which is measured of 32 samples whatever the row's times are of, and falls with their number."""
    side = [r for r in rows if r["representation"].startswith("level set") == level_sets and not math.isnan(total(r))]

    def biased(row):
        return not number(row, "bias") < number(row, "noise") * 32 / spp

    return min(side, key=lambda r: (biased(r), total(r)), default=None)


def print_matches(table, integrator, total, spp=32):
    """(ratio, level set, peer) of each print and number of threads: above 1 the level set is faster."""
    groups = {}
    for row in table.where(integrator=integrator):
        groups.setdefault((row["print"], row["threads"], row["size"]), []).append(row)
    largest = {}
    for (name, threads, size), rows in groups.items():
        pixels = math.prod(int(n) for n in size.split("x"))
        if pixels > largest.get((name, threads), (0, None))[0]:
            largest[name, threads] = (pixels, rows)
    found = []
    for _, rows in largest.values():
        own, peer = best_of(rows, True, total, spp), best_of(rows, False, total, spp)
        if own and peer:
            found.append((total(peer) / total(own), own, peer))
    return sorted(found, key=lambda match: match[0])


def prints_line(folder):
    table = prints_table(folder)
    matches = print_matches(table, "path", print_total)
    if not matches:
        return None
    low, middle, high = matches[0], matches[len(matches) // 2], matches[-1]
    ahead = sum(ratio > 1 for ratio, _, _ in matches)
    line = ["When is marching better than polygons? For prints, path traced with 32 samples: the level set is ",
            Number(f"{low[0]:.2f}", low[1]), " to ", Number(f"{high[0]:.2f}", high[1]),
            " × as fast as the best of beads and prisms (median ", Number(f"{middle[0]:.2f}", middle[1]),
            f"), ahead in {ahead} of {len(matches)} cases of print and threads"]
    fewer = [own["spp"] for _, own, _ in matches if own["spp"] != "32"]
    if fewer:
        line.append(f" ({len(fewer)} of them told in proportion from {', '.join(sorted(set(fewer)))} samples)")
    first = print_matches(table, "path", lambda row: number(row, "first_look_cpu"), spp=1)
    if first:
        one = first[len(first) // 2]
        line += ["; for a first look of one sample it is ", Number(f"{one[0]:.2f}", one[1]),
                 " × as fast (median)"]
    return line + ["."]


def scenes_line(folder):
    table = Table(folder / "polygons_scenes.csv")
    scenes = {}
    for row in table.rows:
        scenes.setdefault(row["scene"], {}).setdefault(row["representation"], []).append(row)

    def mean(rows):
        return statistics.mean(number(r, "cpu_seconds") for r in rows)

    def against(own, other):
        return [(mean(s[other]) / mean(s[own]), s[own][0]) for s in scenes.values() if own in s and other in s]

    line = []
    for words, own, other in (("the formula itself", "SDF, by formula", "high mesh, every triangle"),
                              ("a level set", "level set, brick", "high mesh, every triangle"),
                              ("a level set", "level set, brick", "high mesh, Embree")):
        found = sorted(against(own, other), key=lambda pair: pair[0])
        if found:
            middle = found[len(found) // 2]
            what = "without a hierarchy" if "every" in other else "in Embree's hierarchy"
            line += [", " if line else "", f"{words} is ", Number(f"{middle[0]:.2g}", middle[1]),
                     f" × as fast as round meshes {what}"]
    return ["For shapes of a few spheres and boxes (medians of the scenes): ", *line, "."] if line else None


def seeing_line(folder):
    table = Table(folder / "polygons_prints.csv")
    shown = []
    for least, most, words in ((0, 30, "of some 10 cm³"), (30, 300, "of 100"), (300, 1e9, "of 1000")):
        rows = [r for r in table.where(integrator="path")
                if r["representation"].startswith("level set") and least <= number(r, "enclosed_cm3") < most
                and number(r, "first_look_cpu") > 0]
        size = max((r["size"] for r in rows), key=lambda s: math.prod(int(n) for n in s.split("x")), default=None)
        rows = sorted((r for r in rows if r["size"] == size), key=print_total)
        if rows:
            look = min(rows, key=lambda r: number(r, "first_look_cpu"))
            row = rows[len(rows) // 2]
            shown += ["; " if shown else "", f"{words} ", Number(f"{number(look, 'first_look_cpu'):.2g} s", look),
                      " to a first look, ", Number(f"{print_total(row):.2g} s", row), " for 32 samples"]
    return ["What does a print cost to see? CPU time from its beads: ", *shown, "."] if shown else None


def memory_line(folder):
    table = Table(folder / "memory.csv")
    kept = [r for r in table.where(interior="keep", status="ok") if r["voxels_per_layer"] == "2"]
    if not kept:
        return None
    row = max(kept, key=lambda r: number(r, "part_mm3"))
    line = [f"In memory a print of {number(row, 'part_mm3') / 1e3:.3g} cm³ of plastic takes ",
            Number(f"{number(row, 'grid_bytes') / number(row, 'part_mm3'):.0f} bytes a mm³", row),
            f" at {number(row, 'voxel_mm'):g} mm"]
    culled = table.where(print=row["print"], interior="cull", voxels_per_layer="2")
    if culled:
        line += [", ", Number(f"{number(culled[0], 'grid_bytes') / number(row, 'part_mm3'):.0f}", culled[0]),
                 " without what the outside can't see"]
    streamed = table.where(print=row["print"], interior="keep, no grid", voxels_per_layer="2", status="ok")
    if streamed:
        line += ["; written without a grid its process has ",
                 Number(f"{number(streamed[0], 'peak_rss_bytes') / 1e6:.0f} MB", streamed[0]), " at most, instead of ",
                 Number(f"{number(row, 'peak_rss_bytes') / 1e6:.0f}", row)]
    off = []
    for name in {r["print"] for r in table.rows}:
        for way in ("keep", "cull"):
            rows = sorted(table.where(print=name, interior=way, status="ok"), key=lambda r: -number(r, "voxel_mm"))
            if len(rows) > 2:
                factor, slope = law([(number(r, "voxel_mm"), number(r, "grid_bytes")) for r in rows[:-1]])
                finest = rows[-1]
                off.append((factor * number(finest, "voxel_mm") ** slope / number(finest, "grid_bytes") - 1, finest))
    if off:
        worst = max(off, key=lambda pair: abs(pair[0]))
        line += ["; a power law of the coarser sizes foretells the finest within ",
                 Number(f"{abs(100 * worst[0]):.2g} %", worst[1])]
    return line + ["."]


def voxel_line(folder):
    table = Table(folder / "geometry.csv")
    line = []
    for beads in ("union", "settled"):
        for count in ("2", "4"):
            rows = [r for r in table.where(lattice="aligned", per_layer=count, half_width="3", precision="float")
                    if r.get("beads_are", "union") == beads]
            if not rows:
                continue
            row = rows[0]
            gone = number(row, "narrow_share") + (1 - number(row, "narrow_share")) * number(row, "lost_share")
            line += ["; " if line else "", f"{beads}, {number(row, 'voxel_mm'):g} mm: ",
                     Number(micrometres(number(row, "mean_mm")), row), " there and ",
                     Number(micrometres(number(row, "back_mean_mm")), row), " back on the mean, ",
                     Number(f"{100 * gone:.0f} %", row), " of the exact surface not there"]
    return ["Which voxel for which error? ", *line,
            " (slits between beads, narrower than two voxels)."] if line else None


def falling_line(folder):
    table = Table(folder / "geometry.csv")
    rows = [r for r in table.where(lattice="aligned", half_width="3", precision="float") if r.get("beads_are", "union") == "union"]
    line = []
    if len(rows) > 2:
        line += ["of surfaces as the voxel to the power ",
                 Number(f"{law([(number(r, 'voxel_mm'), number(r, 'mean_mm')) for r in rows])[1]:.2f}", rows[-1]),
                 " and the time to ",
                 Number(f"{law([(number(r, 'seconds'), number(r, 'mean_mm')) for r in rows])[1]:.2f}", rows[-1])]
    render = Table(folder / "render.csv").where(variant="brick")
    points = {}
    for row in render:
        points.setdefault(int(row["spp"]), []).append(row)
    if len(points) > 2:
        cpu = [(statistics.median(number(r, "cpu_seconds") for r in group), statistics.mean(number(r, "rel_mse") for r in group))
               for _, group in sorted(points.items())]
        line += [", of pictures (relMSE) as the CPU time to ", Number(f"{law(cpu)[1]:.2f}", points[max(points)][0])]
    return ["How does error fall with time? ", *line, "."] if line else None


def picture_line(folder):
    table = Table(folder / "render.csv")

    def point(variant):
        rows = table.where(variant=variant)
        if not rows:
            return None
        most = max(int(r["spp"]) for r in rows)
        rows = [r for r in rows if int(r["spp"]) == most]
        errors = [number(r, "rel_mse") for r in rows]
        spread = statistics.stdev(errors) if len(errors) > 1 else 0
        return most, statistics.median(number(r, "cpu_seconds") for r in rows), statistics.mean(errors), spread, rows[0]

    line = []
    for variant, words in (("default picture", "the default picture, denoised"), ("brick", "unbiased"), ("denoised", "denoised")):
        found = point(variant)
        if found:
            spp, cpu, error, spread, row = found
            line += ["; " if line else "", f"{words}, {spp} samples: relMSE ",
                     Number(f"{error:.1e} ± {spread:.0e}", row), " in ", Number(f"{cpu:.2g} CPU s", row)]
    return [f"A picture of {table.rows[0]['size']} pixels: ", *line, "."] if line else None


def stable_line(folder):
    table = Table(folder / "stability.csv")
    if not table.rows:
        return None
    failed = [r for r in table.rows if r["verdict"] != "passed"]
    families = {}
    for row in table.rows:
        families.setdefault(row["family"], []).append(row)
    line = [f"What is stable? Of {len(table.rows)} stiff and extreme cases {len(failed)} fail their tolerance: "]
    for n, (family, rows) in enumerate(families.items()):
        line += [", " if n else "", Number(f"{len(rows)} of {family}", rows[0])]
    return line + ["."]


def left_out_line(folder):
    line = []
    for row in Table(folder / "need_off.csv").rows:
        line += [", " if line else "With all capabilities off a ", f"{row['work']} takes ",
                 Number(f"{number(row, 'instructions') / 1e6:.0f} M", row), " instructions"]
    need = Table(folder / "need.csv")

    def median(capability):
        return statistics.median(number(r, "render_cpu") for r in need.where(capability=capability))

    names = {r["capability"] for r in need.rows} - {"none", "none, once more"}
    if names and need.where(capability="none"):
        dearest = max(names, key=median)
        line += [". " if line else "", f"Of those that are on, {dearest} takes the most: ",
                 Number(f"{median(dearest) / median('none'):.1f} ×", need.where(capability=dearest)[0]),
                 " the CPU time of a picture without any. The same picture twice differs by ",
                 Number(percent(100 * (median("none, once more") / median("none") - 1)),
                        need.where(capability="none, once more")[0])]
    return ["What does a picture pay for what it does not use? ", *line, "."] if line else None


def plastic_line(folder):
    volume = Table(folder / "deposit_volume.csv")
    line = []
    for name in ("union", "settled", "typical"):
        rows = [r for r in volume.where(beads_are=name) if r["sha256"] != "-"]
        finest = max((int(r["per_layer"]) for r in rows), default=None)
        rows = sorted((r for r in rows if int(r["per_layer"]) == finest), key=lambda r: number(r, "of_fed_percent"))
        if rows:
            row = rows[len(rows) // 2]
            line += [", " if line else "beside what was fed the level set holds ", f"{name} ",
                     Number(percent(number(row, "of_fed_percent")), row)]
    rough = Table(folder / "deposit_roughness.csv").where(layer_mm="0.2", section_percent="100", flow_percent="100")
    if rough:
        line += ["; a wall of 0.2 mm layers has Ra ", Number(f"{number(rough[0], 'ra_um'):.1f} µm", rough[0]),
                 " (published 15.3 to 18.1)"]
    times = sorted((r for r in Table(folder / "deposit_time.csv").where(status="ok")), key=lambda r: abs(number(r, "off_percent")))
    if times:
        row = times[len(times) // 2]
        line += ["; planned times differ from stated ones by ", Number(f"{abs(number(row, 'off_percent')):.2g} %", row),
                 " (median)"]
    return ["How near is the model to plastic? ", *line, "."] if line else None


LINES = [
    ("marching", prints_line), ("shapes", scenes_line), ("cost of a look", seeing_line), ("memory", memory_line),
    ("voxel and error", voxel_line), ("error and time", falling_line), ("pictures", picture_line), ("stability", stable_line),
    ("left out", left_out_line), ("plastic", plastic_line),
]


# --- out ---------------------------------------------------------------------------------------------------------------


def place(row):
    """The folder of a table below that of the studies, if it is one."""
    return "" if row["folder"] == FOLDER.resolve().name or row["folder"] == FOLDER.name else row["folder"] + "/"


def as_markdown(parts):
    return "".join(p if isinstance(p, str) else
                   f"[{p.text}]({place(p.row)}{p.row['table']}.csv?plain=1#L{p.row['line']})" for p in parts)


def main():
    lines = []
    for name, make in LINES:
        try:
            lines.append(make(FOLDER) or [f"({name}: {OLD})"])
        except KeyError:  # a column that older tables lack
            lines.append([f"({name}: {OLD})"])
    text = "\n".join(f"{n}. {as_markdown(line)}" for n, line in enumerate(lines, 1))
    readme = FOLDER / "README.md"
    old = readme.read_text(encoding="utf-8") if readme.exists() else "# Studies\n\n<!-- ten lines -->\n<!-- /ten lines -->\n"
    pattern = re.compile(r"(<!-- ten lines -->\n).*?(<!-- /ten lines -->)", re.S)
    if not pattern.search(old):
        sys.exit(f"{readme}: has no place for the ten lines")
    new = pattern.sub(lambda m: m.group(1) + "\n" + text + "\n\n" + m.group(2), old)
    if "--check" in sys.argv:
        sys.exit(0 if new == old else f"{readme}: its lines are not those of the tables; run scripts/studies_page.py")
    readme.write_text(new, encoding="utf-8")


if len(sys.argv) < 2:
    sys.exit(__doc__)
FOLDER = pathlib.Path(sys.argv[1])
main()

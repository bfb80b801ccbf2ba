#!/usr/bin/env python3
"""Replaces runs of extruding G1 that lie on a circle by G2 and G3, as firmware's "arc welding" plugins do.

    weld_arcs.py IN.gcode OUT.gcode [TOLERANCE_MM]

For programs with relative E and G1 X Y E moves at one height, as data/slice.sh makes them. The points of a run lie within the
tolerance (0.02 mm) of its circle, turn one way, and are fed evenly to 2 %. E of the arc is the sum of the run.
"""
import math
import re
import sys

MOVE = re.compile(r"G1 X([-\d.]+) Y([-\d.]+) E([\d.]+)\s*(;.*)?$")
LEAST_POINTS = 5
LARGEST_RADIUS = 200.0  # mm


def circle(a, b, c):
    """Center of the circle through three points, or None."""
    ax, ay, bx, by = a[0] - c[0], a[1] - c[1], b[0] - c[0], b[1] - c[1]
    cross = 2 * (ax * by - ay * bx)
    if abs(cross) < 1e-9:
        return None
    a2, b2 = ax * ax + ay * ay, bx * bx + by * by
    return c[0] + (by * a2 - ay * b2) / cross, c[1] + (ax * b2 - bx * a2) / cross


def fits(points, feeds, tolerance):
    """The center and the turn of the arc through the points, or None."""
    center = circle(points[0], points[len(points) // 2], points[-1])
    if center is None:
        return None
    radius = math.dist(center, points[0])
    if radius > LARGEST_RADIUS:
        return None
    turn, rates = 0.0, []
    for start, end, feed in zip(points, points[1:], feeds):
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        if abs(math.dist(center, end) - radius) > tolerance or radius - math.dist(center, middle) > tolerance:
            return None
        a, b = (math.atan2(p[1] - center[1], p[0] - center[0]) for p in (start, end))
        step = (b - a + math.pi) % (2 * math.pi) - math.pi
        if step * turn < 0 or step == 0:
            return None
        turn += step
        rates.append(feed / math.dist(start, end))
    even = max(rates) <= 1.02 * min(rates)
    return (center, turn) if even and abs(turn) < 1.9 * math.pi else None


def main():
    source, target = sys.argv[1:3]
    tolerance = float(sys.argv[3]) if len(sys.argv) > 3 else 0.02
    out, run, feeds, lines, place = [], [], [], [], None

    def flush():
        """Writes what is in the run: as an arc where it is one."""
        nonlocal run, feeds, lines
        if len(run) > LEAST_POINTS and (arc := fits(run, feeds, tolerance)):
            (x, y), turn = arc
            out.append(f"G{3 if turn > 0 else 2} X{run[-1][0]:.3f} Y{run[-1][1]:.3f} I{x - run[0][0]:.3f} J{y - run[0][1]:.3f} "
                       f"E{sum(feeds):.5f}")
        else:
            out.extend(lines)
        run, feeds, lines = [], [], []

    for line in open(source, encoding="utf-8").read().splitlines():
        move = MOVE.match(line)
        if not move:
            flush()
            words = re.match(r"G[01] X([-\d.]+) Y([-\d.]+)", line)
            place = tuple(map(float, words.groups())) if words else place if not line.startswith("G28") else None
            out.append(line)
            continue
        end, feed = (float(move[1]), float(move[2])), float(move[3])
        if place is None:
            out.append(line)
        else:
            grown, fed = (run or [place]) + [end], feeds + [feed]
            if len(grown) > 3 and not fits(grown, fed, tolerance):
                flush()
                grown, fed = [place, end], [feed]
            run, feeds = grown, fed
            lines.append(line)
        place = end
    flush()
    open(target, "w", encoding="utf-8").write("\n".join(out) + "\n")


if __name__ == "__main__":
    main()

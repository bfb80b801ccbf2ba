#!/usr/bin/env python3
"""Draws the rooms of src/ and who includes whom, as the sources say: docs/pictures/rooms.svg.

    scripts/rooms.py [FILE.svg]

A box is a room with its folders, files and lines. An arrow goes from a room to one that it includes; its width and title
are the files that do. Rooms stand above all that they include. Arrows that another path of arrows implies are left out, and
those to base, which all include.
"""

import collections
import os
import re
import sys
import textwrap

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SHARED = {"base"}  # included by nearly all: named in the picture, not drawn as arrows
WIDTH, HEIGHT, GAP_X, GAP_Y = 190, 92, 46, 74


def read_rooms():
    """Rooms with (folders, files, lines), and the number of files of one room that include from another."""
    rooms, arrows = {}, collections.Counter()
    places = {name: os.path.join(ROOT, "src", name) for name in os.listdir(os.path.join(ROOT, "src"))}
    places["tools"] = os.path.join(ROOT, "tools")
    for room, top in places.items():
        folders, files, lines = set(), 0, 0
        for folder, _, names in os.walk(top):
            for name in names:
                if not name.endswith((".h", ".cpp")):
                    continue
                with open(os.path.join(folder, name), encoding="utf-8") as file:
                    text = file.read()
                files += 1
                lines += text.count("\n")
                if folder != top:
                    folders.add(os.path.basename(folder))
                for other in set(re.findall(r'^#include "(\w+)/', text, re.M)) - {room}:
                    if other in places:
                        arrows[room, other] += 1
        rooms[room] = (sorted(folders), files, lines)
    return rooms, arrows


def heights(rooms, arrows):
    """The longest path of arrows below each room."""
    result = {}

    def height(room, above=()):
        if room in above:
            sys.exit(f"a cycle: {' > '.join(above)} > {room}")
        if room not in result:
            result[room] = max((1 + height(b, (*above, room)) for a, b in arrows if a == room), default=0)
        return result[room]

    for room in rooms:
        height(room)
    return result


def implied(arrows):
    """Arrows that a longer path of arrows stands for."""
    below = collections.defaultdict(set)
    for a, b in arrows:
        below[a].add(b)

    def reaches(a, b):
        return b in below[a] or any(reaches(c, b) for c in below[a])

    return {(a, b) for a, b in arrows if any(reaches(c, b) for c in below[a] - {b})}


def draw(rooms, arrows):
    level = heights(rooms, arrows)
    rows = collections.defaultdict(list)
    for room in sorted(rooms, key=lambda r: (-rooms[r][2], r)):
        rows[level[room]].append(room)
    widest = max(len(row) for row in rows.values())
    total = widest * (WIDTH + GAP_X) + GAP_X
    top = max(rows)
    spot = {}
    for y, row in rows.items():
        # Where those that a room includes stand, so that arrows cross seldom.
        below = {room: [spot[b][0] for a, b in arrows if a == room and b in spot] for room in row}
        row.sort(key=lambda room: (sum(below[room]) / len(below[room]) if below[room] else 0, room))
        left = (total - len(row) * (WIDTH + GAP_X) + GAP_X) / 2
        for x, room in enumerate(row):
            spot[room] = (left + x * (WIDTH + GAP_X), 20 + (top - y) * (HEIGHT + GAP_Y))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total:.0f} {(top + 1) * (HEIGHT + GAP_Y)}" '
           'font-family="DejaVu Sans, Helvetica, sans-serif" font-size="11">',
           '<defs><marker id="a" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto" '
           'markerUnits="userSpaceOnUse"><path d="M0,0 L8,4 L0,8 z" fill="#445"/></marker></defs>',
           '<rect width="100%" height="100%" fill="white"/>']
    thin = implied(arrows)
    for (a, b), count in sorted(arrows.items()):
        if b in SHARED or (a, b) in thin:
            continue
        (ax, ay), (bx, by) = spot[a], spot[b]
        x1, y1, x2, y2 = ax + WIDTH / 2, ay + HEIGHT, bx + WIDTH / 2, by - 2
        middle = (y1 + y2) / 2
        out.append(f'<path d="M{x1:.0f},{y1} C{x1:.0f},{middle:.0f} {x2:.0f},{middle:.0f} {x2:.0f},{y2}" fill="none" '
                   f'stroke="#445" stroke-width="{1 + min(count, 40) / 12:.1f}" '
                   f'marker-end="url(#a)"><title>{a} includes from {b}: {count} files</title></path>')
    for room, (x, y) in spot.items():
        folders, files, lines = rooms[room]
        out.append(f'<rect x="{x:.0f}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="6" fill="#f4f6fa" stroke="#445"/>')
        out.append(f'<text x="{x + WIDTH / 2:.0f}" y="{y + 20}" text-anchor="middle" font-size="15" font-weight="bold">'
                   f'{room}</text>')
        out.append(f'<text x="{x + WIDTH / 2:.0f}" y="{y + 37}" text-anchor="middle" fill="#556">{files} files, '
                   f'{lines} lines</text>')
        if room in SHARED:
            folders = ["included", "by", "all"]
        for n, line in enumerate(textwrap.wrap(" ".join(folders), 30)[:3]):
            out.append(f'<text x="{x + WIDTH / 2:.0f}" y="{y + 54 + 14 * n}" text-anchor="middle">{line}</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"


def main():
    if len(sys.argv) > 1 and not sys.argv[1].endswith(".svg"):
        sys.exit(__doc__)
    target = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "docs", "pictures", "rooms.svg")
    with open(target, "w", encoding="utf-8") as file:
        file.write(draw(*read_rooms()))


main()

"""What a program by PrusaSlicer with relative E does, read with nothing of the project: the page's numbers must be these."""

import re


class Program:
    """Of `moves` each has kind, places, layer (of the bead that it leads to), the number of beads before it, and line.
    `beads` are (line, layer, feature, start, end, seconds at the programmed speed)."""

    def __init__(self, path):
        self.moves, self.beads, self.tops = [], [], {}
        self.heat, self.fan, self.acceleration = [], [], []  # by bead
        heat, fan, acceleration = 0.0, 0.0, 0.0
        place, feed, layer, feature = [0.0, 0.0, 0.0], 0.0, 0, ""
        waiting = []  # moves that lead to the next bead
        travelled, outer, relative = True, False, False
        with open(path, encoding="utf-8") as file:
            lines = file.read().split("\n")
        for number, line in enumerate(lines, 1):
            if line.startswith(";LAYER_CHANGE"):
                layer += 1
            if line.startswith(";TYPE:"):
                feature = line[6:].strip()
            code = line.split(";")[0]
            words = dict((w[0], float(w[1:])) for w in re.findall(r"[A-Z]-?[0-9.]+", code))
            if words.get("M") in (0, 1, 25, 226, 601):
                waiting.append(("pauses", place[:], place[:], number))
            if words.get("M") == 600:
                waiting.append(("filament changes", place[:], place[:], number))
            if words.get("M") in (104, 109):
                heat = words["S"] or heat
            if words.get("M") in (106, 107):
                fan = words.get("S", 0) / 2.55
            if words.get("M") == 204:
                acceleration = words.get("P", words.get("S", acceleration))
            if words.get("G") in (90, 91):
                relative = words["G"] == 91
            if words.get("G") not in (0, 1):
                continue
            feed = words.get("F", feed)
            target = [words.get(axis, 0) + at if relative else words.get(axis, at) for axis, at in zip("XYZ", place)]
            drive, moves = words.get("E", 0), target != place
            if moves and drive > 0:
                if feature == "External perimeter" and (travelled or not outer):
                    waiting.append(("seams", place[:], place[:], number))
                outer = feature in ("External perimeter", "Overhang perimeter")
                for kind, start, end, at in waiting:
                    self.moves.append((kind, start, end, layer, len(self.beads), at))
                waiting, travelled = [], False
                length = sum((a - b) ** 2 for a, b in zip(place, target)) ** 0.5
                self.heat.append(heat)
                self.fan.append(fan)
                self.acceleration.append(acceleration)
                self.beads.append((number, layer, feature, place[:], target, length / (feed / 60)))
                self.tops[layer] = max(self.tops.get(layer, 0), target[2])
            elif moves:
                waiting.append(("wipes" if drive < 0 else "travels", place[:], target, number))
                travelled = True
            elif drive:
                waiting.append(("retractions" if drive < 0 else "recoveries", place[:], target, number))
            place = target
        self.layers = layer
        last = self.beads[-1][1]
        self.moves += [(kind, start, end, last, len(self.beads), at) for kind, start, end, at in waiting]

    def count(self, kind, low=1, high=10**9, beads=10**9):
        """Moves of these layers before so many beads; prime lines are in layer 0."""
        return sum(m[0] == kind and low <= m[3] <= high and m[4] < beads for m in self.moves)

    def of_layer(self, layer):
        """The numbers of its beads."""
        return [n for n, bead in enumerate(self.beads) if bead[1] == layer]

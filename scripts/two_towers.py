#!/usr/bin/env python3
"""G-code of two square towers, 10 mm wide, 15 mm high and 20 mm apart, whose nozzle goes to and fro in each layer: what
printers are tuned for strings with. Writes to standard output.

scripts/two_towers.py [MM]   retracts so many mm before each travel between the towers (default 0)
"""
import math
import sys

HEIGHT, WIDTH, LAYERS = 0.2, 0.45, 75
E_PER_MM = (WIDTH * HEIGHT - (1 - math.pi / 4) * HEIGHT**2) / (math.pi / 4 * 1.75**2)


def square(x, y, half):
    """Moves around it."""
    corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
    for to_x, to_y in corners[1:] + corners[:1]:
        print(f"G1 X{to_x:.3f} Y{to_y:.3f} E{2 * half * E_PER_MM:.5f} F2400")


def main():
    back = float(sys.argv[1]) if len(sys.argv) > 1 else 0
    print("M83\nM204 P1500 T1500\nM205 X8 Y8")
    for layer in range(1, LAYERS + 1):
        z = layer * HEIGHT
        print(f";LAYER_CHANGE\n;Z:{z:.2f}\n;HEIGHT:{HEIGHT}\nG1 Z{z:.2f} F600")
        for x in (100, 130):
            for half, feature in ((5, "External perimeter"), (4.58, "Perimeter")):
                print(f"G1 X{x - half:.3f} Y{100 - half:.3f} F9000")
                if back > 0 and half == 5 and (layer, x) != (1, 100):
                    print(f"G1 E{back:g} F1800")
                print(f";TYPE:{feature}")
                square(x, 100, half)
            if back > 0:
                print(f"G1 E-{back:g} F1800")


if __name__ == "__main__":
    main()

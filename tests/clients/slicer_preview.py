"""PrusaSlicer's G-code viewer on a display of its own: what its legend shows, as pixels and as text."""

import ctypes
import os
import re
import shutil
import struct
import subprocess
import tempfile
import time

PROGRAMS = ("prusa-gcodeviewer", "Xvfb", "localedef")
WIDTH, HEIGHT = 1200, 1000
TEXT, SWATCH = 28, 15  # x in pixels: where the legend's text begins, and a column in its swatches


def make_locale(folder):
    """Without this language the viewer asks for it in a window, and waits."""
    path = os.path.join(folder, "locale")
    os.makedirs(path)
    subprocess.run(["localedef", "-i", "en_US", "-f", "UTF-8", os.path.join(path, "en_US.UTF-8")], capture_output=True)
    return path


class Preview:
    """One file in the viewer. The display is a file of pixels."""

    def __init__(self, source, locale):
        self.folder = tempfile.mkdtemp(prefix="stratum_preview_")
        with open(os.path.join(self.folder, "PrusaSlicerGcodeViewer.ini"), "w", encoding="ascii") as file:
            file.write(f"show_hints = 0\nwindow_mainframe = 0; 0; {WIDTH}; {HEIGHT}; 0\n")
        # Xvfb chooses its number, and tells it when programs may connect.
        read, written = os.pipe()
        self.programs = [subprocess.Popen(
            ["Xvfb", "-nocursor", "-displayfd", str(written), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir",
             self.folder], pass_fds=(written,), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)]
        os.close(written)
        with os.fdopen(read) as said:
            self.display = ":" + said.readline().strip()
        environment = dict(os.environ, DISPLAY=self.display, LOCPATH=locale, LC_ALL="en_US.UTF-8", LANG="en_US.UTF-8",
                           LIBGL_ALWAYS_SOFTWARE="1", HOME=self.folder)
        self.programs.append(subprocess.Popen(["prusa-gcodeviewer", "--datadir", self.folder, source],
                                              env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        self.move_pointer_away()

    def move_pointer_away(self):
        """To a corner: over the legend it lights a row up, and covers others with a hint."""
        x11 = ctypes.CDLL("libX11.so.6")
        x11.XOpenDisplay.restype = ctypes.c_void_p
        x11.XDefaultRootWindow.restype = ctypes.c_ulong
        display = ctypes.c_void_p(x11.XOpenDisplay(self.display.encode()))
        root = ctypes.c_ulong(x11.XDefaultRootWindow(display))
        x11.XWarpPointer(display, ctypes.c_ulong(0), root, 0, 0, 0, 0, WIDTH - 1, 0)
        x11.XCloseDisplay(display)

    def screen(self):
        """The pixels, four bytes each: blue, green, red, none. Empty while there is no display."""
        try:
            with open(os.path.join(self.folder, "Xvfb_screen0"), "rb") as file:
                data = file.read()
            head = struct.unpack(">25I", data[:100])  # of an XWD file
            begin = head[0] + 12 * head[19]
            return data[begin:begin + 4 * WIDTH * HEIGHT]
        except (OSError, struct.error):
            return b""

    def swatches(self):
        """The legend's colors from above: pairs of the lower edge in pixels, and #rrggbb."""
        screen, found, run, last = self.screen(), [], 0, None

        def pixel(x, y):
            return screen[4 * (y * WIDTH + x):][:3]

        if not screen:
            return []
        for y in range(40, HEIGHT // 2):
            color = pixel(SWATCH, y)
            same = color == last == pixel(SWATCH + 4, y) == pixel(SWATCH - 4, y) != pixel(TEXT - 3, y)
            run, last = run + 1 if same else 0, color
            if run == 9:
                found.append((y + 5, "#" + color[::-1].hex()))
        return found

    def ready(self, seconds):
        """Waits until there is a legend, and the picture rests."""
        end, before, rests = time.monotonic() + seconds, None, 0
        while time.monotonic() < end and rests < 3:
            time.sleep(0.5)
            screen = self.screen()
            rests = rests + 1 if screen == before and self.swatches() else 0
            before = screen
        return rests == 3

    def read(self, left, top, right, bottom):
        """The text of a part of the screen, as tesseract reads it: the lines."""
        screen, scale, rows = self.screen(), 4, []
        for y in range(top, bottom):
            green = screen[4 * (y * WIDTH + left) + 1:4 * (y * WIDTH + right):4]
            rows.append([255 - value for value in green])
        path = os.path.join(self.folder, "part.pgm")
        with open(path, "wb") as file:
            file.write(b"P5 %d %d 255\n" % ((right - left) * scale, (bottom - top) * scale))
            file.write(enlarged(rows, scale))
        done = subprocess.run(["tesseract", path, "-", "--psm", "6"], capture_output=True, text=True, check=True)
        return [line for line in done.stdout.splitlines() if line.strip()]

    def legend(self):
        """The lines beside the swatches. The rule under the head is as wide as the legend."""
        screen = self.screen()

        def is_rule(x, y):
            blue, green, red = screen[4 * (y * WIDTH + x):][:3]
            return red > 150 and 60 < green < 140 and blue < 100

        rule = next(y for y in range(45, 70) if all(is_rule(x, y) for x in range(SWATCH, 3 * SWATCH)))
        right = next(x for x in range(SWATCH, WIDTH) if not is_rule(x, rule))
        return self.read(TEXT, rule + 3, right, self.swatches()[-1][0] + 6)

    def layers(self):
        """Beside the upper handle of the slider: the z, and the number of layers in parentheses."""
        return int(re.search(r"\((\d+)", " ".join(self.read(1080, 26, 1130, 62)))[1])

    def close(self):
        for program in reversed(self.programs):
            program.kill()
            program.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def enlarged(rows, scale):
    """Bytes of a picture that is `scale` times as large, linear between the pixels."""

    def between(a, b, n):
        return (a * (scale - n) + b * n) // scale

    wide = [[between(a, b, n) for a, b in zip(row, row[1:] + row[-1:]) for n in range(scale)] for row in rows]
    return b"".join(bytes(between(a, b, n) for a, b in zip(upper, lower))
                    for upper, lower in zip(wide, wide[1:] + wide[-1:]) for n in range(scale))

#!/usr/bin/env python3
"""A short film of the viewer's layer slider: docs/pictures/viewer_layers.webp.

    /usr/bin/python3 scripts/viewer_film.py build/release/bin [docs/pictures/viewer_layers.webp]

Real headless Chromium shows data/gcode/hull.gcode; the upper handle goes up, and each frame is a screenshot of the page
at rest. Needs chromium, chromium-driver, python3-selenium and python3-pil.
"""

import io
import os
import subprocess
import sys
import tempfile
import time

from PIL import Image

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "tests/clients"))
from chromium import browser

FRAMES = 28
SECONDS_A_FRAME = 0.12


def at_rest(page):
    """Waits for the finished picture of the last view."""
    end = time.monotonic() + 120
    while time.monotonic() < end:
        if page.execute_script("return (window.vdbviewLog ?? []).some((e) => e.kind === 'final' && "
                               "e.number === window.vdbviewAsked())"):
            time.sleep(0.2)  # until it is painted
            return
        time.sleep(0.05)
    sys.exit("no picture within 120 s")


def main():
    output = sys.argv[2] if len(sys.argv) > 2 else os.path.join(ROOT, "docs/pictures/viewer_layers.webp")
    gcode = os.path.join(ROOT, "data/gcode/hull.gcode")
    server = subprocess.Popen([os.path.join(sys.argv[1], "vdbview"), gcode, "--quiet"], stdout=subprocess.PIPE, text=True)
    frames = []
    with tempfile.TemporaryDirectory() as profile:
        page = browser(profile, 900, 560, 30)
        try:
            page.get(server.stdout.readline().strip())
            at_rest(page)
            most = int(page.execute_script("return document.getElementById('layer-high').max"))
            for n in range(1, FRAMES + 1):
                page.execute_script("const s = document.getElementById('layer-high'); s.value = arguments[0];"
                                    "for (const e of ['input', 'change']) s.dispatchEvent(new Event(e));",
                                    round(most * n / FRAMES))
                at_rest(page)
                frames.append(Image.open(io.BytesIO(page.get_screenshot_as_png())).convert("RGB"))
        finally:
            page.quit()
            server.terminate()
            server.wait()
    milliseconds = [round(1000 * SECONDS_A_FRAME)] * (FRAMES - 1) + [1500]
    frames[0].save(output, save_all=True, append_images=frames[1:], duration=milliseconds, loop=0, quality=75, method=6)
    print(f"{output}: {len(frames)} frames, {os.path.getsize(output) / 1000:.0f} kB")


main()

#!/usr/bin/env python3
"""Pictures of vdbview's page: screenshots by real headless Chromium.

    /usr/bin/python3 scripts/viewer_pictures.py build/release/bin [docs/pictures]
    /usr/bin/python3 scripts/viewer_pictures.py build/release/bin FOLDER PRINT...

The first makes those of docs/viewer.md, of data/gcode/hull.gcode: a bead under a click, a section with a distance, and a
short film of the layer slider, all at rest. The second shows each print in windows 1440, 1024 and 390 pixels wide, while
it turns and at rest, and a film of turning, of what the page draws itself. Needs chromium, chromium-driver,
python3-selenium and python3-pil.
"""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import time
from urllib.parse import quote

from PIL import Image

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(ROOT, "tests/clients"))
from chromium import browser
from selenium.webdriver import ActionChains

FRAMES = 28
SECONDS_A_FRAME = 0.12


def until(page, condition):
    end = time.monotonic() + 120
    while time.monotonic() < end:
        if page.execute_script(f"return {condition}"):
            time.sleep(0.5)  # until it is painted
            return
        time.sleep(0.05)
    sys.exit(f"not within 120 s: {condition}")


def at_rest(page):
    """Waits for the finished picture of the last view."""
    until(page, "(window.vdbviewLog ?? []).some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())")


@contextlib.contextmanager
def shown(folder, width, height, scheme="light", path=os.path.join(ROOT, "data/gcode/hull.gcode"), **view):
    """The page of a print in a window of that size."""
    server = subprocess.Popen([os.path.join(os.path.abspath(folder), "vdbview"), os.path.basename(path), "--quiet"],
                              stdout=subprocess.PIPE, text=True, cwd=os.path.dirname(os.path.abspath(path)))
    with tempfile.TemporaryDirectory() as profile:
        page = browser(profile, width, height, 30)
        try:
            # A window of Chromium is no narrower than 500.
            page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                 {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
            page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
            page.get(server.stdout.readline().strip() + "#" + quote(json.dumps(view)))
            at_rest(page)
            yield page
        finally:
            page.quit()
            server.terminate()
            server.wait()


def click(page, x, y):
    """At a place of the picture, 0 to 1."""
    page.execute_script("window.vdbviewFound = null")
    box = page.execute_script("const b = document.getElementById('picture').getBoundingClientRect(); return [b.x, b.y, b.width, b.height]")
    ActionChains(page).move_by_offset(round(box[0] + x * box[2]), round(box[1] + y * box[3])).click().perform()
    ActionChains(page).reset_actions()
    until(page, "window.vdbviewFound")


def write_film(path, frames, seconds_a_frame, last_seconds):
    milliseconds = [round(1000 * seconds_a_frame)] * (len(frames) - 1) + [round(1000 * last_seconds)]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=milliseconds, loop=0, quality=75, method=6)
    print(f"{path}: {len(frames)} frames, {os.path.getsize(path) / 1000:.0f} kB")


def screenshot(page):
    return Image.open(io.BytesIO(page.get_screenshot_as_png())).convert("RGB")


# Turns the view by a number of pixels with the pointer down.
TURN = """const c = document.getElementById('picture'), b = c.getBoundingClientRect(), [by, done] = arguments;
c.setPointerCapture = () => {};
const at = (type, x) => c.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: b.left + x, clientY: b.top + b.height / 2,
    button: 0, buttons: 1, bubbles: true }));
if (window.turned === undefined) at('pointerdown', window.turned = b.width / 2);
at('pointermove', window.turned += by);
requestAnimationFrame(() => requestAnimationFrame(done));"""


def prints(folder, output, paths):
    os.makedirs(output, exist_ok=True)
    for path in paths:
        name = os.path.basename(path).split(".")[0]
        for width, height in ((1440, 900), (1024, 768), (390, 844)):
            with shown(folder, width, height, path=path) as page:
                page.save_screenshot(os.path.join(output, f"{name}_{width}_still.png"))
                page.execute_async_script(TURN, 40)
                page.save_screenshot(os.path.join(output, f"{name}_{width}_moving.png"))
                if width != 1024:
                    continue
                frames = []
                for _ in range(FRAMES):
                    page.execute_async_script(TURN, 1.6 * width / FRAMES)
                    frames.append(screenshot(page))
                write_film(os.path.join(output, f"{name}_turning.webp"), frames, SECONDS_A_FRAME, SECONDS_A_FRAME)


def main():
    folder = sys.argv[1]
    output = sys.argv[2] if len(sys.argv) > 2 else os.path.join(ROOT, "docs/pictures")
    if len(sys.argv) > 3:
        prints(folder, output, sys.argv[3:])
        return
    with shown(folder, 1280, 800, "dark", layers=[0, 110], color_by="feature") as page:
        click(page, 0.5, 0.55)
        page.save_screenshot(os.path.join(output, "viewer_inspect.png"))
    camera = {"eye": [150, 185, 62], "look_at": [107, 100, 15], "fov": 28}
    with shown(folder, 1280, 800, clip=[0, 1, 0, 100], color_by="feature", camera=camera) as page:
        page.execute_script("for (const each of document.querySelectorAll('#side details')) each.open = Boolean(each.querySelector('#cut, #measure'));"
                            "document.getElementById('side').scrollTop = 10000")
        page.find_element("id", "measure").click()
        click(page, 0.3, 0.62)
        click(page, 0.7, 0.62)
        page.save_screenshot(os.path.join(output, "viewer_section.png"))
    frames = []
    with shown(folder, 900, 560) as page:
        most = int(page.execute_script("return document.getElementById('layer-high').max"))
        for n in range(1, FRAMES + 1):
            page.execute_script("const s = document.getElementById('layer-high'); s.value = arguments[0];"
                                "for (const e of ['input', 'change']) s.dispatchEvent(new Event(e));",
                                round(most * n / FRAMES))
            at_rest(page)
            frames.append(screenshot(page))
    write_film(os.path.join(output, "viewer_layers.webp"), frames, SECONDS_A_FRAME, 1.5)


main()

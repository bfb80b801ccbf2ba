"""What the viewer's page takes with a print of 400 000 beads, in headless Chromium's own processes."""

import base64
import json
import os
import subprocess
import tempfile
import time
from urllib.parse import quote

from run_tools import BIN, check, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from chromium import browser
from page_memory import memory_of
from png_file import png_pixels

BEADS = 400000
MOST, MOST_KEPT = 165, 130  # MB more than an empty page; 143 to 145 and 117 were measured, 150 and 143 with 64 bytes more a bead


def lines():
    """200 layers of 2000 short beads side by side, of a speed each."""
    yield "M83"
    for layer in range(BEADS // 2000):
        yield f";LAYER_CHANGE\n;TYPE:Internal infill\n;WIDTH:0.4\n;HEIGHT:0.2\nG0 X0 Y0 Z{0.2 * layer + 0.2:.1f} F{1200 + layer}"
        for n in range(1000):
            x, y = 2 * (n % 20), 0.4 * (n // 20)
            yield f"G0 X{x} Y{y:.1f}\nG1 X{x + 1} Y{y:.1f} E0.03\nG1 X{x + 1.9} Y{y + 0.1:.1f} E0.03"


# Keeps the browser's own picture of the moment in which it takes the place of the server's.
WATCH = """window.taken = null;
document.addEventListener('DOMContentLoaded', () => new MutationObserver(() => {
  if (!window.taken && document.getElementById('picture').classList.contains('behind'))
    window.taken = document.getElementById('beads').toDataURL();
}).observe(document.getElementById('picture'), { attributes: true }));"""


def first_own(page, url):
    """Pictures that the page draws itself: the first one that is seen, None where the server's finished one stays on top of
    it, and the same view with all beads."""
    page.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WATCH})
    page.get("about:blank")
    page.get(url)
    end = time.monotonic() + 120
    there = "return window.taken || (document.body.dataset.moving === 'own' && picture.dataset.final === String(vdbviewAsked()))"
    while not page.execute_script(there) and time.monotonic() < end:
        time.sleep(0.1)
    taken = page.execute_script("return window.taken")
    return taken, page.execute_async_script("window.vdbviewDrawn().then(arguments[0])")


def alike(one, other):
    """Whether they are of the same beads: where two are equally near, which one is seen depends on the parts they came in."""
    (*size, a), (*its_size, b) = (png_pixels(base64.b64decode(url.split(",")[1])) for url in (one, other))
    a, b = b"".join(a), b"".join(b)
    return size == its_size and sum(abs(x - y) > 2 for x, y in zip(a, b)) < 1e-3 * len(a)


with tempfile.TemporaryDirectory() as scratch:
    path = os.path.join(scratch, "beads.gcode")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines()))
    page = browser(os.path.join(scratch, "profile"), 800, 600, 120)
    try:
        with subprocess.Popen([os.path.join(BIN, "vdbview"), path, "--quiet", "--voxel-size", "0.4"], stdout=subprocess.PIPE,
                              text=True) as process:
            try:
                url = process.stdout.readline().strip()
                empty, finished, turned, kept = memory_of(page, url + "#" + quote(json.dumps({"spp": 1})), 3)
                beads = page.execute_script("return window.vdbviewLog.some((e) => e.kind === 'own')")
                taken, whole = first_own(page, url + "#" + quote(json.dumps({"spp": 64})))
            finally:
                process.terminate()
    finally:
        page.quit()
print(f"renderer and GPU's process: empty {empty}, finished {finished}, turned {turned}, without garbage {kept} MB")
check(beads, "the page draws the beads")
check(taken is None or alike(taken, whole), "the page's own picture is seen when all beads are in it, not layer by layer from below")
for name, moment, most in (("turned", turned, MOST), ("without garbage", kept, MOST_KEPT)):
    added = sum(moment) - sum(empty)
    check(20 < added < most, f"{name}: the page takes {added:.0f} MB more than an empty one; at most {most}")

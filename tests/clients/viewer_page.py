"""The page of a vdbview in a browser."""

import contextlib
import json
import os
import shutil
import subprocess
import tempfile
from math import radians, tan
from urllib.parse import quote

from chromium import browser, until
from run_tools import BIN

# Whether the picture that the page draws has a colour within a pixel of each of these places, 0 to 1.
COLORS = """
const [places, wanted, done] = arguments;
const image = new Image();
window.vdbviewDrawn().then((url) => {
  image.src = url;
  return image.decode();
}).then(() => {
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  done(places.map(([x, y]) => {
    const { data } = context.getImageData(Math.round(x * image.width) - 2, Math.round(y * image.height) - 2, 4, 4);
    for (let n = 0; n < data.length; n += 4)
      if (wanted.every((value, k) => Math.abs(data[n + k] - value) < 40)) return true;
    return false;
  }));
});"""


def screen(point, camera, aspect):
    """Where a camera sees a point."""
    eye, look = camera["eye"], camera["look_at"]
    unit = lambda v: [c / sum(d * d for d in v) ** 0.5 for c in v]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    dot = lambda a, b: sum(p * q for p, q in zip(a, b))
    forward = unit([b - a for a, b in zip(eye, look)])
    right = unit(cross(forward, [0, 0, 1]))
    up = cross(right, forward)
    way = [b - a for a, b in zip(eye, point)]
    scale = 2 * dot(way, forward) * tan(radians(camera["fov"]) / 2)
    return [0.5 + dot(way, right) / (scale * aspect), 0.5 - dot(way, up) / scale]


class ViewerPage:
    def __init__(self, name, width, height):
        self.folder = tempfile.mkdtemp(prefix=f"stratum_{name}_")
        self.page = browser(f"{self.folder}/profile", width, height, 400)

    def close(self):
        self.page.quit()
        shutil.rmtree(self.folder, ignore_errors=True)

    def js(self, text, *arguments):
        return self.page.execute_script(text, *arguments)

    def until(self, condition, text, seconds=150):
        return until(self.page, condition, text, seconds)

    @contextlib.contextmanager
    def of(self, path, *options, query=""):
        """A vdbview, whose page is open. `query`: what follows its URL."""
        with subprocess.Popen([os.path.join(BIN, "vdbview"), path, "--quiet", *options], stdout=subprocess.PIPE, text=True) as process:
            try:
                self.page.get(process.stdout.readline().strip() + query)
                yield process
            finally:
                try:
                    self.page.get("about:blank")
                finally:
                    process.terminate()

    def frames(self):
        """Waits for two."""
        self.js("return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def drawn_here(self):
        self.until("document.body.dataset.moving === 'own'", "the page draws what moves")

    @contextlib.contextmanager
    def drawn(self, path, view=None, *options):
        """The page of a print with large voxels and one sample a pixel, when it draws."""
        with self.of(path, "--voxel-size", "0.2", *options, query="#" + quote(json.dumps({"spp": 1, **(view or {})}))):
            self.drawn_here()
            yield

    def toggle(self, name, on=True):
        self.js("""const box = document.querySelector(`#also input[value="${arguments[0]}"]`);
                   if (box.checked !== arguments[1]) box.click();""", name, on)

    def set_slider(self, name, value):
        self.js("""const s = document.getElementById(arguments[0]); s.value = arguments[1];
                   for (const type of ["input", "change"]) s.dispatchEvent(new Event(type, { bubbles: true }));""", name, value)

"""What a page of vdbview takes in Chromium's own processes, memory and time, and how it is turned and waited for."""

import os
import re
import time

from chromium import until

ORBIT = """
const done = arguments[1], seconds = arguments[0], c = document.getElementById('picture'), b = c.getBoundingClientRect();
const at = (type, x, y, buttons) => c.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX: b.left + x,
    clientY: b.top + y, buttons, button: 0, bubbles: true }));
c.setPointerCapture = () => {};
window.vdbviewLog.length = 0;
at('pointerdown', 300, 300, 1);
const begin = performance.now();
const tick = () => {
  const t = (performance.now() - begin) / 1000;
  at('pointermove', 300 + 150 * t, 300 + 60 * Math.sin(2 * t), 1);
  if (t < seconds) return requestAnimationFrame(tick);
  const log = window.vdbviewLog.filter((e) => e.kind === 'moving' || e.kind === 'own');
  at('pointerup', 300, 300, 0);
  done(log);
};
requestAnimationFrame(tick);"""


def picture(page, kind):
    """Waits for a picture of that kind in the page's log, and returns its entry."""
    return until(page, f"(window.vdbviewLog ?? []).find((e) => e.kind === '{kind}')", f"a picture of the kind {kind}", 300)


def shares(page):
    """MB of Chromium's renderers and of its GPU's process, in which SwiftShader is, by process: what they have for
    themselves, and their share of what they have in common with others (PSS)."""
    parents, found = {}, {"renderer": {}, "gpu-process": {}}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="utf-8") as file:
                parents[int(name)] = int(file.read().rsplit(")", 1)[1].split()[1])
        except OSError:
            pass  # it has just ended
    inside = {page.service.process.pid}
    while more := {child for child, parent in parents.items() if parent in inside} - inside:
        inside |= more
    for process in inside:
        try:
            with open(f"/proc/{process}/cmdline", encoding="utf-8") as file:
                kind = re.search(r"--type=(renderer|gpu-process)", file.read())
            with open(f"/proc/{process}/smaps_rollup", encoding="utf-8") as file:
                size = int(re.search(r"Pss:\s+(\d+)", file.read()).group(1)) / 1024
        except OSError:
            continue
        if kind:
            found[kind.group(1)][process] = size
    return found


def processor_seconds(page):
    """Of the GPU's process until now."""
    sizes = shares(page)["gpu-process"]
    with open(f"/proc/{max(sizes, key=sizes.get)}/stat", encoding="utf-8") as file:
        user, system = file.read().rsplit(")", 1)[1].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def memory_of(page, url, seconds):
    """MB of the renderer and of the GPU's process: with an empty page; when the finished picture of a print is there; when it
    is coloured by speed and was turned for so long; and then without JavaScript's garbage."""
    page.get("about:blank")
    time.sleep(2)
    moments = [shares(page)]
    page.get(url)
    picture(page, "final")
    moments.append(shares(page))
    page.execute_script("const s = document.getElementById('color-by'); s.value = 'speed'; s.dispatchEvent(new Event('change'))")
    page.execute_async_script(ORBIT, seconds)
    picture(page, "final")
    moments.append(shares(page))
    page.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
    time.sleep(1)
    moments.append(shares(page))
    # Other renderers are of the browser itself.
    own = {kind: max(sizes, key=sizes.get) for kind, sizes in moments[-1].items()}
    return [[sizes[kind].get(own[kind], 0) for kind in own] for sizes in moments]

#!/usr/bin/env python3
"""Measures vdbview with a real headless Chromium, through the page's own clock.

    /usr/bin/python3 bench/view.py BIN FILE... [--seconds 5] [--turning ROUNDS | --memory | --soak SECONDS]

For each file: seconds from the start of the process until the page has shown the first picture; frames a second, latency
from input to frame and size while the view is turned; latency of the layer slider; seconds until the rough and the
finished picture; memory of the server beside that of vdbtrace; its processor time at rest. --turning compares, in turns,
frames that the page draws itself with those that the server streams. --memory states what the page takes in Chromium's own
processes beside an empty one. --soak turns, slides and
colours by eight clients without a browser, and prints memory and pictures by the minute. Chromium runs on the same
processors as the server.
"""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "tests/clients"))
from chromium import browser
from page_memory import ORBIT, memory_of, picture
from viewer_socket import resident, soak

SLIDE = """
const done = arguments[0], s = document.getElementById('layer-high'), most = Number(s.max);
window.vdbviewLog.length = 0;
let n = 0;
const tick = () => {
  s.value = Math.round(most * (1 - ++n / 60));
  s.dispatchEvent(new Event('input'));
  if (n < 40) return setTimeout(tick, 100);
  setTimeout(() => done(window.vdbviewLog.filter((e) => e.kind === 'moving')), 300);
};
tick();"""


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else float("nan")


def memory(process):
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as file:
        return int(re.search(r"VmHWM:\s+(\d+)", file.read()).group(1)) / 1024


def processor(process):
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def start(folder, path):
    process = subprocess.Popen([os.path.join(folder, "vdbview"), path, "--quiet"], stdout=subprocess.PIPE, text=True)
    return process, process.stdout.readline().strip()


def window(profile):
    """So that the picture has 1280 x 720 CSS pixels."""
    page = browser(profile, 1580, 900, 120)
    page.get("about:blank")
    inner = page.execute_script("return [innerWidth, innerHeight]")
    page.set_window_size(1580 + 1580 - inner[0], 900 + 763 - inner[1])
    return page


def measure(folder, path, seconds, page):
    begin = time.time()
    process, url = start(folder, path)
    page.get(url + "?stream")
    picture(page, "moving")
    shown = page.execute_script("return performance.timeOrigin + window.vdbviewLog[0].at") / 1000 - begin
    picture(page, "final")
    plain = memory(process)
    command = shlex.split(page.execute_script("return document.getElementById('command').textContent"))
    before = processor(process)
    time.sleep(5)
    idle = (processor(process) - before) / 5
    log = page.execute_async_script(ORBIT, seconds)
    rough, final = picture(page, "rough"), picture(page, "final")
    slid = page.execute_async_script(SLIDE)
    process.terminate()
    process.wait()
    with tempfile.TemporaryDirectory() as scratch:
        report = os.path.join(scratch, "s.json")
        subprocess.run([os.path.join(folder, "vdbtrace"), *command[1:-1], os.path.join(scratch, "p.png"), "--quiet",
                        "--stats", report], check=True)
        with open(report, encoding="utf-8") as file:
            alone = json.load(file)["peak_rss_bytes"] / 2**20
    latency, slides = [e["latency"] for e in log], [e["latency"] for e in slid]
    print(f"{os.path.basename(path)}: first picture {shown:.2f} s; turning {len(log) / seconds:.1f} frames/s, "
          f"{quantile([e['width'] for e in log], 0.5)} x {quantile([e['height'] for e in log], 0.5)}, input to frame "
          f"{quantile(latency, 0.5):.0f} ms, 95 % {quantile(latency, 0.95):.0f} ms; at rest rough {rough['latency'] / 1000:.1f} s, "
          f"finished {final['latency'] / 1000:.1f} s; layer slider {quantile(slides, 0.5):.0f} ms, 95 % "
          f"{quantile(slides, 0.95):.0f} ms; memory {plain:.0f} MB, vdbtrace {alone:.0f} MB; at rest {100 * idle:.1f} % of "
          "a processor", flush=True)


def turning(folder, path, seconds, page, rounds):
    """Frames a second and pixels a frame of the page's own drawing and of the stream, one after the other."""
    process, url = start(folder, path)
    found = {"": [], "?stream": []}
    for _ in range(rounds):
        for query, rates in found.items():
            page.get("about:blank")
            page.get(url + query)
            picture(page, "moving" if query else "own")
            picture(page, "final")
            log = page.execute_async_script(ORBIT, seconds)
            rates.append((len(log) / seconds, quantile([e["width"] * e["height"] for e in log], 0.5)))
    process.terminate()
    process.wait()
    (own, own_pixels), (stream, stream_pixels) = ([quantile(values, 0.5) for values in zip(*rates)] for rates in found.values())
    print(f"{os.path.basename(path)}, {rounds} rounds: drawn by the page {own:.1f} frames/s of {own_pixels} pixels "
          f"({', '.join(f'{rate:.1f}' for rate, _ in found[''])}); streamed {stream:.1f} of {stream_pixels} "
          f"({', '.join(f'{rate:.1f}' for rate, _ in found['?stream'])}); {own / stream:.2f} x the frames at "
          f"{own_pixels / stream_pixels:.1f} x the pixels", flush=True)


def memory_of_page(folder, path, seconds, page):
    process, url = start(folder, path)
    moments = memory_of(page, url, seconds)
    process.terminate()
    process.wait()
    words = ", ".join(f"{title}: renderer {renderer:.0f}, GPU {gpu:.0f} MB" for title, (renderer, gpu) in
                      zip(("an empty page", "the finished picture", "coloured by speed and turned", "without garbage"), moments))
    empty, _, last, _ = moments
    print(f"{os.path.basename(path)}: {words}; {sum(last) - sum(empty):.0f} MB more than an empty page", flush=True)


def tell(seconds, process, clients):
    print(f"  {seconds:.0f} s: {resident(process):.0f} MB, pictures of each client {[client.pictures for client in clients]}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--turning", type=int, default=0, metavar="ROUNDS")
    parser.add_argument("--memory", action="store_true")
    parser.add_argument("--soak", type=float, default=0)
    options = parser.parse_args()
    if options.soak > 0:
        process, url = start(options.bin, options.files[0])
        soak(process, url, options.soak, tell)
        print("  alive" if process.poll() is None else f"  ended with {process.returncode}")
        process.terminate()
        return process.wait()
    with tempfile.TemporaryDirectory() as profile:
        page = window(profile)
        try:
            for path in options.files:
                if options.memory:
                    memory_of_page(options.bin, path, options.seconds, page)
                elif options.turning > 0:
                    turning(options.bin, path, options.seconds, page, options.turning)
                else:
                    measure(options.bin, path, options.seconds, page)
        finally:
            page.quit()


main()

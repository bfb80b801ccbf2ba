"""The viewer in a real browser: headless Chromium opens, turns, slides, clicks, and meets changes and failures."""

import base64
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from run_tools import BIN, check, gcode, run, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from chromium import browser

FOLDER = tempfile.mkdtemp(prefix="stratum_view_")
PART = os.path.join(FOLDER, "part.gcode")
VDBVIEW = os.path.join(BIN, "vdbview")
VDBTRACE = os.path.join(BIN, "vdbtrace")


def start(*options):
    """A server and its URL."""
    process = subprocess.Popen([VDBVIEW, PART, "--voxel-size", "0.1", "--quiet", *options], stdout=subprocess.PIPE,
                               text=True)
    return process, process.stdout.readline().strip()


def until(condition, text, seconds=30):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.03)
    print(page.execute_script("return [window.vdbviewLog, document.body.innerText]"), page.get_log("browser"))
    sys.exit(f"FAILED: {text}: not within {seconds} s")


def js(text, *arguments):
    return page.execute_script(text, *arguments)


def final(text):
    """Waits for the finished picture of the last view that the page asked for; returns its bytes."""
    def there():
        return js("return window.vdbviewLog.some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())")
    until(there, text)
    return fetched("vdbviewFinal")


def fetched(name):
    return base64.b64decode(page.execute_async_script(
        "const done = arguments[1], reader = new FileReader();"
        "reader.onload = () => done(reader.result.split(',')[1]); reader.readAsDataURL(window[arguments[0]]);", name))


def command():
    return js("return document.getElementById('command').textContent")


def traced():
    """What vdbtrace makes of the command that the page shows."""
    words = shlex.split(command())
    check(words[0] == "vdbtrace" and words[-1] == "picture.png", f"a command line: {command()}")
    output = os.path.join(FOLDER, "traced.png")
    run(VDBTRACE, *words[1:-1], output, "--quiet")
    with open(output, "rb") as file:
        return file.read()


def drag(dx, dy):
    js("""const c = document.getElementById('picture'), b = c.getBoundingClientRect();
          const at = (type, x, y, buttons) => c.dispatchEvent(new PointerEvent(type,
              { pointerId: 1, clientX: b.left + x, clientY: b.top + y, buttons, button: 0, bubbles: true }));
          c.setPointerCapture = () => {};
          at('pointerdown', 100, 100, 1);
          for (let n = 1; n <= 10; ++n) at('pointermove', 100 + arguments[0] * n / 10, 100 + arguments[1] * n / 10, 1);
          at('pointerup', 100 + arguments[0], 100 + arguments[1], 0);""", dx, dy)


def status(url, headers=None):
    try:
        with urllib.request.urlopen(urllib.request.Request(url, headers=headers or {}), timeout=5) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def handshake(url, origin, token=None):
    """The status of a web socket's handshake."""
    host, port, own = re.fullmatch(r"http://([^:/]+):(\d+)/(\w+)/", url).groups()
    with socket.create_connection((host, int(port)), timeout=5) as connection:
        connection.sendall((f"GET /{token or own}/socket HTTP/1.1\r\nHost: {host}:{port}\r\nOrigin: {origin}\r\n"
                            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n").encode())
        return int(connection.recv(4096).split()[1])


def opening():
    page.get(url)
    picture = final("the first picture")
    check(picture[:8] == b"\x89PNG\r\n\x1a\n", "the finished picture is a PNG")
    check(picture == traced(), "it has the bytes of vdbtrace's")
    check("layers" in js("return document.getElementById('facts').textContent"), "the page says what the print is")
    return picture


def turning(before):
    js("window.vdbviewLog.length = 0")
    drag(120, 30)
    picture = final("the picture after turning")
    log = js("return window.vdbviewLog")
    check(any(e["kind"] in ("moving", "own") for e in log), f"moving pictures came first: {[e['kind'] for e in log]}")
    check(picture != before and "--eye=" in command(), "the camera has moved")
    check(picture == traced(), "the finished picture has the bytes of vdbtrace's")
    check("eye" in js("return decodeURIComponent(location.hash)"), "the view is in the URL")
    js("document.getElementById('picture').focus();"
       "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', { key: '5', bubbles: true }))")
    until(lambda: "--view top" in command(), "a named view by a key")


def sliding():
    js("const s = document.getElementById('layer-high'); s.value = 2; s.dispatchEvent(new Event('input'));"
       "s.dispatchEvent(new Event('change'));")
    until(lambda: "--layers 1:2" in command(), "the layers in the command")
    check("--eye=" in command(), "a named view, which is fitted to what is shown, stays where it was")
    check(final("the picture of some layers") == traced(), "the picture of two layers has the bytes of vdbtrace's")
    js("const s = document.getElementById('color-by'); s.value = 'feature'; s.dispatchEvent(new Event('change'));")
    until(lambda: js("return document.querySelectorAll('#legend li').length") > 1, "the legend")
    check(final("the coloured picture") == traced(), "coloured by feature, too")


def clicking():
    """On a bead whose line of G-code is known: the middle of the picture, from above, is on layer 2, which is solid."""
    js("const c = document.getElementById('picture'), b = c.getBoundingClientRect();"
       "window.vdbviewFound = null; c.setPointerCapture = () => {};"
       "for (const type of ['pointerdown', 'pointerup']) c.dispatchEvent(new PointerEvent(type, { pointerId: 1,"
       " clientX: b.left + b.width * 0.5, clientY: b.top + b.height * 0.5, button: 0, bubbles: true }));")
    found = until(lambda: js("return window.vdbviewFound"), "the answer to a click")
    check(found["hit"] and found["bead"]["layer"] == 2, f"a bead of the highest layer: {found.get('bead')}")
    bead = found["bead"]
    with open(PART, encoding="utf-8") as file:
        lines = file.read().split("\n")
    line = lines[bead["line"] - 1]
    number = dict(re.findall(r"([XYZE])(-?[\d.]+)", line))
    check(abs(float(number["X"]) - bead["to"][0]) < 1e-6 and abs(float(number["Y"]) - bead["to"][1]) < 1e-6,
          f"line {bead['line']} goes to the bead's end: {line}")
    shown = js("return document.querySelector('#answer li.this').textContent")
    check(line.strip() in shown and str(bead["line"]) in shown, f"it is marked on the page: {shown}")
    # The place lies on that bead, within its width.
    (x0, y0, _), (x1, y1, _) = bead["from"], bead["to"]
    px, py, pz = found["position"]
    length = (x1 - x0) ** 2 + (y1 - y0) ** 2
    t = max(0.0, min(1.0, ((px - x0) * (x1 - x0) + (py - y0) * (y1 - y0)) / length)) if length else 0.0
    off = ((px - x0 - t * (x1 - x0)) ** 2 + (py - y0 - t * (y1 - y0)) ** 2) ** 0.5
    check(off <= bead["width_mm"] / 2 + 0.1, f"{off:.3f} mm off its path, {bead['width_mm']:.3f} mm wide")
    check(bead["time_s"] > 0 and bead["speed_mm_s"] > 0, "its time and speed")


def saving():
    """What is saved is the view that was asked for, whatever is looked at meanwhile."""
    wanted = traced()
    js("window.vdbviewSaved = null; document.getElementById('save').click()")
    drag(60, 10)
    until(lambda: js("return Boolean(window.vdbviewSaved)"), "the saved picture")
    check(fetched("vdbviewSaved") == wanted, "the saved picture is that of the command that the page showed")
    check(final("the picture after turning") != wanted, "the page went on")
    # A view that is finished while another picture is being saved is shown.
    js("document.getElementById('save-size').value = document.getElementById('save-size').options[1].value")
    drag(-60, -10)
    js("document.getElementById('save').click()")
    final("the finished picture of the view beside the one that is saved")
    js("document.getElementById('save').click()")
    until(lambda: js("return document.getElementById('save').textContent") == "Save picture", "saving is given up")


def measuring():
    """Distances are in mm, whatever the file's unit."""
    metres = os.path.join(FOLDER, "metres.vdb")
    run(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "-o", metres, "--unit", "m", "--voxel-size", "0.2", "--quiet")
    process = subprocess.Popen([VDBVIEW, metres, "--quiet"], stdout=subprocess.PIPE, text=True)
    try:
        page.get(process.stdout.readline().strip() + '#{"camera":{"view":"top"}}')
        final("the picture of a level set")
        js("document.getElementById('measure').click()")
        places = []
        for x in (0.45, 0.55):
            js("window.vdbviewFound = null; const c = document.getElementById('picture'), b = c.getBoundingClientRect();"
               "c.setPointerCapture = () => {};"
               "for (const type of ['pointerdown', 'pointerup']) c.dispatchEvent(new PointerEvent(type, { pointerId: 1,"
               " clientX: b.left + b.width * arguments[0], clientY: b.top + b.height * 0.5, button: 0, bubbles: true }));", x)
            found = until(lambda: js("return window.vdbviewFound"), "the answer to a click")
            check(found["hit"], "a click meets the print")
            places.append(found["position"])
        told = until(lambda: re.search(r"Distance([\d.]+) mm", js("return document.querySelector('#answer dl').textContent")),
                     "the distance")
        wanted = 1000 * sum((a - b) ** 2 for a, b in zip(*places)) ** 0.5
        check(1 < wanted < 60 and abs(float(told.group(1)) - wanted) < 0.002, f"{told.group(1)} mm, {wanted:.3f} expected")
    finally:
        process.kill()


def changing():
    js("window.vdbviewLog.length = 0")
    with open(gcode("tile_arcs.gcode"), "rb") as file:
        changed = file.read()
    with open(PART + ".new", "wb") as file:
        file.write(changed)
    os.replace(PART + ".new", PART)
    until(lambda: js("return window.vdbviewLog.some((e) => e.kind === 'final')"), "the picture of the changed file")
    check("--layers 1:2" in command(), "the view was kept")
    check(fetched("vdbviewFinal") == traced(), "the picture is that of the changed file")
    with open(PART, "w", encoding="utf-8") as file:
        file.write("this is no G-code\n" * 10)
    until(lambda: js("const t = document.getElementById('trouble'); return t.hidden ? '' : t.textContent"),
          "a file that fails is told on the page")
    shutil.copy(gcode("tile.gcode"), PART)
    until(lambda: js("return document.getElementById('trouble').hidden"), "and is forgotten when it is whole again")


def strangers():
    root, token = re.fullmatch(r"(http://[^/]+/)(\w+)/", url).groups()
    check(len(token) == 32, "a token of 128 bits")
    check(status(url) == 200, "the page by its URL")
    check(status(root) == 403 and status(root + "0" * 32 + "/") == 403, "nothing without the token")
    check(status(url + "../../etc/passwd") in (403, 404) and status(url + "part.gcode") == 404, "no files")
    check(status(url, {"Host": "evil.example"}) == 403, "nothing under another host's name")
    origin = root.rstrip("/")
    check(handshake(url, origin) == 101, "a web socket from the page")
    check(handshake(url, "http://evil.example") == 403, "none from another site")
    check(handshake(url, origin, "0" * 32) == 403, "none without the token")
    rubbish = page.execute_async_script("""
        const done = arguments[0], answers = [], s = new WebSocket(location.href.replace(/^http/, 'ws').replace(/#.*/, '') + 'socket');
        s.onopen = () => { for (let n = 0; n < 100; ++n) s.send(n % 2 ? '{"type":"show","state":{"size":[1e9,' + n + ']}}' : 'x'.repeat(n)); };
        s.onmessage = (m) => { if (typeof m.data === 'string' && JSON.parse(m.data).type === 'refused') answers.push(m.data);
            if (answers.length === 100) { s.close(); done(answers.length); } };
        setTimeout(() => done(answers.length), 20000);""")
    check(rubbish == 100, f"100 senseless messages are refused one by one: {rubbish}")
    address = re.fullmatch(r"http://([^:]+):(\d+)/", root).groups()
    held = [socket.create_connection(address, timeout=5) for _ in range(200)]
    for _ in range(800):
        socket.create_connection(address, timeout=5).close()
    check(status(url) == 200 and server.poll() is None, "1000 connections, 200 of them held open, do no harm")
    for connection in held:
        connection.close()


def losing():
    """The server is killed and comes back at its port: the page says so, and goes on with the new one's URL."""
    global server
    port = re.search(r":(\d+)/", url).group(1)
    server.send_signal(signal.SIGKILL)
    server.wait()
    until(lambda: "does not answer" in js("return document.getElementById('trouble').textContent"), "the page says so")
    server, again = start("--port", port)
    check(f":{port}/" in again, "a new server at the same port")
    view = js("return location.hash")
    page.get(again + view)
    until(lambda: "--layers 1:2" in command(), "the view of the old page's fragment")
    server.send_signal(signal.SIGTERM)
    check(server.wait(10) == 0, "ctrl-C or a signal end it well")


shutil.copy(gcode("tile.gcode"), PART)
server, url = start()
page = browser(f"{FOLDER}/profile", 780, 340, 30)
try:
    first = opening()
    turning(first)
    sliding()
    clicking()
    saving()
    changing()
    strangers()
    losing()
    measuring()
finally:
    page.quit()
    if server.poll() is None:
        server.kill()
    shutil.rmtree(FOLDER, ignore_errors=True)

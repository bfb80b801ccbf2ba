"""Travels, marks, layers and single moves on the viewer's page, in headless Chromium, against the program itself."""

import json
import os
from urllib.parse import quote

from run_tools import check, gcode, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from program_counts import Program
from viewer_page import COLORS, ViewerPage, screen

# Counts messages of web sockets by type.
COUNT = """window.told = {}; window.asked = {};
const Plain = WebSocket;
window.WebSocket = class extends Plain {
  constructor(url) { super(url); this.addEventListener("message", ({ data }) => {
    const text = typeof data === "string" ? data : new TextDecoder().decode(new Uint8Array(data, 4, new DataView(data).getUint32(0, true)));
    const { type } = JSON.parse(text);
    window.told[type] = (window.told[type] ?? 0) + 1;
  }); }
  send(data) { const { type } = JSON.parse(data); window.asked[type] = (window.asked[type] ?? 0) + 1; super.send(data); }
};
window.WebSocket.OPEN = 1;"""


viewer = ViewerPage("moves", 760, 560)
page = viewer.page
page.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": COUNT})
js, until, drawn, toggle, set_slider = viewer.js, viewer.until, viewer.drawn, viewer.toggle, viewer.set_slider


def counted(name):
    """What the page says beside a toggle that is on."""
    until("window.vdbviewCounts()", "the moves have come")
    viewer.frames()
    text = js("return document.querySelector(`#also input[value='${arguments[0]}']`).parentElement.querySelector('output').textContent", name)
    return int(text)


def counts(name):
    """Numbers beside the toggles are those of the program, for all layers, some of them, and a part of the print."""
    program = Program(gcode(name))
    kinds = [kind for kind in ("travels", "retractions", "recoveries", "seams", "pauses", "filament changes")
             if program.count(kind)]
    with drawn(gcode(name)):
        check(js("return [window.asked.moves, window.told.moves, window.asked.layers, window.asked.program]") == [None] * 4,
              "what nobody asked for is not sent")
        for kind in kinds:
            toggle(kind)
        told = [counted(kind) for kind in kinds]
        check(told == [program.count(kind) for kind in kinds],
              f"{name}: the page has {told}, the program {', '.join(f'{program.count(kind)} {kind}' for kind in kinds)}")
        check(js("return [window.asked.moves, window.told.moves]") == [1, 1], "they come once")
        for layer in (1, program.layers // 2, program.layers - 1):
            set_slider("layer-high", layer)
            check([counted(kind) for kind in kinds] == [program.count(kind, high=layer) for kind in kinds], f"up to layer {layer}")
        set_slider("layer-low", program.layers // 2)
        set_slider("layer-high", program.layers // 2 + 1)
        low = program.layers // 2
        check([counted(kind) for kind in kinds] == [program.count(kind, low, low + 1) for kind in kinds], "of two layers")
        check(js("return window.asked.moves") == 1, "and nothing is asked again")


def single_moves():
    """The slider of the moves of a layer: how many there are, what is drawn, and the line of each."""
    program = Program(gcode("tile.gcode"))
    with drawn(gcode("tile.gcode")):
        toggle("travels")
        set_slider("layer-high", 3)
        js("document.getElementById('moves-group').open = true")
        beads = program.of_layer(3)
        until(f"document.getElementById('moves-value').textContent === 'move {len(beads)} of {len(beads)} in layer 3'",
              f"layer 3 has {len(beads)} moves")
        for move in (1, 7, len(beads) // 2, len(beads) - 1, len(beads)):
            set_slider("moves", move)
            line = program.beads[beads[move - 1]][0]
            until(f"document.querySelector('#program .this span')?.textContent === '{line}'", f"move {move} is line {line}")
            end = beads[move - 1] + 1 if move < len(beads) else 10**9
            check(counted("travels") == program.count("travels", high=3, beads=end), "travels up to there")
        # The server's finished picture is of the same beads.
        set_slider("moves", 7)
        until(f"document.getElementById('command').textContent.includes('--printed bead:{beads[6] + 1}')",
              "the command line has the number of beads")
        text = js("return document.querySelector('#program .this').textContent")
        with open(gcode("tile.gcode"), encoding="utf-8") as file:
            check(file.read().split("\n")[program.beads[beads[6]][0] - 1] in text, f"the line's text: {text}")
        js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', { key: '.' }))")
        line = program.beads[beads[7]][0]
        until(f"document.querySelector('#program .this span')?.textContent === '{line}'", "a key goes on by one")


def layers():
    """The layer's height and time, when the slider is used; the print's time and weight in the head."""
    program = Program(gcode("tile.gcode"))
    with drawn(gcode("tile.gcode")):
        set_slider("layer-high", 2)
        until("document.getElementById('layer-info').textContent", "the layer's facts")
        total = 0.0
        for layer in range(1, program.layers + 1):
            set_slider("layer-high", layer)
            info = until(f"""(() => {{ const text = document.getElementById('layer-info').textContent;
                          return text.startsWith('Layer {layer}:') && text; }})()""", f"facts of layer {layer}")
            check(f"z {program.tops[layer]:.2f} mm" in info, f"its height: {info}")
            hours, minutes, seconds = map(int, info.split("takes ")[1].split(",")[0].split(":"))
            took = 3600 * hours + 60 * minutes + seconds
            least = sum(program.beads[n][5] for n in program.of_layer(layer))
            check(took >= least - 1 and took < 2.5 * least + 5, f"its time, of which {least:.0f} s at the programmed speeds")
            total += took
        with open(gcode("tile.gcode"), encoding="utf-8") as file:
            stated = file.read().split("estimated printing time (normal mode) = ")[1].split("\n")[0]
        minutes, seconds = (int(part[:-1]) for part in stated.split())
        check(abs(total - 60 * minutes - seconds) < 0.2 * total, f"{total} s of all layers; the slicer says {stated}")
        facts = js("return document.getElementById('facts').textContent")
        check(f"0:{minutes:02}:{seconds:02}" in facts and " g " in facts, f"the head: {facts}")
    # Without a hand on the slider, too: by a link, and by keys.
    with drawn(gcode("tile.gcode")):
        height = js("return document.getElementById('layers-group').offsetHeight")
        js("location.hash = '#' + encodeURIComponent(JSON.stringify({ layers: [1, 5] }))")
        until("document.getElementById('layer-info').textContent.startsWith('Layer 5: z 1.00 mm, takes')", "the layer of a link")
        check(js("return document.getElementById('layers-group').offsetHeight") == height, "the panel does not jump")
        page.refresh()
        viewer.drawn_here()
        until("document.getElementById('layer-info').textContent.startsWith('Layer 5:')", "and when it is loaded again")
        js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', { key: '[' }))")
        until("document.getElementById('layer-info').textContent.startsWith('Layer 4:')", "a key goes to the next one")


def places():
    """Travels and seams are drawn where the program has them, in front of beads and not through them."""
    program = Program(gcode("tile.gcode"))
    camera = {"eye": [100, 60, 250], "look_at": [100, 100, 0], "fov": 10}
    with drawn(gcode("tile.gcode"), {"camera": camera, "layers": [1, 4], "bed": False, "spp": 1}):
        aspect = js("const c = document.getElementById('picture'); return c.clientWidth / c.clientHeight")
        middle = lambda m: [(a + b) / 2 for a, b in zip(m[1], m[2])]
        long = lambda m: sum((a - b) ** 2 for a, b in zip(m[1], m[2])) > 4
        of = lambda kind, layer: [m for m in program.moves if m[0] == kind and m[3] == layer]
        shown = [screen(middle(m), camera, aspect) for m in of("travels", 4) if long(m)]
        seams = [screen(m[1], camera, aspect) for m in of("seams", 4)]
        check(len(shown) >= 3 and len(seams) >= 1, f"{len(shown)} long travels and {len(seams)} seams in layer 4")
        colored = lambda where, color: page.execute_async_script(COLORS, where, color)
        blue, white = [0x4f, 0x86, 0xc6], [0xf2, 0xf2, 0xf2]
        check(not any(colored(shown, blue)), "travels are off at first")
        toggle("travels")
        counted("travels")
        check(all(colored(shown, blue)), "where travels are, their colour is")
        toggle("seams")
        counted("seams")
        check(all(colored(seams, white)), "and that of seams")
        until("window.vdbviewLog.some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())", "the finished picture")
        check(js("""const c = document.getElementById('marks'), [[x, y]] = arguments[0];
                    return c.getContext('2d').getImageData(Math.round(x * c.width), Math.round(y * c.height), 1, 1).data[3]""",
                 seams) > 200, "over the finished picture, too")
        set_slider("layer-high", 3)
        check(not any(colored([p for p, m in zip(seams, of("seams", 4)) if all(
            abs(m[1][0] - o[1][0]) + abs(m[1][1] - o[1][1]) > 1 for o in of("seams", 3))], white)), "not those of hidden layers")
        # From below, the first layer hides them.
        below = {"eye": [100, 60, -250], "look_at": [100, 100, 0], "fov": 10}
        js("location.hash = arguments[0]", quote(json.dumps({"camera": below, "bed": False, "spp": 1, "also": ["travels"]})))
        until("window.vdbviewLog.at(-1).kind === 'final' && window.vdbviewLog.at(-1).number === window.vdbviewAsked()", "from below")
        inner = [screen(middle(m), below, aspect) for m in of("travels", 4)
                 if all(91.5 < c < 108.5 for c in middle(m)[:2])]
        seen = sum(colored(inner, blue))
        check(len(inner) > 3 and seen <= len(inner) // 4, f"from below {seen} of {len(inner)} travels of layer 4 are seen")


def looks():
    """Colours by what the program sets, with legends as people write them."""
    program = Program(gcode("tile.gcode"))
    printed = [n for n, bead in enumerate(program.beads) if bead[1] > 0]
    ends = lambda values: [f"{round(edge([values[n] for n in printed]), 4):.4g}" for edge in (min, max)]
    with drawn(gcode("tile.gcode")):
        for name, title, wanted in (("temperature", "temperature, °C", ends(program.heat)), ("fan", "fan, %", ends(program.fan)),
                                    ("flow", "flow, mm³/s", None), ("layer_time", "layer time, h:min:s", None)):
            js("const s = document.getElementById('color-by'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", name)
            until(f"document.querySelector('#legend h2')?.textContent === '{title}'", f"the legend says {title}")
            least, most = js("return [...document.querySelectorAll('#legend .ends input')].map((e) => e.value)")
            check(not wanted or [least, most] == wanted, f"from {least} to {most}")
            check(name != "layer_time" or (least.count(":") == 2 and most.count(":") == 2), "times as a clock has them")
        offered = "[...document.getElementById('color-by').options].map((o) => o.value)"
        check(not {"acceleration", "pressure_advance"} & set(js(f"return {offered}")), "what the program never sets is not offered")
    tuned = os.path.join(viewer.folder, "tuned.gcode")
    with open(gcode("tile.gcode"), encoding="utf-8") as file:
        text = file.read()
    for kind, value in (("External perimeter", 800), ("Internal infill", 2500), ("Solid infill", 1200)):
        text = text.replace(f";TYPE:{kind}\n", f";TYPE:{kind}\nM204 P{value} T5000\nM900 K{value / 1e5}\n")
    with open(tuned, "w", encoding="utf-8") as out:
        out.write(text + "; total filament cost = 1.25\n")
    # What is printed before the first M204 has its value.
    wanted = ends([each or 800 for each in Program(tuned).acceleration])
    with drawn(tuned):
        for name, title, these in (("acceleration", "acceleration, mm/s²", wanted),
                                   ("pressure_advance", "pressure advance, s", [f"{float(each) / 1e5:g}" for each in wanted])):
            js("const s = document.getElementById('color-by'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", name)
            until(f"document.querySelector('#legend h2')?.textContent === '{title}'", f"the legend says {title}")
            least, most = js("return [...document.querySelectorAll('#legend .ends input')].map((e) => e.value)")
            check([least, most] == these, f"{name} from {least} to {most}, not {these}")
        check("costs 1.25" in js("return document.getElementById('facts').textContent"), "the bar has the cost")
    with drawn(gcode("vase.gcode")):
        check(js("return [...document.getElementById('color-by').options].some((o) => o.value === 'layer_time')"), "layer times are offered")


def bed():
    """The file's bed: its outline, where the file says it is."""
    camera = {"eye": [90, -250, 300], "look_at": [100, 100, 0], "fov": 40}
    with open(gcode("tile.gcode"), encoding="utf-8") as file:
        text = file.read().split("; bed_shape = ")[1].split("\n")[0]
    corners = [[float(c) for c in corner.split("x")] + [0.0] for corner in text.split(",")]
    with drawn(gcode("tile.gcode"), {"camera": camera, "bed": False}):
        aspect = js("const c = document.getElementById('picture'); return c.clientWidth / c.clientHeight")
        at = [screen([a + (b - a) * t for a, b in zip(corners[n], corners[(n + 1) % len(corners)])], camera, aspect)
              for n in range(len(corners)) for t in (0.13, 0.37, 0.61, 0.89)]
        at = [p for p in at if 0.01 < min(p) and max(p) < 0.99]
        check(len(at) > 8, f"{len(at)} places on the outline {text}")
        check(not any(page.execute_async_script(COLORS, at, [26, 115, 204])), "it is off at first")
        toggle("bed and grid of 10 mm")
        check(all(page.execute_async_script(COLORS, at, [26, 115, 204])), "and drawn on the outline when it is on")
        check(js("return window.asked.moves") is None, "which asks for no moves")
    with drawn(gcode("tile_cura.gcode")):
        check(js("return document.querySelector('#also').lastChild.hidden"), "a file without a bed offers none")


def phone():
    """At a width of 390 all that is touched is 44 pixels high, and nothing lies beside the page."""
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True})
    with drawn(gcode("tile.gcode"), {"color_by": "feature"}):
        until("document.querySelectorAll('#legend li').length", "the legend")
        check(not js("return document.getElementById('legend').open"), "which is closed at first")
        js("""const c = document.getElementById('picture'), b = c.getBoundingClientRect();
              c.setPointerCapture = () => {};
              for (const type of ['pointerdown', 'pointerup']) c.dispatchEvent(new PointerEvent(type, { pointerId: 1,
                clientX: b.left + b.width * 0.5, clientY: b.top + b.height * 0.55, button: 0, bubbles: true }));""")
        until("document.querySelector('#answer ol')", "a click")
        lower, upper = js("""const box = (e) => document.querySelector(e).getBoundingClientRect();
                             return [box('#answer').bottom, box('.status').top]""")
        check(lower <= upper, f"the status line is below the answer: {lower}, {upper}")
        js("document.querySelector('#answer button').click()")
        js("document.getElementById('panels').click(); for (const d of document.querySelectorAll('details')) d.open = true;")
        small = js("""const targets = [...document.querySelectorAll('button, select, summary, input:not([type=checkbox]), label:has(input[type=checkbox]), [role=checkbox]')];
            return targets.filter((e) => e.checkVisibility()).map((e) => [e, e.getBoundingClientRect()])
              .filter(([, b]) => b.height < 44 || b.width < 44).map(([e, b]) => `${e.tagName} ${e.id} ${e.textContent.slice(0, 20)} ${b.width}x${b.height}`)""")
        check(small == [], f"targets are large enough: {small}")
        check(js("return document.documentElement.scrollWidth") <= 390, "the page is no wider than the phone")
        check(js("return document.getElementById('facts').checkVisibility()"), "time and weight are there")
        js("document.getElementById('help').click()")
        keys = js("return document.getElementById('keys').open && [...document.querySelectorAll('#keys dt')].map((e) => e.textContent).join(' ')")
        check(all(key in keys.split() for key in ("F", "[", "]", "L", ",", ".", "P", "T,", "S", "M,", "Esc", "?")), f"the keys: {keys}")
    page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def refusals():
    """What an address says wrongly is told, and messages that nobody understands."""
    with drawn(gcode("tile.gcode"), {"layers": "all", "also": [3], "beads": -1, "file": "x", "color_by": "feature"}):
        text = until("!document.getElementById('trouble').hidden && document.getElementById('trouble-text').textContent", "a word of it")
        check(all(key in text for key in ("layers", "also", "beads", "file")) and "color_by" not in text, f"the keys: {text}")
        check("--color-by feature" in until("document.getElementById('command').textContent", "the rest holds"), "color_by holds")


try:
    counts("tile.gcode")
    counts("hull.gcode")
    single_moves()
    layers()
    places()
    looks()
    bed()
    phone()
    refusals()
finally:
    viewer.close()

"""The viewer's search, head, scale and bed, in headless Chromium, against the program itself."""

import os
import shutil

from run_tools import check, gcode, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from program_counts import Program
from viewer_page import COLORS, ViewerPage, screen

viewer = ViewerPage("panel", 900, 640)
page, FOLDER = viewer.page, viewer.folder
js, until, drawn, frames, set_slider = viewer.js, viewer.until, viewer.drawn, viewer.frames, viewer.set_slider


def find(what, text, back=False):
    js("""const set = (id, value) => { const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event('change')); };
          set('find-what', arguments[0]); set('find-for', arguments[1]);
          document.getElementById(arguments[2] ? 'find-back' : 'find').dispatchEvent(new Event(arguments[2] ? 'click' : 'submit', { cancelable: true }));""",
       what, str(text), back)


def told(text):
    until(f"document.getElementById('find-result').textContent.startsWith({text!r})", f"it says {text}")


def search():
    """A text, a line, a time and a layer: the sliders and the lines go there."""
    program = Program(gcode("tile.gcode"))
    with open(gcode("tile.gcode"), encoding="utf-8") as file:
        text = file.read().split("\n")
    fans = [n for n, line in enumerate(text, 1) if "m106" in line.lower()]
    check(len(fans) >= 2, f"M106 in lines {fans}")
    here = lambda: int(js("return document.querySelector('#program .this span')?.textContent ?? 0"))
    last = lambda line: max((n for n, bead in enumerate(program.beads) if bead[0] <= line), default=0)

    def at(line):
        until(f"document.querySelector('#program .this span')?.textContent === '{line}'", f"line {line} is shown")
        frames()
        bead = last(line)
        layer = program.beads[bead][1]
        check(int(js("return document.getElementById('layer-high').value")) == layer, f"layer {layer} is the last one")
        moves = [n for n in program.of_layer(layer) if n <= bead]
        check(int(js("return document.getElementById('moves').value")) == len(moves), f"and move {len(moves)} of it")

    with drawn(gcode("tile.gcode")):
        for n, line in enumerate(fans[:5]):
            find("text", "m106")
            told(f"{n + 1} of {len(fans)}: line {line}")
            at(line)
        find("text", "m106", back=True)
        told(f"4 of {len(fans)}: line {fans[3]}")
        find("line", fans[-1])
        told(f"line {fans[-1]}")
        find("text", "m106")
        told(f"1 of {len(fans)}: line {fans[0]}")
        find("text", "m106", back=True)
        told(f"{len(fans)} of {len(fans)}: line {fans[-1]}")
        line = program.beads[len(program.beads) // 3][0]
        find("line", line)
        told(f"line {line}, layer {program.beads[last(line)][1]}")
        at(line)
        check(text[line - 1] in js("return document.querySelector('#program .this').textContent"), "its text")
        find("layer", 2)
        until("document.getElementById('layer-high').value === '2'", "layer 2")
        find("time", "0:01:00")
        until("document.getElementById('find-result').textContent.startsWith('line') && !document.getElementById('find-result').textContent.startsWith('line " + str(line) + ",')", "what is printed after a minute")
        first = here()
        find("time", "2:00")
        until(f"Number(document.querySelector('#program .this span').textContent) > {first}", "and what after two")
        seconds = sum(bead[5] for bead in program.beads[:last(here())])
        check(30 < seconds <= 121, f"{seconds:.0f} s of it at the programmed speeds")
        for what, wrong, says in (("text", "no such words", "The program has no such text"), ("line", "12a", "That is no line"),
                                  ("time", "1:99", "That is no time")):
            find(what, wrong)
            told(says)
        find("line", 10**8)
        until("document.getElementById('find-result').textContent.includes('has no line')", "a line that is not there")
        check(js("return document.getElementById('trouble').hidden"), "which is no alarm")
        find("time", "9:00:00")
        told(f"The print is over by then: line {program.beads[-1][0]},")
        js("document.getElementById('picture').dispatchEvent(new KeyboardEvent('keydown', { key: '/' }))")
        check(js("return document.activeElement.id") == "find-for", "a key goes to the search")


def head():
    """The nozzle stands where the last bead that is printed ends."""
    program = Program(gcode("tile.gcode"))
    camera = {"eye": [100, 60, 250], "look_at": [100, 100, 0], "fov": 10}
    mark = """const c = document.getElementById('marks'), [x, y] = arguments[0], ratio = devicePixelRatio;
              return [...c.getContext('2d').getImageData(Math.round(x * c.width), Math.round(y * c.height - 14 * ratio), 1, 1).data]"""
    with drawn(gcode("tile.gcode"), {"camera": camera, "bed": False}):
        aspect = js("const c = document.getElementById('picture'); return c.clientWidth / c.clientHeight")
        set_slider("layer-high", 3)
        beads = program.of_layer(3)
        for move in (5, len(beads) // 2):
            set_slider("moves", move)
            frames()
            place = screen(program.beads[beads[move - 1]][4], camera, aspect)
            check(js(mark, place)[:3] == [0xe8, 0xa1, 0x3a], f"at the end of move {move}, {place}")
        set_slider("moves", len(beads))
        frames()
        check(js(mark, place)[3] == 0, "not when all of it is printed")
        set_slider("layer-high", program.layers)
        set_slider("printed", 50)
        frames()
        found = js("const c = document.getElementById('marks'); return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v) => v)")
        check(found, "and with the share that is printed")


def scale():
    """The ends of a scale are those that are typed, and its histogram is that of the program."""
    program = Program(gcode("tile.gcode"))
    printed = [n for n, bead in enumerate(program.beads) if bead[1] > 0]
    length = lambda n: sum((a - b) ** 2 for a, b in zip(program.beads[n][3], program.beads[n][4])) ** 0.5
    layer = lambda n: program.beads[n][1]
    ends = lambda: [float(v) for v in js("return [...document.querySelectorAll('#legend .ends input')].map((e) => e.value)")]
    bars = lambda: [float(h[:-1]) for h in js("return [...document.querySelectorAll('#legend .bars i')].map((e) => e.style.height)")]

    def compare(low, high, weight, beads=printed):
        sums = [0.0] * 32
        for n in beads:
            sums[max(0, min(31, int((layer(n) - low) / (high - low) * 32)))] += weight(n)
        wanted = [100 * s / max(sums) for s in sums]
        off = sum(abs(a - b) for a, b in zip(bars(), wanted)) / sum(wanted)
        check(len(bars()) == 32 and off < 0.03, f"bars from {low} to {high}: {100 * off:.1f} % are elsewhere")

    with drawn(gcode("tile.gcode"), {"color_by": "layer"}):
        until("document.querySelectorAll('#legend .bars i').length === 32", "the histogram")
        low, high = ends()
        check([low, high] == [1, program.layers], f"from {low} to {high}")
        compare(low, high, length)
        js("const s = document.querySelector('#legend .by'); s.value = '1'; s.dispatchEvent(new Event('change'))")
        compare(low, high, lambda n: program.beads[n][5])
        js("const i = document.querySelector('#legend .ends input'); i.value = '4'; i.dispatchEvent(new Event('change'))")
        until("document.getElementById('command').textContent.includes('--color-range=4,')", "the command line has the ends")
        until("document.querySelector('#legend .ends input').value === '4'", "and the legend")
        until("document.querySelector('#legend .ends button').checkVisibility()", "and all of it is a press away")
        compare(4, high, lambda n: program.beads[n][5])
        set_slider("layer-high", 6)
        until("document.getElementById('command').textContent.includes('--layers')", "six layers")
        until("window.vdbviewLog.at(-1).kind === 'final' && window.vdbviewLog.at(-1).number === window.vdbviewAsked()", "their picture")
        compare(4, high, lambda n: program.beads[n][5], [n for n in printed if layer(n) <= 6])
        js("document.querySelector('#legend .ends button').click()")
        until("!document.getElementById('command').textContent.includes('--color-range')", "from the least to the most again")
        js("const s = document.getElementById('color-by'); s.value = 'layer_time'; s.dispatchEvent(new Event('change'))")
        until("document.querySelector('#legend h2').textContent.startsWith('layer time')", "times")
        js("const i = document.querySelectorAll('#legend .ends input')[1]; i.value = '0:10:00'; i.dispatchEvent(new Event('change'))")
        until("/--color-range=[0-9.]+,600/.test(document.getElementById('command').textContent)", "are typed as a clock has them")
        js("const i = document.querySelector('#legend .ends input'); i.value = 'x'; i.dispatchEvent(new Event('change'))")
        check(js("return document.querySelector('#legend .ends input').value") != "x", "nonsense is not taken")
        check(js("return document.querySelector('#legend .ends + output').textContent") == "“x” is no time: write it as 0:10:00.", "and told")
        js("const s = document.getElementById('color-by'); s.value = 'width'; s.dispatchEvent(new Event('change'))")
        until("document.querySelector('#legend h2').textContent.startsWith('width') && !document.getElementById('command').textContent.includes('color-range')", "widths")
        for value, says in (("1e99", "“1e99” is no number up to 1e9."), ("9", "The lower end comes first.")):
            js("const i = document.querySelector('#legend .ends input'); i.value = arguments[0]; i.dispatchEvent(new Event('change'))", value)
            check(js("return document.querySelector('#legend .ends + output').textContent") == says, f"{value}: {says}")
        check("color-range" not in js("return document.getElementById('command').textContent"), "neither is asked for")
        js("const i = document.querySelector('#legend .ends input'); i.value = '0,125'; i.dispatchEvent(new Event('change'))")
        until("document.getElementById('command').textContent.includes('--color-range=0.125,')", "a decimal comma is taken")
        check(js("return document.getElementById('trouble').hidden"), "without an alarm")


def words():
    """The legend has the words and the order of the panel; a feature that is hidden stays in its place."""
    names = lambda: js("return [...document.querySelectorAll('#legend li')].map((e) => e.textContent.replace(/[0-9.]+ %$/, ''))")
    with drawn(gcode("two_tone.gcode"), {"color_by": "feature"}):
        until("document.querySelectorAll('#legend li').length", "the legend")
        panel = js("return [...document.querySelectorAll('#features label')].map((e) => e.textContent)")
        before = names()
        check(len(before) > 4 and before == [name for name in panel if name in before], f"{before} as {panel}")
        for shown in (False, True):
            asked = js("document.querySelectorAll('#legend input')[1].click(); return window.vdbviewAsked()")
            until(f"window.vdbviewLog.some((e) => e.kind === 'final' && e.number > {asked})", "the second one is clicked")
            check(names() == before, f"the order is kept: {names()}")
            check(js("return document.querySelectorAll('#legend input')[1].checked") == shown, f"it is shown: {shown}")
        js("document.getElementById('legend-title').click()")
        check(not js("return document.querySelector('#legend ul').checkVisibility()"), "it can be closed")
        js("const s = document.getElementById('color-by'); s.value = 'tool'; s.dispatchEvent(new Event('change'))")
        until("document.querySelector('#legend h2').textContent === 'tool'", "tools")
        check(names() == ["T0", "T1"] == js("return [...document.querySelectorAll('#tools label')].map((e) => e.textContent)"), f"{names()}")
        js("const s = document.getElementById('color-by'); s.value = 'object'; s.dispatchEvent(new Event('change'))")
        until("document.querySelector('#legend h2').textContent === 'object'", "objects")
        check(names() == ["no object"], f"{names()}")


def excluded():
    """Areas of the bed that stay free are drawn where the file says they are."""
    camera = {"eye": [90, -250, 300], "look_at": [100, 100, 0], "fov": 40}
    path = os.path.join(FOLDER, "excluded.gcode")
    with open(gcode("tile.gcode"), encoding="utf-8") as file, open(path, "w", encoding="utf-8") as out:
        out.write(file.read() + "; bed_exclude_area = 20x20,58x20,58x48,20x48\n")
    with drawn(path, {"camera": camera, "bed": False}):
        aspect = js("const c = document.getElementById('picture'); return c.clientWidth / c.clientHeight")
        corners = [[20, 20, 0], [58, 20, 0], [58, 48, 0], [20, 48, 0]]
        at = [screen([a + (b - a) * t for a, b in zip(corners[n], corners[(n + 1) % 4])], camera, aspect) for n in range(4) for t in (0.3, 0.7)]
        red = [204, 38, 26]
        check(not any(page.execute_async_script(COLORS, at, red)), "off at first")
        viewer.toggle("bed and grid of 10 mm")
        check(all(page.execute_async_script(COLORS, at, red)), "and drawn with the bed")


def two_prints():
    """Another input beside the first, under the same camera; what of the beads differs is marked and counted."""
    path = os.path.join(FOLDER, "other.gcode")
    with open(gcode("tile.gcode"), encoding="utf-8") as file:
        lines = file.read().split("\n")
    program = Program(gcode("tile.gcode"))
    # A hop with plastic on top, and one bead less.
    last = program.beads[-1][0]
    gone = next(n for n in range(len(program.beads) // 2, len(program.beads)) if program.beads[n][2] == "External perimeter")
    index = program.beads[gone][0] - 1
    words = [word for word in lines[index].split(";")[0].split() if word[0] != "E"]
    lines[index] = " ".join(words)
    x, y, _ = program.beads[-1][4]
    lines[last:last] = [f"G1 X{x + 4:.3f} Y{y + 4:.3f} F600", f"G1 X{x + 9:.3f} Y{y + 4:.3f} E.2"]
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    length = lambda bead: sum((a - b) ** 2 for a, b in zip(bead[3], bead[4])) ** 0.5 / 1000
    with drawn(gcode("tile.gcode"), None, path):
        until("document.getElementById('second').options.length === 2", "the other input is offered")
        width = js("return document.getElementById('picture').clientWidth")
        js("const s = document.getElementById('second'); s.selectedIndex = 1; s.dispatchEvent(new Event('change'))")
        js("const d = document.getElementById('differs'); d.checked = true; d.dispatchEvent(new Event('change'))")
        text = until("(() => { const text = document.getElementById('second-info').textContent; return text.startsWith('Red') && text; })()", "what differs")
        check(text == f"Red, gone: 1 bead, {length(program.beads[gone]):.2f} m. Green, new: 1 bead, 0.01 m.", f"it says {text}")
        check(abs(js("return document.getElementById('picture').clientWidth") - width / 2) <= 1, "side by side")
        colors = """const image = new Image(), done = arguments[0];
            window.vdbviewDrawn(true).then((url) => {
              image.src = url;
              return image.decode();
            }).then(() => {
              const copy = new OffscreenCanvas(image.width, image.height).getContext("2d");
              copy.drawImage(image, 0, 0);
              const { data } = copy.getImageData(0, 0, image.width, image.height);
              let [red, green, drawn] = [0, 0, 0];
              for (let n = 0; n < data.length; n += 4) {
                red += data[n] > 2 * data[n + 1] + 20;
                green += data[n + 1] > 1.5 * data[n] + 20;
                drawn += data[n] > 0;
              }
              done([red, green, drawn]);
            });"""
        red, green, drawn_pixels = page.execute_async_script(colors)
        check(drawn_pixels > 1000 and green > 10 and red == 0, f"green in the second: {red}, {green} of {drawn_pixels}")
        set_slider("layer-high", 1)
        until("document.getElementById('second-info').textContent.startsWith('Red, gone: 0 beads')", "nothing of layer 1 differs")
        js("const s = document.getElementById('second'); s.selectedIndex = 0; s.dispatchEvent(new Event('change'))")
        until(f"document.getElementById('picture').clientWidth === {width}", "one print again")
        check(js("return document.getElementById('second-info').textContent") == "", "without numbers")


def unreadable():
    """Beside the first print, a file that can't be read is nothing but its error, until it is whole."""
    path = os.path.join(FOLDER, "bad.gcode")
    shutil.copy(gcode("tile.gcode"), path)
    empty = "!document.getElementById('second-beads').checkVisibility()"
    wrong = "document.getElementById('second-info').textContent.includes('no G-code command')"
    with drawn(gcode("tile.gcode"), None, path, gcode("two_tone.gcode")):
        js("const s = document.getElementById('second'); s.value = '2'; s.dispatchEvent(new Event('change'))")
        until(f"!({empty}) && document.getElementById('second-info').textContent === ''", "a second print")
        with open(path, "w", encoding="utf-8") as file:
            file.write("this is no G-code\n" * 10)
        js("const s = document.getElementById('second'); s.value = '1'; s.dispatchEvent(new Event('change'))")
        until(f"{wrong} && {empty}", "another one that can't be read")
        set_slider("layer-high", 5)
        until("window.vdbviewLog.some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())", "the first one goes on")
        check(js(f"return {wrong} && {empty}"), f"the second says why it is empty: {js('return document.getElementById(`second-info`).textContent')}")
        shutil.copy(gcode("tile.gcode"), path)
        until(f"!({empty}) && document.getElementById('second-info').textContent === ''", "it is whole again")
        with open(path, "w", encoding="utf-8") as file:
            file.write("this is no G-code\n" * 10)
        until(f"{wrong} && {empty}", "and broken again")


def facts():
    """Heights with the digits that they have; what is cut can be read; boxes are of one size, also where a label wraps."""
    path = os.path.join(FOLDER, "a_long_name_of_a_file_that_is_longer_than_the_list_is_wide.gcode")
    with open(gcode("tile.gcode"), encoding="utf-8") as file, open(path, "w", encoding="utf-8") as out:
        out.write(file.read().replace("G1 Z4.8", "G1 Z4.85"))
    with drawn(path):
        text = js("return document.getElementById('facts').textContent")
        check("4.85 mm high" in text, f"the height: {text}")
        check(js("return document.getElementById('facts').title") == text, "all of it in the title")
        check(js("return document.getElementById('file').title") == os.path.basename(path), "the file's name, too")
        sizes = js("return [...new Set([...document.querySelectorAll('#features input')].map((e) => `${e.offsetWidth} ${e.offsetHeight}`))]")
        check(len(sizes) == 1, f"all boxes are of one size: {sizes}")
        check(js("const f = document.getElementById('facts'); return f.scrollWidth <= f.clientWidth"), "nothing is cut at this width")


def section():
    """The controls show the section of a link."""
    with viewer.drawn(gcode("tile.gcode"), {"clip": [0, -1, 0, -95]}):
        until("document.getElementById('cut-axis').value === '1'", "it is across y")
        found = js("return ['cut', 'cut-flip'].map((id) => document.getElementById(id).checked)")
        check(found == [True, True], f"on, and the other half: {found}")
        viewer.set_slider("cut-at", 500)
        clip = js("return JSON.parse(decodeURIComponent(location.hash.slice(1))).clip") if until("!location.hash.includes('-95')", "it moves") else None
        check(clip[:3] == [0, -1, 0] and clip[3] < 0, f"the slider moves this plane: {clip}")


try:
    section()
    search()
    head()
    scale()
    words()
    facts()
    excluded()
    two_prints()
    unreadable()
finally:
    viewer.close()

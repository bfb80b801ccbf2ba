"""The viewer by its keys and from one state to the next, in headless Chromium: what a hand does, with real key presses."""

import os
import re
import shutil
import subprocess
import time

from run_tools import BIN, check, gcode, run, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from program_counts import Program
from viewer_page import ViewerPage

viewer = ViewerPage("keys", 900, 640)
page, FOLDER = viewer.page, viewer.folder
js, until, drawn, set_slider = viewer.js, viewer.until, viewer.drawn, viewer.set_slider
LAYERS = Program(gcode("tile.gcode")).layers


def press(keys, place="picture"):
    page.find_element(By.ID, place).send_keys(keys)


def layers():
    return [int(js("return document.getElementById(arguments[0]).value", name)) for name in ("layer-low", "layer-high")]


def one_layer(on):
    js("const box = document.getElementById('one-layer'); if (box.checked !== arguments[0]) box.click()", on)


def at_layers(low, high, text):
    check(layers() == [low, high], f"{text}: layers {layers()}")


def settled():
    """The state is in the address, as a view at rest has it."""
    viewer.frames()
    return js("return JSON.parse(decodeURIComponent(location.hash.slice(1)) || '{}')")


def keys_of_layers():
    """[ and ] end at the first and the last layer, and go on with one layer alone."""
    with drawn(gcode("tile.gcode"), {"layers": [1, 3]}):
        press("[")
        press("[")
        at_layers(1, 1, "down to the first")
        press("[")
        at_layers(1, 1, "and no farther")
        for value in ("0", "-3"):
            js("const to = document.getElementById('layer-to'); to.value = arguments[0]; to.dispatchEvent(new Event('change'))", value)
            at_layers(1, 1, f"to {value} is to the first")
        js("const to = document.getElementById('layer-to'); to.value = ''; to.dispatchEvent(new Event('change'))")
        at_layers(1, LAYERS, "to nothing is to the last")
        press("]")
        at_layers(1, LAYERS, "which is the last")
        press("l")
        at_layers(LAYERS, LAYERS, "L: one alone")
        press("[[")
        at_layers(LAYERS - 2, LAYERS - 2, "two down")
        press("]")
        at_layers(LAYERS - 1, LAYERS - 1, "one up, alone")
        press("l")
        at_layers(1, LAYERS - 1, "with those below it")


def one_layer_alone():
    """Is a part of the view: it is there after loading the page again, and ends where a range is typed."""
    alone = "return document.getElementById('one-layer').checked"
    with drawn(gcode("tile.gcode"), {"layers": [1, 5]}):
        press("l")
        check(settled().get("layers") == [5, 5], f"one alone: {settled()}")
        page.refresh()
        viewer.drawn_here()
        check(js(alone), "it is alone still")
        press("]")
        at_layers(6, 6, "and the keys go on so")
        js("const from = document.getElementById('layer-from'); from.value = '2'; from.dispatchEvent(new Event('change'))")
        at_layers(2, 6, "a range is typed")
        check(not js(alone), "which is not one alone")


def search_by_keys():
    """/ goes to the search, and is not typed there; what is no layer is said."""
    result = "document.getElementById('find-result').textContent"
    with drawn(gcode("tile.gcode")):
        press("/")
        page.switch_to.active_element.send_keys("M106")
        check(js("return document.getElementById('find-for').value") == "M106", "what is typed after / is the text")
        js("const what = document.getElementById('find-what'); what.value = 'layer'; what.dispatchEvent(new Event('change'))")
        for wanted in ("0", str(LAYERS + 1)):
            js("document.getElementById('find-for').value = arguments[0]", wanted)
            press("\n", "find-for")
            check(js(f"return {result}") == f"The print has layers 1 to {LAYERS}.", f"layer {wanted} is none: {js(f'return {result}')}")
            at_layers(1, LAYERS, "nothing moves")
        js("document.getElementById('find-for').value = 2")
        press("\n", "find-for")
        at_layers(1, 2, "layer 2 is one")
        check(js(f"return {result}") == "layer 2", "and is said")


def play():
    """A hand on the slider wins over the clock; another input ends it."""
    printed = "Number(document.getElementById('printed').value)"
    playing = "document.getElementById('play').getAttribute('aria-pressed') === 'true'"
    with drawn(gcode("tile.gcode"), None, gcode("two_tone.gcode")):
        press("p")
        until(f"{printed} > 1 && {printed} < 30", "it plays")
        set_slider("printed", 60)
        until(f"{printed} > 60.5", "it goes on from there", 3)
        check(js(f"return {printed}") < 80, "not from where it was")
        js("const file = document.getElementById('file'); file.value = '1'; file.dispatchEvent(new Event('change'))")
        check(not js(f"return {playing}"), "another input is not played")
        until(f"{printed} === 100", "and is whole")


def share():
    """The panel follows the share that is printed: its layer, its move, and the time."""
    program = Program(gcode("tile.gcode"))
    length = lambda bead: sum((a - b) ** 2 for a, b in zip(bead[3], bead[4])) ** 0.5
    rest = 0.07 * sum(map(length, program.beads))
    layer = next(bead[1] for bead in program.beads if (rest := rest - length(bead)) < 0)
    with drawn(gcode("tile.gcode"), {"printed": 7}):
        told = until("document.getElementById('moves-value').textContent.match(/^move (\\d+) of (\\d+) in layer (\\d+)$/)", "a move")
        move, count, at = map(int, told[1:])
        check(abs(at - layer) <= 1 and 0 < move <= count, f"{told[0]}; 7 % of the length end in layer {layer}")
        until(f"document.getElementById('layer-info').textContent.startsWith('Layer {at}:')", "its height and time")
        printed = until("document.getElementById('printed-value').textContent.match(/^7 %, 0:00:(\\d+)$/)", "the time of it")
        check(10 < int(printed[1]) < 60, f"it is {printed[0]}")
        # From there, single moves are those of this layer.
        beads = program.of_layer(at)
        set_slider("moves", 3)
        check(settled()["beads"] == beads[2] + 1, f"the third move of layer {at}: {settled()}")
        set_slider("moves", len(beads))
        check(settled().get("beads") == beads[-1] + 1, f"its last one is not that of the print: {settled()}")


def nothing_left():
    """An empty selection is told in the page's words; the page's own picture of the next view is no old one."""
    trouble = "document.getElementById('trouble')"
    told = f"!{trouble}.hidden && document.getElementById('trouble-text').textContent"
    good = f"{trouble}.hidden && !document.body.classList.contains('stale')"
    unfinished = "!window.vdbviewLog.some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())"
    # So many samples that the finished picture takes its time.
    with drawn(gcode("tile.gcode"), {"spp": 512}):
        js("for (const box of document.querySelectorAll('#features input')) box.click()")
        check(until(told, "a word") == "Nothing is shown: all features are hidden.", js(f"return {told}"))
        check(js("return document.getElementById('status').textContent") == "", "and nothing is on its way")
        js("for (const box of document.querySelectorAll('#features input')) box.click()")
        until(f"{good} && {unfinished}", "all of them again", 30)
        set_slider("layer-high", 21)
        set_slider("layer-low", 20)
        set_slider("printed", 3)
        check(until(told, "a word") == "Nothing is shown: what is selected is printed later.", js(f"return {told}"))
        js("const s = document.getElementById('printed'); s.value = 95; s.dispatchEvent(new Event('input', { bubbles: true }))")
        until(f"{good} && {unfinished}", "a slider that moves has it back", 30)
        js("location.hash = '#' + encodeURIComponent(JSON.stringify({ spp: 512, color_by: 'layer', color_range: [0, 1e99] }))")
        until(told, "a range that is refused")
        js("location.hash = '#' + encodeURIComponent(JSON.stringify({ spp: 512, color_by: 'layer', color_range: [0, 9] }))")
        until(f"{good} && {unfinished}", "the next one is not", 30)


def last_tool():
    """Of tools and objects the last one stays: none would mean all of them."""
    with drawn(gcode("two_tone.gcode")):
        ticked = js("""const boxes = [...document.querySelectorAll('#tools input')];
                       for (const box of boxes) box.click();
                       return boxes.map((box) => box.checked)""")
        check(ticked == [False, True], f"T1 stays: {ticked}")
        check(settled()["tools"] == [1], f"and is what is shown: {settled()}")


def outlived():
    """A file that is written anew is shown, also where what was selected of the old one leaves nothing of it."""
    path = os.path.join(FOLDER, "outlived.gcode")
    shutil.copy(gcode("two_tone.gcode"), path)
    hidden = ["external-perimeter", "solid-infill", "top-infill", "skirt", "custom"]  # all that the vase has
    with drawn(path, {"tools": [1], "hidden_features": hidden}):
        set_slider("moves", 5)
        check("beads" in settled(), f"a move is chosen: {settled()}")
        shutil.copy(gcode("vase.gcode"), path + ".new")
        os.replace(path + ".new", path)
        until("document.getElementById('facts').textContent.includes('180 layers')", "the vase is read")
        until("window.vdbviewLog.some((e) => e.kind === 'final' && e.number === window.vdbviewAsked())", "and shown")
        state = settled()
        check(not {"beads", "tools", "hidden_features"} & set(state), f"what it has not hides nothing: {state}")
        check(not js("return document.getElementById('trouble').checkVisibility()"), "and nothing is wrong")
    # A link's number of beads is of the file that it is opened with.
    with drawn(gcode("tile.gcode"), {"beads": 300}):
        until("window.vdbviewLog.some((e) => e.kind === 'final')", "a link")
        check(settled()["beads"] == 300, f"keeps its move: {settled()}")


def another_input():
    """What was chosen of one input is not of the next; a link leads to its input; the print beside it stays when the
    server is back."""
    with drawn(gcode("tile.gcode"), None, gcode("two_tone.gcode")):
        one_layer(True)
        js("const file = document.getElementById('file'); file.value = '1'; file.dispatchEvent(new Event('change'))")
        until("document.getElementById('facts').textContent.includes('12 layers')", "the second input")
        check(not js("return document.getElementById('one-layer').checked"), "all of its layers, as the box says")
        check(layers() == [1, 12], f"and the sliders: {layers()}")
        js("location.hash = '#' + encodeURIComponent(JSON.stringify({ layers: [1, 2] }))")
        until(f"document.getElementById('facts').textContent.includes('{LAYERS} layers')", "a link to the first one leads there")
        check(js("return document.getElementById('file').value") == "0", "as the list says")
        until("document.getElementById('layer-high').value === '2'", "with its layers")


def server_comes_back():
    """The print beside the first one stays when the server was away."""
    options = (gcode("two_tone.gcode"), "--voxel-size", "0.2", "--token-file", os.path.join(FOLDER, "token"))
    with viewer.of(gcode("tile.gcode"), *options) as process:
        viewer.drawn_here()
        port = js("return location.port")
        js("const second = document.getElementById('second'); second.value = '1'; second.dispatchEvent(new Event('change'))")
        until("document.getElementById('stage').classList.contains('two')", "two prints")
        process.terminate()
        process.wait()
        until("document.body.dataset.connection === 'gone'", "the server is gone")
        again = [os.path.join(BIN, "vdbview"), gcode("tile.gcode"), *options, "--port", port, "--quiet"]
        with subprocess.Popen(again, stdout=subprocess.PIPE, text=True) as server:
            try:
                until("document.body.dataset.connection === 'open'", "and back")
                viewer.drawn_here()
                check(js("return document.getElementById('second').value") == "1", "the second print is beside it, as before")
            finally:
                page.get("about:blank")
                server.terminate()


def no_print():
    """Keys of prints do nothing to a level set."""
    vdb = os.path.join(FOLDER, "tile.vdb")
    run(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "--voxel-size", "0.3", "-o", vdb)
    with viewer.of(vdb):
        until("window.vdbviewLog.at(-1)?.kind === 'final'", "its picture")
        before = settled()
        press("[]lpts,.")
        check(settled() == before, f"the view is as it was: {settled()}")
        check(not js("return document.getElementById('trouble').checkVisibility()"), "and nothing is wrong")
        press("1")
        check(settled()["camera"]["view"] == "front", "keys of the camera work")


def failed_saving():
    """What can't be shown can't be saved: the button says so by being free again."""
    with drawn(gcode("tile.gcode")):
        js("for (const box of document.querySelectorAll('#features input')) box.click()")
        until("document.body.classList.contains('stale')", "nothing is left to show")
        name = js("const save = document.getElementById('save'); save.click(); return save.textContent")
        check(name == "Cancel saving", "it tries to save")
        until("document.getElementById('save').textContent === 'Save picture'", "and has given it up", 20)
        check(js("return document.getElementById('trouble').checkVisibility()"), "with a word")


def focus():
    """A list that is made anew keeps the focus where it was."""
    focused = "document.activeElement.value"
    box = """document.querySelector('#features input[value="infill"]')"""
    item = """document.querySelector('#legend input[value="infill"]')"""
    path = os.path.join(FOLDER, "copy.gcode")
    shutil.copy(gcode("tile.gcode"), path)
    with drawn(path, {"color_by": "feature"}):
        until(item, "the legend")
        for checked in (False, True):
            js(f"{item}.focus()")
            page.switch_to.active_element.send_keys(" ")
            until(f"{item}.checked === {str(checked).lower()} && window.vdbviewLog.at(-1).kind === 'final'", f"infill: {checked}")
            check(js(f"return {focused}") == "infill", "the legend's entry has the focus still")
        js(f"{box}.focus(); {box}.dataset.old = '1'")
        with open(path, "a", encoding="utf-8") as file:
            file.write("; written anew\n")
        until(f"!{box}.dataset.old", "the list of features is made anew")
        check(js(f"return {focused}") == "infill", "its box has the focus still")


def written_anew():
    """A file that is written again and again takes no more of the GPU each time."""
    count = """window.live = new Set();
               const gl = WebGL2RenderingContext.prototype;
               for (const kind of ["Texture", "Buffer", "Program", "Framebuffer"]) {
                 const [make, free] = [gl["create" + kind], gl["delete" + kind]];
                 gl["create" + kind] = function () {
                   const made = make.call(this);
                   window.live.add(made);
                   return made;
                 };
                 gl["delete" + kind] = function (it) {
                   window.live.delete(it);
                   free.call(this, it);
                 };
               }"""
    path = os.path.join(FOLDER, "again.gcode")
    shutil.copy(gcode("tile.gcode"), path)
    with drawn(path):
        js(count)
        live = []
        for _ in range(7):
            before = js("return window.vdbviewLog.at(-1)?.number ?? 0")
            with open(path, "a", encoding="utf-8") as file:
                file.write("; written anew\n")
            until(f"window.vdbviewLog.at(-1)?.number > {before} && window.vdbviewLog.at(-1).kind === 'final'", "it is drawn anew")
            live.append(js("return window.live.size"))
        # The two programs of quick pictures, one of the bed and the table of moves come when a machine needs or has read them.
        late = 4
        check(live[0] > late and max(live) - min(live) <= late, f"as many objects as before: {live}")


def double_click():
    """The camera turns about what is under the double click, not about what was clicked before."""
    camera = {"eye": [100, 40, 120], "look_at": [100, 100, 0], "fov": 20}
    with drawn(gcode("tile.gcode"), {"camera": camera}):
        picture = page.find_element(By.ID, "picture")
        ActionChains(page).move_to_element_with_offset(picture, -60, 0).click().perform()
        first = until("window.vdbviewFound?.position", "a click")
        press("\ue00c")  # Escape: what is told lies over the picture
        ActionChains(page).move_to_element_with_offset(picture, 20, 5).double_click().perform()
        until("!location.hash.includes('%5B100%2C100%2C0%5D')", "it turns about another place", 30)
        place, target = js("return window.vdbviewFound.position"), settled()["camera"]["look_at"]
        off = lambda a, b: max(abs(p - q) for p, q in zip(a, b))
        check(off(place, target) < 1e-3 and off(first, target) > 1, f"about {target}; clicked before was {first}")


def nozzle():
    """Esc takes the marks of clicks away, and not the nozzle."""
    drawn_marks = """const c = document.getElementById('marks');
                     return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v) => v)"""
    with drawn(gcode("tile.gcode"), {"printed": 50}):
        settled()
        check(js(drawn_marks), "the nozzle is there")
        press("\ue00c")  # Escape
        check(js(drawn_marks), "and stays")
        press("m")
        press("\ue00c")
        check(js("return document.getElementById('measure').getAttribute('aria-pressed')") == "false", "measuring ends by it")


def dropped():
    """A file that is dropped on the page, or chosen, is a further input; the finished picture is that of its command."""
    name = "two tone (1).gcode"
    drop = """const [name, text] = arguments;
              const files = new DataTransfer();
              files.items.add(new File([text], name));
              for (const type of ["dragover", "drop"])
                document.body.dispatchEvent(new DragEvent(type, { bubbles: true, cancelable: true, dataTransfer: files }));
              return document.body.className"""
    with open(gcode("two_tone.gcode"), encoding="utf-8") as file:
        text = file.read()
    listed = "[...document.getElementById('file').options].map((each) => each.text)"
    shown = "document.getElementById('file').selectedOptions[0].text"
    command = "document.getElementById('command').textContent"
    with drawn(gcode("tile.gcode")):
        check("dropping" not in js(drop, name, text), "nothing hovers over the page any more")
        until(f"{shown} === '{name}'", "it is looked at")
        until(f"{command}.includes('{name}')", "and its command is there")
        until("document.getElementById('tools').children.length === 2", "with its tools")
        path = re.search(r"'([^']*)'", js(f"return {command}")).group(1)
        with open(path, encoding="utf-8") as file:
            check(file.read() == text, f"{path} is what was dropped")
        check(os.stat(os.path.dirname(os.path.dirname(path))).st_mode & 0o077 == 0, "for this user alone")
        # The button's list of files.
        page.find_element(By.ID, "chosen").send_keys(gcode("tile_arcs.gcode"))
        until(f"{shown} === 'tile_arcs.gcode'", "the chosen one is looked at")
        check(js(f"return {listed}") == ["tile.gcode", name, "tile_arcs.gcode"], "all can be chosen")
        js(drop, "bad.gcode", "no print at all")
        until(f"{shown} === 'bad.gcode'", "a bad one, too")
        until("document.getElementById('trouble-text').textContent.includes('bad.gcode')", "and the page says what is wrong with it")
        js(drop, "scene.json", '{"print": "/etc/passwd"}')
        until("document.getElementById('trouble-text').textContent.startsWith('scene.json was not opened: a scene names')", "scenes are refused")
        check(js(f"return {listed}")[-1] == "bad.gcode", "and not listed")
    for _ in range(100):
        if os.path.exists(path):
            time.sleep(0.1)
    check(not os.path.exists(path), "the server's end removes them")
    with drawn(gcode("tile.gcode"), None, "--listen", "0.0.0.0"):
        check(js("return document.getElementById('open').hidden"), "others' pages have no such button")
        js(drop, name, text)
        until("document.getElementById('trouble-text').textContent.startsWith('This server takes no files')", "and say why")


try:
    dropped()
    keys_of_layers()
    one_layer_alone()
    share()
    nothing_left()
    last_tool()
    outlived()
    search_by_keys()
    play()
    another_input()
    server_comes_back()
    no_print()
    failed_saving()
    focus()
    written_anew()
    double_click()
    nozzle()
finally:
    viewer.close()

"""Scenes in the viewer: the finished picture of each has the bytes that the command below it makes."""

import json
import os
import shlex
import shutil
import subprocess
import tempfile

from run_tools import BIN, check, gcode
from viewer_socket import Socket

FOLDER = tempfile.mkdtemp(prefix="stratum_view_scenes_")
SIZE = {"size": [160, 120], "spp": 2}
GIVEN = dict(SIZE, camera={"view": "", "fov": 28})
TOP = dict(SIZE, camera={"view": "top", "fov": 28})

# A scene, and what a page chooses of it.
CASES = (
    ({}, (GIVEN, TOP)),
    ({"camera": {"eye": [200, -100, 90]}}, (GIVEN, TOP)),
    ({"camera": {"f_number": 2, "focus": [100, 100, 2]}}, (dict(SIZE, camera={"eye": [0, -200, 50], "look_at": [100, 100, 0], "fov": 28}),)),
    ({"background": "none"}, (GIVEN,)),
    ({"legend": True, "color_by": "layer"}, (GIVEN,)),
    ({"print": gcode("two_tone.gcode"), "color": "red,blue"}, (GIVEN, dict(GIVEN, material="pla-red"))),
    ({"clip": [0, 0, 1, 3]}, (GIVEN, dict(GIVEN, clip=[1, 0, 0, 100]))),
    ({"size": [640, 480], "crop": [0, 0, 600, 400]}, (GIVEN,)),
    ({"aov": "normal", "output": "part.exr"}, (GIVEN,)),
    ({"noise": 0.2}, (GIVEN,)),
    ({"integrator": {"name": "depth"}, "denoise": False}, (GIVEN, dict(GIVEN, integrator="normal"))),
    ({"print": "", "objects": [{"vdb": gcode("tile.gcode"), "material": "pla-blue"}]}, (GIVEN, dict(GIVEN, material="pla-red"))),
    ({"material": "clear-petg"}, (GIVEN,)),
)


def traced(command):
    """What the shown command makes."""
    path = os.path.join(FOLDER, "traced.png")
    words = shlex.split(command)
    check(words[0] == "vdbtrace", command)
    done = subprocess.run([os.path.join(BIN, "vdbtrace"), *words[1:], "-o", path, "--quiet"], capture_output=True, text=True)
    check(done.returncode == 0, f"{command}: {done.stderr}")
    with open(path, "rb") as file:
        return file.read()


paths = []
for n, (scene, _) in enumerate(CASES):
    keys = {"print": gcode("tile.gcode"), **scene}
    paths.append(os.path.join(FOLDER, f"scene{n}.json"))
    with open(paths[-1], "w", encoding="utf-8") as out:
        json.dump({key: value for key, value in keys.items() if value != ""}, out)
server = subprocess.Popen([os.path.join(BIN, "vdbview"), *paths, "--quiet"], stdout=subprocess.PIPE, text=True)
try:
    page = Socket(server.stdout.readline().strip())
    number = 0
    for n, (scene, states) in enumerate(CASES):
        page.send({"type": "open", "file": n})
        for state in states:
            number += 1
            head, picture = page.final(number, state)
            check(head is not None, f"{scene}: a finished picture")
            check(picture == traced(head["command"]), f"{scene}: the bytes of {head['command']}")
finally:
    server.terminate()
    server.wait(60)
shutil.rmtree(FOLDER)
print(f"{number} pictures have the bytes of their commands")

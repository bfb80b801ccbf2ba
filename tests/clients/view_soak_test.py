"""Eight clients of one vdbview for 20 s: it lives, all get pictures, and its memory stays.

STRATUM_SOAK_SECONDS=600 is the long form; with STRATUM_BIN of a build under ThreadSanitizer, its reports are failures, too.
"""

import os
import subprocess
import tempfile

from run_tools import BIN, check, gcode
from viewer_socket import resident, soak

SECONDS = float(os.environ.get("STRATUM_SOAK_SECONDS", "20"))
sizes = []


def tell(seconds, process, clients):
    sizes.append(resident(process))
    print(f"{seconds:.0f} s: {sizes[-1]:.0f} MB, pictures {[client.pictures for client in clients]}", flush=True)


with tempfile.TemporaryFile("w+") as words:
    with subprocess.Popen([os.path.join(BIN, "vdbview"), gcode("hull.gcode"), "--quiet"], stdout=subprocess.PIPE, stderr=words,
                          text=True) as process:
        try:
            clients = soak(process, process.stdout.readline().strip(), SECONDS, tell)
            alive = process.poll() is None
            if alive:
                tell(SECONDS, process, clients)
        finally:
            process.terminate()
    words.seek(0)
    said = words.read()
check(alive, f"the server lives: {said[-2000:]}")
check(min(client.pictures for client in clients) > SECONDS / 10, "each client has got pictures")
check("Sanitizer" not in said, f"no report of a sanitizer: {said[:4000]}")
check(process.returncode in (0, -15, 130, 143), f"it ends when it is told to: {process.returncode}")
check(max(sizes) < 1500, f"{max(sizes):.0f} MB at most")

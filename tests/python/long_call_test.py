"""Long calls: other threads run meanwhile, progress is told, Ctrl-C ends them."""

import os
import threading
import time
import unittest

import numpy as np

import stratum
from common import FOLDER, gcode, path_of, python

# Each takes many seconds, but the first, which Ctrl-C comes to earlier: a fast machine reads 120 MB in 0.4 s.
LONG = {
    "read": "stratum.read(program)",
    "voxelize": "stratum.voxelize(toolpath, voxel_size=0.02)",
    "voxelize_block": "stratum.voxelize_block(toolpath, voxel_size=0.03)",
    "write_vdb": f"stratum.write_vdb(toolpath, {path_of('never.vdb')!r}, voxel_size=0.02)",
    "render": "stratum.render(toolpath, size=(2560, 1920), spp=256, denoise=False, voxel_size=0.2)",
    "distance": "stratum.PrintField(toolpath, voxel_size=0.1).distance(points)",
    "trace": "shape.trace(points, points)",
    # What follows the voxels: the signal comes when they are there.
    "report": "stratum.report(toolpath, voxel_size=0.04, progress=arm)",
    "interior_distance": "stratum.voxelize(toolpath, voxel_size=0.03, interior_distance=True, progress=arm)",
    "write": f"level_set.write({path_of('never.vdb')!r}, compression='zip')",
    "read_level_set": "stratum.LevelSet.read(file)",
    "dense": "level_set.dense(box)",
}
PROGRAM = """
import sys, threading, time, signal, os
import numpy as np
import stratum
toolpath = stratum.read(sys.argv[1])
program = (open(sys.argv[1], "rb").read() * 60) if "program" in sys.argv[2] else b""
points = np.empty((0, 3))
if "points" in sys.argv[2]:
    low, high = np.array([60.0, 80, 0]), np.array([140.0, 120, 40])
    count = 8_000_000 if "trace" in sys.argv[2] else 20_000_000
    points = np.random.default_rng(1).uniform(low, high, (count, 3))
if "shape" in sys.argv[2]:
    shape = stratum.Intersector(stratum.PrintField(toolpath, voxel_size=0.2))
if "level_set" in sys.argv[2] or "file" in sys.argv[2]:
    level_set = stratum.voxelize(toolpath, voxel_size=0.04)
    box = ((75, 85, 0), (115, 115, 20))  # 1.5 GB
if "file" in sys.argv[2]:
    file = os.path.join(sys.argv[4], "level_set.vdb")
    level_set.write(file, compression="zip")
sent = []


def now():
    return np.array([time.perf_counter(), time.process_time()])


def send():
    sent.append(now())
    os.kill(os.getpid(), signal.SIGINT)


def arm(fraction):
    if fraction > 0.999 and not timers:
        timers.append(threading.Timer(float(sys.argv[3]), send))
        timers[0].start()


timers = []
if "arm" not in sys.argv[2]:
    arm(1)
try:
    eval(sys.argv[2])
except KeyboardInterrupt:
    # On a machine that others load as well, the processor time of this process is the smaller one.
    print("interrupted", min(now() - sent[0]))
else:
    print("finished", min(now() - sent[0]) if sent else "before")
"""


class Interrupts(unittest.TestCase):
    def ends(self, call, after=0.5, within=5):
        done = python(PROGRAM, gcode("hull.gcode"), LONG[call], str(after), FOLDER)
        words = done.stdout.split()
        self.assertEqual(words[:1], ["interrupted"], done.stdout + done.stderr)
        print(f"{call}: {float(words[1]):.2f} s after Ctrl-C")
        self.assertLess(float(words[1]), within)

    def test_read(self):
        self.ends("read", 0.1)

    def test_voxelize(self):
        self.ends("voxelize")

    def test_voxelize_block(self):
        self.ends("voxelize_block")

    def test_write_vdb(self):
        self.ends("write_vdb")
        self.assertEqual([name for name in os.listdir(FOLDER) if "never" in name], [])

    def test_render(self):
        self.ends("render")

    def test_distance(self):
        self.ends("distance")

    def test_trace(self):
        self.ends("trace")

    def test_report(self):
        self.ends("report", 0.1, 1.5)

    def test_interior_distance(self):
        # During the copy of the level set. OpenVDB's masks and buffers, which follow it, can't be stopped.
        self.ends("interior_distance", 0.1, 1.5)

    def test_write(self):
        self.ends("write", 0.1, 0.5)
        self.assertEqual([name for name in os.listdir(FOLDER) if "never" in name], [])

    def test_read_level_set(self):
        self.ends("read_level_set", 0.02, 0.3)

    def test_dense(self):
        self.ends("dense", 0.1, 1.5)

    def test_works_after(self):
        code = """
import sys, threading, os, signal
import stratum
toolpath = stratum.read(sys.argv[1])
for _ in range(3):
    threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    try:
        stratum.voxelize(toolpath, voxel_size=0.02)
    except KeyboardInterrupt:
        print("interrupted")
print(stratum.voxelize(toolpath, voxel_size=0.4).active_voxels > 1000)
"""
        self.assertEqual(python(code, gcode("hull.gcode")).stdout.split(), ["interrupted"] * 3 + ["True"])


class Progress(unittest.TestCase):
    def check(self, call):
        told = []
        call(told.append)
        self.assertGreater(len(told), 0)
        self.assertTrue(all(0 <= fraction <= 1 for fraction in told), told)
        self.assertGreater(told[-1], 0.9)

    def test_told(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        self.check(lambda report: stratum.voxelize(toolpath, voxel_size=0.1, progress=report))
        self.check(lambda report: stratum.voxelize_block(toolpath, voxel_size=0.1, progress=report))
        self.check(lambda report: stratum.render(toolpath, size=(320, 240), spp=8, voxel_size=0.2, progress=report))
        field = stratum.PrintField(toolpath, voxel_size=0.2)
        self.check(lambda report: field.distance(np.random.default_rng(0).uniform(0, 200, (100000, 3)), progress=report))

    def test_its_exceptions_end_the_call(self):
        toolpath = stratum.read(gcode("hull.gcode"))

        def fail(fraction):
            raise KeyError("enough")

        start = time.perf_counter()
        with self.assertRaisesRegex(KeyError, "enough"):
            stratum.render(toolpath, size=(2560, 1920), spp=256, denoise=False, voxel_size=0.2, progress=fail)
        self.assertLess(time.perf_counter() - start, 10)

    def test_on_the_calling_thread(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        threads = set()
        stratum.voxelize(toolpath, voxel_size=0.1, progress=lambda fraction: threads.add(threading.get_ident()))
        self.assertEqual(threads, {threading.get_ident()})


class Gil(unittest.TestCase):
    def test_others_run(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        ticks, done = [], threading.Event()

        def tick():
            while not done.wait(0.01):
                ticks.append(time.perf_counter())

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.perf_counter()
        while time.perf_counter() - start < 1:
            stratum.voxelize(toolpath, voxel_size=0.1)
        done.set()
        thread.join()
        self.assertGreater(len(ticks), 10)

    def test_many_threads_at_once(self):
        toolpath = stratum.read(gcode("hull.gcode"))
        field = stratum.PrintField(toolpath, voxel_size=0.2)
        shape = stratum.Intersector(field, ["layer"])
        points = np.random.default_rng(4).uniform((70, 86, 0), (130, 114, 37), (20000, 3))
        expected = (field.distance(points), shape.trace(points, [[0, 0, 1]]).t,
                    stratum.voxelize(toolpath, voxel_size=0.3).active_voxels)
        failures = []

        def work():
            for _ in range(3):
                found = (field.distance(points), shape.trace(points, [[0, 0, 1]]).t,
                         stratum.voxelize(toolpath, voxel_size=0.3).active_voxels)
                if not all(np.array_equal(a, b) for a, b in zip(found, expected)):
                    failures.append(found)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])


class Import(unittest.TestCase):
    def test_without_numpy(self):
        done = python("import sys; sys.modules['numpy'] = None; import stratum")
        self.assertIn("ImportError: stratum needs NumPy: install python3-numpy", done.stderr)

    def test_is_light(self):
        seconds = []
        for _ in range(5):
            done = python("import time, numpy; t = time.process_time(); import stratum; print(time.process_time() - t)")
            seconds.append(float(done.stdout))
        print(f"import stratum: {min(seconds) * 1e3:.0f} ms of processor time after numpy")
        # A quarter is what a quiet machine takes.
        self.assertLess(min(seconds), 0.2)


if __name__ == "__main__":
    unittest.main()

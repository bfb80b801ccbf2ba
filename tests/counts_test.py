"""scripts/test_counts.py: what was skipped is counted by reason, whatever program skipped it."""

import os
import subprocess
import sys
import tempfile

SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scripts", "test_counts.py")
LOG = """Start testing: Nov 26 06:50 UTC
----------------------------------------------------------
1/4 Testing: prints.RealPrints
1/4 Test: prints.RealPrints
Output:
----------------------------------------------------------
[ RUN      ] RealPrints.Benchy
/a/tests/voxelize/real_prints_test.cpp:47: Skipped
corpus file gcode/benchy.gcode is not there
[  SKIPPED ] RealPrints.Benchy (0 ms)
[ RUN      ] RealPrints.Fox
/a/tests/voxelize/real_prints_test.cpp:47: Skipped
corpus file gcode/fox.gcode is not there

[  SKIPPED ] RealPrints.Fox (0 ms)
[ RUN      ] RealPrints.Own
[       OK ] RealPrints.Own (3 ms)
[  PASSED  ] 1 test.
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] RealPrints.Benchy
[  SKIPPED ] RealPrints.Fox
Test Passed.
2/4 Testing: base.Memory
2/4 Test: base.Memory
[ RUN      ] Memory.Limits
[       OK ] Memory.Limits (0 ms)
[ RUN      ] Memory.Groups
/a/tests/base/memory_test.cpp:63: Skipped
a sanitizer maps terabytes
[  SKIPPED ] Memory.Groups (0 ms)
[  PASSED  ] 1 test.
Test Passed.
3/4 Testing: Client.view
3/4 Test: Client.view
Output:
skipped: chromium: not installed; scripts/packages.sh has the packages
ok: something
skipped: corpus file two.gcode is not there
Test time =   0.1 sec
Test Skipped.
4/4 Testing: Python.voxelize
4/4 Test: Python.voxelize
test_block_of_real_prints (__main__.Corpus) ... skipped 'no /a/../shared/corpus/gcode/vase.gcode'
test_same_values (__main__.OpenVdb) ... skipped 'no pyopenvdb for this Python'
test_streamed (__main__.Files) ... ok
Test Passed.
"""


def counted(log, *options):
    with tempfile.TemporaryDirectory() as folder:
        os.makedirs(os.path.join(folder, "Testing", "Temporary"))
        with open(os.path.join(folder, "Testing", "Temporary", "LastTest.log"), "w", encoding="utf-8") as file:
            file.write(log)
        return subprocess.run([sys.executable, SCRIPT, folder, *options], capture_output=True, text=True, check=False)


def check(condition, text):
    if not condition:
        sys.exit(f"FAILED: {text}")


done = counted(LOG)
lines = done.stdout.split("\n")
for line in ("3 suites and programs passed; of their tests 2 passed, 0 failed, 7 skipped", "4 skipped: the corpus is not there",
             "1 skipped: a sanitizer maps terabytes", "1 skipped: no pyopenvdb for this Python",
             "1 skipped: chromium: not installed; scripts/packages.sh has the packages",
             "skipped: RealPrints.Fox: the corpus is not there"):
    check(line in lines, f"{line!r} is not in\n{done.stdout}")
check(done.returncode == 0, done.stderr)
check(lines.index("4 skipped: the corpus is not there") > lines.index("skipped: RealPrints.Fox: the corpus is not there"),
      "counts come last")
check(counted(LOG, "--needs-corpus").returncode == 1, "where the corpus is needed, its lack is a failure")
none = counted("1/1 Testing: a\n[ RUN      ] A.B\n[       OK ] A.B (0 ms)\n[  PASSED  ] 1 test.\nTest Passed.\n", "--needs-corpus")
check(none.returncode == 0 and "skipped:" not in none.stdout, none.stdout)

"""Counts the tests of CTest's last run in a build folder: a test of CTest is a whole suite of ours. Names what was
skipped. With --needs-corpus, ends with 1 if a test was skipped because its file of the corpus is not there.
Usage: test_counts.py BUILD [--needs-corpus]"""

import os
import re
import sys

log_path = os.path.join(sys.argv[1], "Testing", "Temporary", "LastTest.log")
with open(log_path, encoding="utf-8", errors="replace") as log:
    text = log.read()
passed = sum(int(count) for count in re.findall(r"^\[  PASSED  \] (\d+) tests?\.", text, re.MULTILINE))
failed = sum(int(count) for count in re.findall(r"^\[  FAILED  \] (\d+) tests?, listed below", text, re.MULTILINE))
skipped = sorted(set(re.findall(r"^\[  SKIPPED \] (\S+?)(?: \(\d+ ms\))?$", text, re.MULTILINE)))
programs = len(re.findall(r"^Test Passed\.$", text, re.MULTILINE))
absent = sorted(set(re.findall(r"corpus file \S+ is not there", text)))
for line in [f"skipped: {name}" for name in skipped] + absent:
    print(line)
print(f"{programs} suites and programs passed; of their tests {passed} passed, {failed} failed, {len(skipped)} skipped")
if absent and "--needs-corpus" in sys.argv:
    sys.exit("these tests must not be skipped here: the corpus is beside the checkout or named by $STRATUM_CORPUS")

"""Counts the tests of CTest's last run in a build folder: a test of CTest is a whole suite of ours. Names what was
skipped, and counts it by reason. With --needs-corpus, ends with 1 if a test was skipped because its file of the corpus is
not there. Usage: test_counts.py BUILD [--needs-corpus]"""

import collections
import os
import re
import sys

NO_CORPUS = "the corpus is not there"


def reason_of(text):
    """Files of the corpus are one reason."""
    if re.search(r"corpus file \S+ is not there|there is no corpus|no \S*/corpus/", text):
        return NO_CORPUS
    return text.strip() or "no reason is told"


def skips(text):
    """(name, reason) of every test that was skipped: GoogleTest's, unittest's, and whole programs."""
    for name, told in re.findall(r"^\[ RUN      \] (\S+)\n((?:(?!\[ RUN).*\n)*?)\[  SKIPPED \] \1", text, re.M):
        told = re.sub(r"^.*: Skipped$", "", told, flags=re.M)
        yield name, reason_of(told.strip().split("\n")[0])
    for name, told in re.findall(r"^(test_\w+ \([\w.]+\)).*? \.\.\. skipped ['\"](.*)['\"]$", text, re.M):
        yield name, reason_of(told)
    for program in re.split(r"^\d+/\d+ Testing: ", text, flags=re.M)[1:]:
        for told in set(re.findall(r"^skipped: (.*)$", program, re.M)):
            yield program.split("\n")[0], reason_of(told)


def main(folder, needs_corpus):
    with open(os.path.join(folder, "Testing", "Temporary", "LastTest.log"), encoding="utf-8", errors="replace") as log:
        text = log.read()
    passed = sum(int(count) for count in re.findall(r"^\[  PASSED  \] (\d+) tests?\.", text, re.MULTILINE))
    failed = sum(int(count) for count in re.findall(r"^\[  FAILED  \] (\d+) tests?, listed below", text, re.MULTILINE))
    skipped = sorted(set(skips(text)))
    programs = len(re.findall(r"^Test Passed\.$", text, re.MULTILINE))
    for name, reason in skipped:
        print(f"skipped: {name}: {reason}")
    print(f"{programs} suites and programs passed; of their tests {passed} passed, {failed} failed, {len(skipped)} skipped")
    reasons = collections.Counter(reason for _, reason in skipped)
    for reason, count in reasons.most_common():
        print(f"{count} skipped: {reason}")
    if needs_corpus and reasons[NO_CORPUS]:
        sys.exit("these tests must not be skipped here: the corpus is beside the checkout or named by $STRATUM_CORPUS")


if __name__ == "__main__":
    main(sys.argv[1], "--needs-corpus" in sys.argv)

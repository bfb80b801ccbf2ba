"""docs/python.md: its code runs, and prints what the page shows."""

import os
import sys
import unittest

from common import SOURCE

sys.path.insert(0, os.path.join(SOURCE, "scripts"))
import run_page  # noqa: E402


class Page(unittest.TestCase):
    def test_regenerated_identical(self):
        with open(os.path.join(SOURCE, "docs", "python.md"), encoding="utf-8") as file:
            page = file.read()
        self.assertGreater(page.count("```text\n"), 5)
        self.maxDiff = None
        self.assertEqual(run_page.run(page), page)

    def test_finds_a_change(self):
        self.assertEqual(run_page.run("```python\nprint(2)\n```\n\n```text\n1\n```\n"),
                         "```python\nprint(2)\n```\n\n```text\n2\n```\n")


if __name__ == "__main__":
    unittest.main()

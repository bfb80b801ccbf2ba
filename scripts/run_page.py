#!/usr/bin/env python3
"""Runs the Python of a page and writes what it prints into the page: scripts/run_page.py docs/python.md [OUT.md]

Blocks of ```python run one after the other in one process, in a folder of their own. What a block prints becomes the
block of ```text after it; a block that prints nothing has none. Without a change in what is printed the page stays as
it is, byte for byte.
"""

import contextlib
import io
import os
import re
import sys
import tempfile

BLOCK = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n.*?^```\n)?", re.M | re.S)


def run(page):
    names = {"__name__": "__main__"}

    def once(match):
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(match.group(1), "page", "exec"), names)  # its own page
        text = "```python\n" + match.group(1) + "```\n"
        return text + (f"\n```text\n{printed.getvalue()}```\n" if printed.getvalue() else "")

    here = os.getcwd()
    with tempfile.TemporaryDirectory(prefix="stratum_page_") as folder:
        os.chdir(folder)
        try:
            return BLOCK.sub(once, page)
        finally:
            os.chdir(here)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        page = run(file.read())
    with open(sys.argv[-1], "w", encoding="utf-8") as file:
        file.write(page)


if __name__ == "__main__":
    main()

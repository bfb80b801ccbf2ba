"""The page of a vdbview in a browser."""

import contextlib
import os
import subprocess
import sys
import time

from run_tools import BIN


class ViewerPage:
    def __init__(self, page):
        self.page = page

    def js(self, text, *arguments):
        return self.page.execute_script(text, *arguments)

    def until(self, condition, text, seconds=150):
        """Waits until an expression of JavaScript is true; returns its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.js(f"return {condition}")
            if value:
                return value
            time.sleep(0.05)
        print(self.js("return [window.vdbviewLog?.slice(-5), window.told, document.body.innerText]"), self.page.get_log("browser"))
        sys.exit(f"FAILED: {text}: not within {seconds} s")

    @contextlib.contextmanager
    def of(self, path, *options, query=""):
        """A vdbview, whose page is open. `query`: what follows its URL."""
        with subprocess.Popen([os.path.join(BIN, "vdbview"), path, "--quiet", *options], stdout=subprocess.PIPE, text=True) as process:
            try:
                self.page.get(process.stdout.readline().strip() + query)
                yield process
            finally:
                try:
                    self.page.get("about:blank")
                finally:
                    process.terminate()

    def drawn_here(self):
        self.until("document.body.dataset.moving === 'own'", "the page draws what moves")

"""Headless Chromium, driven by Debian's python3-selenium."""

import shutil
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service


def browser(profile, width, height, script_seconds):
    """A window of that size, in pixels; scripts on its page may take so long. `profile`: a scratch folder."""
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     f"--window-size={width},{height}", f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.binary_location = shutil.which("chromium")
    page = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    page.set_script_timeout(script_seconds)
    return page


def until(page, condition, text, seconds=150):
    """Waits until an expression of JavaScript is true on a viewer's page; returns its value."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = page.execute_script(f"return {condition}")
        if value:
            return value
        time.sleep(0.05)
    print(page.execute_script("return [window.vdbviewLog?.slice(-5), window.told, document.body.innerText]"), page.get_log("browser"))
    sys.exit(f"FAILED: {text}: not within {seconds} s")

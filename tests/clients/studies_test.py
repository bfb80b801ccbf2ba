"""The pages of the studies in a real Chromium, wide and as on a phone; the ten lines, and where their numbers lead.

Of the folder that the test Studies has written (scripts/study.sh --quick), or of the one that is given.
"""

import csv
import os
import pathlib
import re
import shutil
import sys
import tempfile

from run_tools import SOURCE, check, skip_without

skip_without(("chromium", "chromedriver"), ("selenium",))

from chromium import browser

FOLDER = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else os.environ["STRATUM_STUDIES"])
PICTURES = os.environ.get("STRATUM_SCREENSHOTS")  # a folder, to look at them
STUDIES = ["memory", "geometry", "render", "stability", "deposit", "need", "polygons"]

# --- tables name the program that made them --------------------------------------------------------------------------------
tables = sorted(p for p in FOLDER.glob("*.csv") if p.stem != "need_off")
for table in tables:
    with table.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check(rows and all(row["made_by"].startswith("vdbstudy ") for row in rows), f"{table.name}: {len(rows)} rows of vdbstudy")
check({"deposit_volume", "deposit_roughness", "deposit_corner", "deposit_time"} <= {t.stem for t in tables},
      "the tables of what the plastic does are there")

# --- pages hold all they show, and are light ---------------------------------------------------------------------------
for study in STUDIES:
    page = (FOLDER / f"{study}.html").read_text(encoding="utf-8")
    check(len(page.encode()) <= 1e6, f"{study}.html has {len(page.encode())} bytes")
    check("<script" not in page and not re.search(r"(src|href)='?https?:", page), "  and needs no other")
    check("GB of memory" in page and "<code>vdbstudy " in page.replace("bench_vdb", "vdb"), "  says how and where it was made")

# --- ten lines, whose numbers are in the rows that they lead to ----------------------------------------------------------
readme = (FOLDER / "README.md").read_text(encoding="utf-8")
section = re.search(r"<!-- ten lines -->(.*)<!-- /ten lines -->", readme, re.S).group(1)
lines = re.findall(r"^\d+\. (.*)$", section, re.M)
check(len(lines) == 10, "ten lines")
links = re.findall(r"\[([^\]]+)\]\(([\w/]+)\.csv\?plain=1#L(\d+)\)", section)
check(len(links) >= 25, f"{len(links)} numbers with links")
for text, table, line in links:
    count = len((FOLDER / f"{table}.csv").read_text(encoding="utf-8").splitlines())
    check(2 <= int(line) <= count, f"{text}: {table}.csv has line {line}")
without = [n + 1 for n, line in enumerate(lines) if "](" not in line]
# Without Embree there is no peer to compare with.
check(set(without) <= {1}, f"lines without a number: {without}")

# --- the README's tables come from the same files, and only their digits change ------------------------------------------
scratch = pathlib.Path(tempfile.mkdtemp(prefix="stratum_studies_"))
shutil.copy(os.path.join(SOURCE, "README.md"), scratch / "README.md")
os.system(f"{sys.executable} {SOURCE}/scripts/readme_tables.py {SOURCE}/docs/studies {scratch}/README.md")


def without_digits(path):
    return re.sub(r"[\d.]+(e[+-]\d+)?", "0", path.read_text(encoding="utf-8"))


check(without_digits(scratch / "README.md") == without_digits(pathlib.Path(SOURCE, "README.md")), "README.md: digits alone")

done = os.system(f"{sys.executable} {SOURCE}/scripts/studies_page.py {SOURCE}/docs/studies --check")
check(done == 0, "docs/studies/README.md has the lines of its tables")

# --- in a browser --------------------------------------------------------------------------------------------------------
driver = browser(str(scratch / "profile"), 1280, 900, 60)
try:
    for width, height, phone in ((1280, 900, False), (390, 844, True)):
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                               {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone})
        for study in STUDIES:
            driver.get((FOLDER / f"{study}.html").resolve().as_uri())
            wide = driver.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
            check(wide[0] <= width and wide[1] == width, f"{study}, {width} pixels: the page is {wide[0]} wide")
            small = driver.execute_script(
                "return [...document.querySelectorAll('svg text')].filter(t => t.getBoundingClientRect().height < 9).length")
            check(small == 0, "  letters of plots can be read")
            hidden = driver.execute_script(
                "return [...document.querySelectorAll('table, .plot')].filter(t => t.scrollWidth > t.clientWidth"
                " && !['auto', 'scroll'].includes(getComputedStyle(t).overflowX)).length")
            check(hidden == 0, "  what is too wide scrolls inside itself")
            if PICTURES:
                full = driver.execute_script("return document.documentElement.scrollHeight")
                driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                       {"width": width, "height": min(full, 3000), "deviceScaleFactor": 1, "mobile": phone})
                driver.save_screenshot(os.path.join(PICTURES, f"{study}_{width}.png"))
                driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                       {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone})
finally:
    driver.quit()

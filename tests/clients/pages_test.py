"""What the pages show of the tools: every option is in the tool's help, and every output that is shown is printed.

A block of ```text right after a block of ```sh is what the last command of that block prints. A table after a command with
`--report NAME.md` has the numbers of that file. Times and sizes that depend on the machine are compared by their units alone:
MASKED. With --write the pages get what is printed now. `scripts/run_page.py` does the same for the Python of docs/python.md.
"""

import glob
import os
import re
import subprocess
import sys
import tempfile

from run_tools import BIN, SOURCE

TOOLS = ("gcode2vdb", "vdbtrace", "vdbview", "vdbmerge", "vdbstudy")
PAGES = sorted(glob.glob(os.path.join(SOURCE, "docs", "*.md"))) + [os.path.join(SOURCE, "README.md")]
# Seconds that a command took, and memory: "in 0.31 s", "after 2 s", "12.4 MB".
MASKED = (r"\b(in|after|took) [\d.]+ (s|ms)\b", r"\b[\d.]+ (MB|GB|KB)\b")
problems = []


def help_of(tool):
    text = subprocess.run([os.path.join(BIN, tool), "--help-all"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"(?<![\w-])--?[a-z][a-z0-9-]*", text))


OPTIONS = {tool: help_of(tool) for tool in TOOLS}
# Options of others that the pages name without their command.
OTHERS = {"--array", "--dependency", "--wrap"}  # of sbatch
for script in glob.glob(os.path.join(SOURCE, "scripts", "*")) + glob.glob(os.path.join(SOURCE, "bench", "*")):
    if os.path.isfile(script):
        with open(script, encoding="utf-8", errors="replace") as file:
            OTHERS.update(re.findall(r"--[a-z][a-z0-9-]*", file.read()))


def options_in(words):
    return [option for word in words for option in re.findall(r"^--[a-z][a-z0-9-]*", word)]


def commands(line):
    """The commands of a line of shell that are ours, as words; comments are left out."""
    line = re.sub(r"(^|\s)#.*", "", line)
    for part in re.split(r"\||;|&&|\$\(|\)|--wrap", line):
        words = part.replace("'", " ").replace('"', " ").split()
        while words and (words[0] == "parallel" or re.match(r"\w+=", words[0])):
            words.pop(0)
        if words and os.path.basename(words[0]) in TOOLS:
            yield os.path.basename(words[0]), words[1:]


def check_options(page, text):
    name = os.path.relpath(page, SOURCE)
    plain = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    lines = [line for block in re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S)
             for line in block.replace("\\\n", " ").split("\n")]
    for line in [*lines, *re.findall(r"`([^`\n]+)`", plain)]:
        found = list(commands(line))
        for tool, words in found:
            for option in options_in(words):
                if option not in OPTIONS[tool]:
                    problems.append(f"{name}: {tool} has no {option}: {line.strip()[:80]}")
        if not found and line.startswith("--"):
            for option in options_in(line.split()):
                if not any(option in known for known in OPTIONS.values()) and option not in OTHERS:
                    problems.append(f"{name}: no tool has {option}")


def masked(text):
    for pattern in MASKED:
        text = re.sub(pattern, lambda m: re.sub(r"[\d.]+", "#", m.group(0)), text)
    return [line.rstrip() for line in text.strip().split("\n")]


def run_in_a_folder(script, written=None):
    """What it prints and ends with, in a folder like the repository's; or what it writes."""
    with tempfile.TemporaryDirectory(prefix="stratum_pages_") as folder:
        for part in ("data", "tests"):
            os.symlink(os.path.join(SOURCE, part), os.path.join(folder, part))
        done = subprocess.run(["bash", "-c", "set -e\n" + script], capture_output=True, text=True, cwd=folder, check=False,
                              env={**os.environ, "PATH": BIN + ":" + os.environ["PATH"]})
        if done.returncode != 0:
            sys.exit(f"{script}\nended with {done.returncode}\n{done.stderr}")
        if written is None:
            return done.stdout
        with open(os.path.join(folder, written), encoding="utf-8") as file:
            return file.read()


def differ(name, command, shown, printed):
    if re.search(r"-?\b(nan|inf)\b", printed):
        problems.append(f"{name}: {command.strip()} prints a number that is none")
    if masked(printed) != masked(shown):
        problems.append(f"{name}: {command.strip()}\n--- shown\n{shown}--- printed\n{printed}")


def outputs(page, text):
    """The page with what its commands print now, and how many there are."""
    name, shown = os.path.relpath(page, SOURCE), []

    def block(match):
        *before, last = match.group(2).strip().split("\n")
        printed = run_in_a_folder("\n".join([*before, "echo; echo '# shown'", last])).split("# shown\n", 1)[1].rstrip("\n") + "\n"
        differ(name, match.group(2), match.group(3), printed)
        shown.append(name)
        return f"{match.group(1)}{printed}```"

    def table(match):
        command, file = match.group(2), match.group(3)
        rows = {}
        for title, value in re.findall(r"^\| ([^|]+) \| ([^|]+) \|", run_in_a_folder(command, file), re.M):
            rows.setdefault(title, value)  # further tables have the columns by layer
        printed = "".join(f"| {title} | {rows.get(title, 'is not there')} |\n"
                          for title in re.findall(r"^\| ([^|]+) \|", match.group(4), re.M))
        differ(name, command, match.group(4), printed)
        shown.append(name)
        return match.group(1) + printed

    lines = r"((?:(?!```).*\n)*)"
    text = re.sub(rf"(^```sh\n{lines}```\n\n?```text\n){lines}```", block, text, flags=re.M)
    text = re.sub(r"(^`(gcode2vdb [^`\n]*--report (\S+\.md)[^`\n]*)`[^\n]*\n\n\| number \| value \|\n\|---\|---\|\n)((?:\|.*\n)+)",
                  table, text, flags=re.M)
    return text, len(shown)


shown = 0
for page in PAGES:
    with open(page, encoding="utf-8") as file:
        text = file.read()
    check_options(page, text)
    now, count = outputs(page, text)
    shown += count
    if now != text and "--write" in sys.argv:
        with open(page, "w", encoding="utf-8") as file:
            file.write(now)
for problem in problems:
    print(problem)
print(f"{len(PAGES)} pages, {shown} outputs, {len(problems)} problems")
sys.exit(1 if problems or shown < 4 else 0)

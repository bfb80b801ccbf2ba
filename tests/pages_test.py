"""The pages name what is there: links and their anchors, paths of the repository, counts, versions and code of the examples."""

import glob
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGES = sorted(glob.glob(os.path.join(ROOT, "docs", "**", "*.md"), recursive=True)) + [
    os.path.join(ROOT, name) for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")]
# Files of other projects that the pages name.
OTHERS = {"configfile.py", "toolhead.py", "GCodeProcessor.cpp", "Plater.cpp", "GCode.cpp", "bbs_3mf.cpp", "CreateThumbnail.py",
          "doc/specifications.md", "src/libslic3r/GCode/Thumbnails.hpp"}
WRITTEN = {"hull.md"}  # by commands that the pages show
FOLDERS = ("", "src", "docs", "tests", "python")  # that a path on a page may begin in
CODE = r"(?:cpp|h|py|sh|js|cmake|md|pyi|txt\.in|dict)"

problems = []


def read(*parts):
    with open(os.path.join(ROOT, *parts), encoding="utf-8") as file:
        return file.read()


def tell(page, text):
    problems.append(f"{os.path.relpath(page, ROOT)}: {text}")


def tree():
    """All files of the checkout, without what is built."""
    files = set()
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if f not in (".git", "build", "__pycache__", "out")]
        files.update(os.path.relpath(os.path.join(folder, name), ROOT) for name in names)
    return files


FILES = tree()
NAMES = {os.path.basename(path) for path in FILES}
FOLDERS_THERE = {os.path.dirname(path) for path in FILES}
for path in list(FOLDERS_THERE):
    while path:
        path = os.path.dirname(path)
        FOLDERS_THERE.add(path)


def anchors(text):
    """As GitHub makes them of headings."""
    found, plain = set(), re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for heading in re.findall(r"^#+ +(.*)$", plain, re.M):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        while slug in found:
            slug += "-1"
        found.add(slug)
    return found


def check_links(page, text):
    plain = re.sub(r"^```.*?^```|`[^`\n]*`", "", text, flags=re.M | re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", plain):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        path = path.split("?")[0]
        where = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if not os.path.exists(where):
            tell(page, f"links to {target}, which is not there")
        elif anchor and where.endswith(".md"):
            with open(where, encoding="utf-8") as file:
                if anchor not in anchors(file.read()):
                    tell(page, f"links to {target}: there is no such heading")


def is_there(path, page):
    path = path.rstrip("/")
    if path in FOLDERS_THERE or path in OTHERS or path in WRITTEN:
        return True
    if "*" in path:
        return any(glob.glob(os.path.join(ROOT, folder, path)) for folder in FOLDERS)
    if "/" not in path:
        return path in NAMES
    rooms = [os.path.join("src", room) for room in os.listdir(os.path.join(ROOT, "src"))]
    tests = [os.path.join("tests", room) for room in os.listdir(os.path.join(ROOT, "tests"))]
    begins = [*FOLDERS, *rooms, *tests, os.path.relpath(os.path.dirname(page), ROOT)]
    places = [os.path.normpath(os.path.join(begin, path)) for begin in begins]
    return any(place in FILES or place in FOLDERS_THERE or f"{place}.cpp" in FILES for place in places)


def check_paths(page, text):
    for span in re.findall(r"`([^`\n]+)`", text):
        for word in re.split(r"[\s,;:=\"']+", span):
            word = word.strip("().")
            whole = re.fullmatch(rf"[\w.*/-]+\.{CODE}", word)
            folder = re.fullmatch(r"(?:src|docs|tests|tools|scripts|data|bench|cmake|python|examples)/[\w./*-]*", word)
            if (whole or folder) and not is_there(word, page):
                tell(page, f"names {word}, which is not there")
    # Commands in blocks run scripts and read the project's data.
    for block in re.findall(r"^```(?:sh|text)?\n(.*?)^```", text, re.M | re.S):
        for word in re.findall(r"(?<![\w/.-])((?:scripts|data|bench|tests)/[\w./-]+)", block):
            if not is_there(word, page):
                tell(page, f"a command names {word}, which is not there")


WORDS = ("zero one two three four five six seven eight nine ten eleven twelve").split()


def number(text):
    text = text.lower().replace("\u00a0", "").replace("\u2009", "").replace(" ", "")
    return WORDS.index(text) if text in WORDS else float(text)


def said(page, pattern):
    """The numbers of the one place of a page that says them."""
    places = re.findall(pattern, read(page))
    if len(places) != 1:
        tell(os.path.join(ROOT, page), f"{len(places)} places are like {pattern!r}; this test reads its number in one")
        return None
    return [number(text) for text in ([places[0]] if isinstance(places[0], str) else places[0])]


def check_count(page, pattern, *there):
    told = said(page, pattern)
    if told is not None and told != [float(n) for n in there]:
        tell(os.path.join(ROOT, page), f"says {told}, there are {list(there)}: {pattern}")


def constant(path, pattern):
    found = re.search(pattern, read(path))
    if found is None:
        sys.exit(f"{path}: nothing is like {pattern!r}")
    return eval(found.group(1), {"__builtins__": {}})  # a number of the sources


def check_counts():
    fuzzers = [name for name in os.listdir(os.path.join(ROOT, "tests", "fuzz")) if name.endswith("_fuzz.cpp")]
    told = set(re.findall(r"`(\w+_fuzz)`", read("CONTRIBUTING.md")))
    for name in fuzzers:
        if name[:-4] not in told:
            tell(os.path.join(ROOT, "CONTRIBUTING.md"), f"does not name {name[:-4]}")
    check_count("CONTRIBUTING.md", r"a function of at most (\d+) lines, a folder of at most (\d+) files",
                *(constant("tests/house_test.py", rf"{name} = (\d+)")
                  for name in ("MOST_FUNCTION_LINES", "MOST_FILES")))
    server = "src/serve/server.h"
    check_count("docs/viewer.md", r"messages \((\d+) KB, (\d+) a second",
                constant(server, r"message_bytes = (\d+) << 10"), constant(server, r"messages_per_second = (\d+)"))
    check_count("docs/viewer.md", r"clients \((\d+)\), connections \((\d+)", constant(server, r" clients = (\d+)"),
                constant(server, r" connections = (\d+)"))
    check_count("docs/viewer.md", r"in the size that takes (\d+) ms", 1e3 * constant("src/view/viewport.cpp", r"kFrameSeconds = ([\d.]+)"))


def check_picture_of_rooms():
    """Its rooms and arrows are those of the sources; the numbers of files and lines in it may be older."""
    with tempfile.TemporaryDirectory() as folder:
        now = os.path.join(folder, "rooms.svg")
        subprocess.run([sys.executable, os.path.join(ROOT, "scripts", "rooms.py"), now], check=True, capture_output=True)
        drawn = [set(re.findall(r"<title>(\w+ includes from \w+)", read(path))) for path in (now, "docs/pictures/rooms.svg")]
    if drawn[0] != drawn[1]:
        tell(os.path.join(ROOT, "docs/architecture.md"), f"rooms.svg is old, see {drawn[0] ^ drawn[1]}; run scripts/rooms.py")


def check_examples():
    """The C++ that is shown is compiled: it stands in a file of examples/, line by line."""
    examples = [read("examples", name) for name in os.listdir(os.path.join(ROOT, "examples")) if name.endswith(".cpp")]
    blocks = re.findall(r"^```cpp\n(.*?)^```", read("docs/cpp.md"), re.M | re.S)
    for block in blocks:
        if not any(block in example for example in examples):
            tell(os.path.join(ROOT, "docs/cpp.md"), f"shows code that no example has: {block.splitlines()[0].strip()}")
    if not blocks:
        tell(os.path.join(ROOT, "docs/cpp.md"), "shows no code")


def check_versions():
    version = re.search(r"project\([^)]*VERSION (\d+\.\d+\.\d+)", read("CMakeLists.txt"), re.S).group(1)
    if not re.search(rf"^## {re.escape(version)}$", read("CHANGELOG.md"), re.M):
        tell(os.path.join(ROOT, "CHANGELOG.md"), f"has no heading {version}, the version of CMakeLists.txt")
    for page in PAGES:
        with open(page, encoding="utf-8") as file:
            for name, told in re.findall(r"\b(stratum[\w-]*?)[-_](\d+\.\d+\.\d+)", file.read()):
                if told != version:
                    tell(page, f"names {name}-{told}; the version is {version}")


for page in PAGES:
    with open(page, encoding="utf-8") as file:
        text = file.read()
    check_links(page, text)
    check_paths(page, text)
check_counts()
check_picture_of_rooms()
check_versions()
check_examples()
for problem in sorted(set(problems)):
    print(problem)
print(f"{len(PAGES)} pages, {len(set(problems))} problems")
sys.exit(1 if problems else 0)

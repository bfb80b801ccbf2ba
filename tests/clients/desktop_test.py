"""Installed files for desktops: the viewer's entry, its AppStream metadata, and the MIME types, by their own validators."""

import os
import re
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree

from run_tools import BIN, check, gcode, run, skip_without

BUILD = os.path.dirname(BIN)
FOLDER = tempfile.mkdtemp(prefix="stratum_desktop_")
skip_without(("appstreamcli", "desktop-file-validate", "update-mime-database", "xmllint"))

prefix = os.path.join(FOLDER, "usr")
run("cmake", "--install", BUILD, "--prefix", prefix, "--component", "viewer")
share = os.path.join(prefix, "share")
entry = os.path.join(share, "applications", "org.stratum.vdbview.desktop")
metainfo = os.path.join(share, "metainfo", "org.stratum.vdbview.metainfo.xml")
icon = os.path.join(share, "icons", "hicolor", "scalable", "apps", "org.stratum.vdbview.svg")
types = os.path.join(share, "mime", "packages", "stratum.xml")

done = subprocess.run(["desktop-file-validate", entry], capture_output=True, text=True)
check(done.returncode == 0 and done.stdout + done.stderr == "", f"the desktop entry: {done.stdout}{done.stderr}")
# The project has no page of its own to name.
done = subprocess.run(["appstreamcli", "validate", "--no-net", "--pedantic", metainfo], capture_output=True, text=True)
found = [line for line in done.stdout.splitlines() if line[:2] in ("E:", "W:") and "url-homepage-missing" not in line]
check(not found and (done.returncode == 0 or "url-homepage-missing" in done.stdout), f"the metadata: {done.stdout}{done.stderr}")
run("xmllint", "--noout", metainfo, icon, types)

# The entry names what is installed.
with open(entry, encoding="utf-8") as file:
    keys = dict(line.rstrip("\n").split("=", 1) for line in file if "=" in line)
program = keys["Exec"].split()[0]
check(os.access(os.path.join(prefix, "bin", program), os.X_OK), f"{program} is there")
check("--open" in run(os.path.join(prefix, "bin", program), "--help"), "  and has --open")
check(os.path.exists(icon) and keys["Icon"] == "org.stratum.vdbview", "  the icon, too")
version = run(os.path.join(prefix, "bin", program), "--version").split()[1]
component = xml.etree.ElementTree.parse(metainfo)
check(component.find("releases/release").get("version") == version, f"the metadata is of {version}")
for binary in component.findall("provides/binary"):
    check(os.access(os.path.join(prefix, "bin", binary.text), os.X_OK), f"  it provides {binary.text}")
check(component.find("launchable").text == os.path.basename(entry), "  it names the entry")

# The types, in a database of their own with those of the system.
system = "/usr/share/mime/packages/freedesktop.org.xml"
shutil.copy(system, os.path.dirname(types))
done = subprocess.run(["update-mime-database", "-V", os.path.join(share, "mime")], capture_output=True, text=True)
complaints = [line for line in (done.stdout + done.stderr).splitlines() if re.search("error|warning|invalid", line, re.I)]
check(done.returncode == 0 and not complaints, f"the MIME types: {complaints}")
with open(os.path.join(share, "mime", "globs2"), encoding="utf-8") as file:
    globs = dict(reversed(line.strip().split(":")[1:3]) for line in file if line[0].isdigit())
known = set(keys["MimeType"].strip(";").split(";"))
for pattern in ("*.vdb", "*.bgcode", "*.gcode", "*.gx"):
    check(globs.get(pattern) in known, f"  {pattern} is {globs.get(pattern)}, which the viewer opens")


def magic_of(mime):
    """Offset and bytes of the type's first rule, from the compiled database (shared-mime-info-spec, 'The magic files')."""
    with open(os.path.join(share, "mime", "magic"), "rb") as file:
        data = file.read()
    at = data.index(b":" + mime.encode() + b"]\n") + len(mime) + 3
    offset, value = re.match(rb">(\d+)=", data[at:]).group(1), data[at:].split(b"=", 1)[1]
    length = int.from_bytes(value[:2], "big")
    return int(offset), value[2:2 + length]


vdb = os.path.join(FOLDER, "a.vdb")
run(os.path.join(BIN, "gcode2vdb"), gcode("tile.gcode"), "-o", vdb, "--voxel-size", "1", "--quiet")
with open(vdb, "rb") as file:
    offset, magic = magic_of("application/x-openvdb")
    file.seek(offset)
    check(file.read(len(magic)) == magic, "a .vdb begins as its type says")
check(magic_of("application/x-bgcode") == (0, b"GCDE"), "a .bgcode, too")
shutil.rmtree(FOLDER)

"""Debian packages: what they hold and need; installed and run on a bare Debian of the same release."""

import glob
import os
import shutil
import subprocess
import sys
import tempfile

from run_tools import BIN, check, gcode, run, skip_without

skip_without(("cpack", "dpkg-shlibdeps", "mmdebstrap"))
if os.geteuid() != 0:
    print("skipped: a bare Debian is made by root alone")
    sys.exit(77)

FOLDER = tempfile.mkdtemp(prefix="stratum_packages_")
PACKAGES = os.path.join(FOLDER, "packages")
os.chmod(FOLDER, 0o755)  # apt reads packages as a user of its own

# --- what they hold --------------------------------------------------------------------------------------------------
HOLD = {
    "libstratum-dev": ["./usr/include/stratum/"],
    "python3-stratum": ["./usr/lib/python3/dist-packages/stratum/" + name
                        for name in ("_stratum.cpython-", "__init__.py", "__init__.pyi", "py.typed")],
    "stratum": ["./usr/bin/gcode2vdb", "./usr/share/man/man1/vdbtrace.1.gz", "./usr/share/doc/stratum/copyright",
                "./usr/share/bash-completion/completions/gcode2vdb", "./usr/share/stratum/blender/stratum_import-",
                "./usr/share/stratum/data/brdf/pla-blue.bsdf.gz", "./usr/share/stratum/data/filaments/colors.tsv",
                "./usr/share/stratum/data/filaments/LICENSE"],
    "stratum-viewer": ["./usr/bin/vdbview", "./usr/share/man/man1/vdbview.1.gz", "./usr/share/doc/stratum-viewer/copyright",
                       "./usr/share/applications/org.stratum.vdbview.desktop", "./usr/share/mime/packages/stratum.xml"],
}
NEED = {
    "libstratum-dev": ["libopenvdb-dev"],
    "python3-stratum": ["libopenvdb10.0", "python3 (>= 3.", "python3-numpy", "stratum (= "],
    "stratum": ["libopenvdb10.0", "libtbb12", "libopenexr-3-1-30", "libc6"],
    "stratum-viewer": ["libopenvdb10.0", "libssl3", "stratum (= "],
}
run("cpack", "--config", os.path.join(os.path.dirname(BIN), "CPackConfig.cmake"), "-B", PACKAGES,
    "-D", "CPACK_DEBIAN_COMPRESSION_TYPE=gzip")
debs = sorted(glob.glob(os.path.join(PACKAGES, "*.deb")), key=lambda path: os.path.basename(path).split("_")[0])
names = [os.path.basename(deb).split("_")[0] for deb in debs]
check(names == sorted(HOLD), f"packages: {names}")
for name, deb in zip(names, debs):
    contents = run("dpkg-deb", "-c", deb)
    for path in HOLD[name]:
        check(path in contents, f"{name} has {path}")
    depends = run("dpkg-deb", "-f", deb, "Depends")
    for other in NEED[name]:
        check(other in depends, f"  depends on {other}")
    if name != "libstratum-dev":
        check("-dev" not in depends and "/include/" not in contents, "  and on nothing for developers, and has no headers")
    check(f"./usr/bin/{'vdbview' if name == 'stratum' else 'vdbtrace'}\n" not in contents, "  and no program of another one")

# --- on a bare Debian ------------------------------------------------------------------------------------------------
SCRIPT = """
set -eux
apt-get install -y -q --no-install-recommends /packages/stratum_*.deb /packages/stratum-viewer_*.deb /packages/python3-stratum_*.deb
apt-get install -y -q --simulate /packages/libstratum-dev_*.deb /packages/stratum_*.deb > /dev/null
cd /tmp
for tool in gcode2vdb vdbtrace vdbview vdbmerge vdbstudy; do $tool --version; done
gcode2vdb /packages/part.gcode -o part.vdb --voxel-size 0.2
vdbtrace part.vdb -o part.png --size 64x48 --spp 2 --brdf pla-blue
vdbtrace part.vdb -o named.png --size 64x48 --spp 2 --color "Prusament Galaxy Black"
python3 - <<'END'
import subprocess, urllib.request
import stratum
toolpath = stratum.read("/packages/part.gcode")
assert len(toolpath.beads) > 1000
picture = stratum.render(toolpath, size=(64, 48), spp=1, voxel_size=0.2)
assert picture.srgb.shape == (48, 64, 3) and picture.srgb.std() > 5
viewer = subprocess.Popen(["vdbview", "/packages/part.gcode", "--quiet"], stdout=subprocess.PIPE, text=True)
page = urllib.request.urlopen(viewer.stdout.readline().strip(), timeout=30).read()
viewer.terminate()
assert b"<html" in page.lower(), page[:200]
END
test -s part.png
echo all of it ran on $(cat /etc/debian_version)
"""
shutil.copy(gcode("tile.gcode"), os.path.join(PACKAGES, "part.gcode"))
with open(os.path.join(PACKAGES, "try.sh"), "w", encoding="utf-8") as file:
    file.write(SCRIPT)
for leftover in glob.glob(os.path.join(PACKAGES, "_CPack_Packages")):
    shutil.rmtree(leftover)
with open("/etc/os-release", encoding="utf-8") as file:
    release = next(line.split("=")[1].strip().strip('"') for line in file if line.startswith("VERSION_CODENAME="))
sources = "/etc/apt/sources.list.d/debian.sources"
bare = ["mmdebstrap", "--variant=minbase", "--mode=root", "--format=null", f"--customize-hook=copy-in {PACKAGES} /",
        '--customize-hook=chroot "$1" sh /packages/try.sh >&2', release, "-", *([sources] if os.path.exists(sources) else [])]
done = subprocess.run(bare, capture_output=True, text=True, timeout=1200)
if done.returncode != 0 and "try.sh" not in done.stderr:
    print(f"skipped: no bare Debian can be made here: {done.stderr.strip().splitlines()[-1]}")
    sys.exit(77)
check(done.returncode == 0 and "all of it ran on" in done.stderr, f"on a bare Debian: {done.stderr[-4000:]}")
shutil.rmtree(FOLDER)

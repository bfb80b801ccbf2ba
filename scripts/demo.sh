#!/usr/bin/env bash
# From a bare Debian 12 to a picture: installs what the main job needs, builds the two tools, and turns a sliced file
# into a level set and the level set into a picture. Running it again is quick.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}"
cmake --preset demo $(compiler_choice) >/dev/null
cmake --build --preset demo
mkdir -p out
build/release/bin/gcode2vdb data/gcode/hull.gcode -o out/hull.vdb --features -skirt,-brim
build/release/bin/vdbtrace out/hull.vdb -o out/hull.png
echo
echo "The level set: $PWD/out/hull.vdb   (File > Import > OpenVDB in Blender, or the File node in Houdini)"
echo "The picture:   $PWD/out/hull.png"

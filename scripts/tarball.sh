#!/usr/bin/env bash
# Makes build/bundle/stratum-VERSION-Linux-ARCHITECTURE.tar.gz: the tools, the Blender add-on and the tables of materials, with
# the libraries that they need, for any Linux whose glibc is at least as new as this machine's (2.36 on Debian 12).
# Unpack it anywhere; bin/ has the programs.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}"
cmake --preset demo -B build/bundle -DSTRATUM_BUNDLE=ON -DSTRATUM_PYTHON=OFF $(compiler_choice) >/dev/null
cmake --build build/bundle
rm -f build/bundle/stratum-*.tar.gz
(cd build/bundle && cpack -B "$PWD" >/dev/null && rm -rf _CPack_Packages)
ls -l build/bundle/stratum-*.tar.gz

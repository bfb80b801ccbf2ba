#!/usr/bin/env bash
# Installs what the tests need, builds everything and runs all tests; the last lines are the counts.
# Arguments go to ctest, e.g. scripts/test.sh -R Voxelizer
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}"
install_packages --available "${TEST_PACKAGES[@]}"
cmake --preset release $(compiler_choice) >/dev/null
cmake --build --preset release
ctest --test-dir build/release --output-on-failure -j"$(nproc)" "$@"
python3 scripts/test_counts.py build/release

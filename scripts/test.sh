#!/usr/bin/env bash
# Installs what the tests need, builds everything and runs all tests; the last lines are the counts. With --changed suites
# of which nothing changed since scripts/checked_commit are left out. Other arguments go to ctest, e.g. -R Voxelizer
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}"
install_packages --available "${TEST_PACKAGES[@]}"
cmake --preset release $(compiler_choice) >/dev/null
cmake --build --preset release
leave_out=""
if [[ "${1:-}" == --changed ]]; then
    shift
    leave_out=$(python3 scripts/unchanged_suites.py)
fi
ctest --test-dir build/release --output-on-failure -j"$(nproc)" ${leave_out:+-E "$leave_out"} "$@"
python3 scripts/test_counts.py build/release

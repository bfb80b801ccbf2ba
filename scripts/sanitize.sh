#!/usr/bin/env bash
# The tests under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer where threads meet.
# With --changed suites of which nothing changed since scripts/checked_commit are left out.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}" libgtest-dev python3 libclang-rt-dev llvm
# Freed blocks are kept for a while by the allocator; with large grids that alone would fill the memory.
export ASAN_OPTIONS=quarantine_size_mb=64 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
leave_out=""
if [[ "${1:-}" == --changed ]]; then
    if [[ -z "$(python3 scripts/unchanged_suites.py --rooms)" ]]; then
        echo "Nothing of a room changed since $(cat scripts/checked_commit): nothing to run under sanitizers"
        exit
    fi
    leave_out=$(python3 scripts/unchanged_suites.py)
fi
for sanitizer in asan tsan; do
    cmake --preset "$sanitizer" >/dev/null
    cmake --build --preset "$sanitizer"
    ctest --test-dir "build/$sanitizer" --output-on-failure -j"$(nproc)" -LE "client|slow|study" ${leave_out:+-E "$leave_out"}
    python3 scripts/test_counts.py "build/$sanitizer"
done

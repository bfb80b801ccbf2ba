#!/usr/bin/env bash
# The tests under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer where threads meet.
# With --changed suites of which nothing changed since scripts/checked_commit are left out.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}" libgtest-dev python3 libclang-rt-dev llvm
# Freed blocks are kept for a while by the allocator; with large grids that alone would fill the memory.
export ASAN_OPTIONS=quarantine_size_mb=64 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
programs=""
if [[ "${1:-}" == --changed ]]; then
    programs=$(python3 scripts/unchanged_suites.py --programs)
    if [[ "$programs" == none ]]; then
        echo "Nothing of a room changed since $(cat scripts/checked_commit): nothing to run under sanitizers"
        exit
    fi
    echo "Test programs under sanitizers, of what changed since $(cat scripts/checked_commit): $programs"
fi
for sanitizer in asan tsan; do
    cmake --preset "$sanitizer" -DSTRATUM_TEST_PROGRAMS="$programs" >/dev/null
    cmake --build --preset "$sanitizer"
    ctest --test-dir "build/$sanitizer" --output-on-failure -j"$(nproc)" -LE "client|slow|study"
    python3 scripts/test_counts.py "build/$sanitizer"
done

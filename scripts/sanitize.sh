#!/usr/bin/env bash
# The tests under AddressSanitizer with UndefinedBehaviorSanitizer, and under ThreadSanitizer where threads meet.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

# Clang compiles these templates in 0.6 of the time, and its UndefinedBehaviorSanitizer knows more.
install_packages "${BUILD_PACKAGES[@]}" libgtest-dev python3 clang libclang-rt-dev llvm
cmake --preset asan >/dev/null
cmake --build --preset asan
# Freed blocks are kept for a while by the allocator; with large grids that alone would fill the memory.
ASAN_OPTIONS=quarantine_size_mb=64 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0 ctest --test-dir build/asan --output-on-failure -j"$(nproc)" -LE "client|slow|study"
cmake --preset tsan >/dev/null
cmake --build --preset tsan --target test_voxelize test_shade test_march test_ondemand
# Brute force over all beads takes minutes here and shares nothing between threads that other tests do not.
ctest --test-dir build/tsan --output-on-failure -j1 -R "Voxelizer|Exterior|Render|BrickGrid|PrintField|PrintAttribute|Detail" -E "AgreesWithBruteForce" -LE "client|slow|study"

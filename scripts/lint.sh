#!/usr/bin/env bash
# Formatting and static analysis of everything tracked; changes nothing.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}" libgtest-dev python3 clang-format clang-tidy
mapfile -t sources < <(git ls-files '*.cpp' '*.h')
clang-format --dry-run --Werror "${sources[@]}"
echo "clang-format: ${#sources[@]} files are formatted"
cmake --preset release >/dev/null
# The tests are left to the compiler's warnings: GoogleTest's macros are not written for these checks.
mapfile -t units < <(git ls-files 'src/*.cpp' 'tools/*.cpp')
printf '%s\n' "${units[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy -p build/release --quiet 2>/dev/null
echo "clang-tidy: ${#units[@]} files are clean"

#!/usr/bin/env bash
# Formatting of everything tracked, and static analysis of what changed since scripts/checked_commit; --all: of every unit.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

install_packages "${BUILD_PACKAGES[@]}" git python3 clang-format clang-tidy
mapfile -t sources < <(git ls-files '*.cpp' '*.h')
printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 40 clang-format --dry-run --Werror
echo "clang-format: ${#sources[@]} files are formatted"
# Without precompiled headers: a unit that forgot an include is found here. The tests are left to the compiler's warnings:
# GoogleTest's macros are not written for these checks.
cmake -S . -B build/lint -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DSTRATUM_TESTS=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
base=$(cat scripts/checked_commit)
[[ "${1:-}" == --all ]] && base=none
mapfile -t units < <(python3 scripts/changed_units.py "$base")
[[ -z "${units[0]:-}" ]] && units=()
if [[ ${#units[@]} -gt 0 ]]; then printf '%s\n' "${units[@]}" | python3 scripts/tidy.py build/lint; fi
echo "clang-tidy: ${#units[@]} files are clean"

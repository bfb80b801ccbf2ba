#!/usr/bin/env bash
# Builds all fuzz targets (clang, AddressSanitizer, UndefinedBehaviorSanitizer) and runs each for some seconds, half of them
# with inputs of up to 1 MB; an input may take 10 s. Findings stay in build/fuzz/findings.
#   scripts/fuzz.sh [SECONDS] [TARGET...]        60 seconds each; targets as in tests/fuzz, without _fuzz
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

seconds=${1:-60}
shift || true
install_packages "${BUILD_PACKAGES[@]}" libgtest-dev libclang-rt-dev llvm
targets=("$@")
[[ ${#targets[@]} -gt 0 ]] || mapfile -t targets < <(basename -s _fuzz.cpp tests/fuzz/*_fuzz.cpp)
cmake --preset release -B build/fuzz -DSTRATUM_FUZZ=ON -DSTRATUM_TESTS=OFF -DSTRATUM_SANITIZE=address,undefined \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1" >/dev/null
cmake --build build/fuzz --target "${targets[@]/%/_fuzz}"
mkdir -p build/fuzz/findings
export ASAN_OPTIONS=quarantine_size_mb=64
run() {
    local target=$1 length=$2 kept=build/fuzz/inputs/$1 dictionary=() log=build/fuzz/$1_$2.log
    mkdir -p "$kept"
    [[ ! -e tests/fuzz/$target.dict ]] || dictionary=("-dict=tests/fuzz/$target.dict")
    if ! "build/fuzz/bin/${target}_fuzz" "${dictionary[@]}" -max_total_time=$((seconds / 2)) -max_len="$length" -timeout=10 \
        -rss_limit_mb=4096 -len_control=0 -artifact_prefix="build/fuzz/findings/${target}_" -print_final_stats=1 "$kept" \
        "tests/fuzz/$target" 2>"$log"; then
        tail -n 30 "$log" >&2
        echo "$target, inputs of up to $length bytes: a finding, in build/fuzz/findings" >&2
        return 1
    fi
    echo "$target, inputs of up to $length bytes: $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") inputs, nothing found"
}
failed=0
for target in "${targets[@]}"; do
    run "$target" 4096 || failed=1
    run "$target" 1000000 || failed=1
done
exit $failed

#!/usr/bin/env bash
# All studies, into a folder (default docs/studies). --quick is a look at each, for continuous integration; more prints
# for the studies of memory and of beads beside level sets may follow, or folders of them for the latter alone:
# scripts/study.sh [--quick] [FOLDER [PRINT.gcode|FOLDER...]]
# Peers (Embree) take part where bench_vdbstudy is built (-DSTRATUM_BENCH=ON), light is that of $STRATUM_ENV if that names
# a map; $STRATUM_POLYGONS may hold more options of that study, such as "--spp 4 --frames 3 --threads 1". The tables of
# README.md are written anew when the studies go to docs/studies.
set -euo pipefail
cd "$(dirname "$0")/.."
quick=()
if [[ "${1:-}" == --quick ]]; then
    quick=(--quick)
    shift
fi
folder=${1:-docs/studies}
[[ $# -gt 0 ]] && shift
bin=${STRATUM_BIN:-build/release/bin}
study=$bin/vdbstudy
polygons=$study
[[ -x $bin/bench_vdbstudy ]] && polygons=$bin/bench_vdbstudy
print=data/gcode/hull.gcode
points=20000
if [[ ${#quick[@]} -gt 0 ]]; then
    print=data/gcode/tile.gcode
    points=4000
fi
files=()
for given in "$@"; do [[ -f $given ]] && files+=("$given"); done
"$study" memory "$print" "${files[@]}" -o "$folder" "${quick[@]}"
"$study" geometry "$print" --layers 1:20 --points "$points" -o "$folder" "${quick[@]}"
"$study" render "$print" -o "$folder" "${quick[@]}"
"$study" stability -o "$folder" "${quick[@]}"
# What capabilities cost while they are off: skipped, and said so, where there is no valgrind.
python3 scripts/need_off.py "$bin" "$print" "$folder/need_off.csv"
"$study" need "$print" -o "$folder" "${quick[@]}"
# shellcheck disable=SC2086  # options, word by word
"$polygons" polygons "${@:-$print}" --scenes data/scenes/roukema_*.json ${STRATUM_ENV:+--env "$STRATUM_ENV"} ${STRATUM_POLYGONS:-} -o "$folder" "${quick[@]}"
if [[ $folder == docs/studies ]]; then python3 scripts/readme_tables.py docs/studies README.md; fi

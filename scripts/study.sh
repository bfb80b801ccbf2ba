#!/usr/bin/env bash
# All studies, into a folder (default docs/studies). --quick is a look at each, for continuous integration; more prints
# for the memory study may follow: scripts/study.sh [--quick] [FOLDER [PRINT.gcode...]]
set -euo pipefail
cd "$(dirname "$0")/.."
quick=()
if [[ "${1:-}" == --quick ]]; then
    quick=(--quick)
    shift
fi
folder=${1:-docs/studies}
[[ $# -gt 0 ]] && shift
study=${STRATUM_BIN:-build/release/bin}/vdbstudy
print=data/gcode/hull.gcode
points=20000
if [[ ${#quick[@]} -gt 0 ]]; then
    print=data/gcode/tile.gcode
    points=4000
fi
"$study" memory "$print" "$@" -o "$folder" "${quick[@]}"
"$study" geometry "$print" --layers 1:20 --points "$points" -o "$folder" "${quick[@]}"
"$study" stability -o "$folder" "${quick[@]}"
"$study" need "$print" -o "$folder" "${quick[@]}"

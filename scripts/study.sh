#!/usr/bin/env bash
# All studies, into a folder (default docs/studies), whose tables and pages they replace. --quick is a look at each, for
# continuous integration. More prints for the studies of memory, of what the plastic does and of beads beside level sets may
# follow, or folders of them for the latter alone:
# scripts/study.sh [--quick] [FOLDER [PRINT.gcode|FOLDER...]]
# Peers (Embree) take part where bench_vdbstudy is built (-DSTRATUM_BENCH=ON), light is that of $STRATUM_ENV if that names
# a map; $STRATUM_POLYGONS may hold more options of that study, such as "--spp 4 --frames 3". Files whose stated times are
# compared, besides the prints, are those of data/gcode and $STRATUM_TIMES. The ten lines of FOLDER/README.md are written
# anew, and the tables of README.md when the studies go to docs/studies.
set -euo pipefail
cd "$(dirname "$0")/.."
quick=()
while [[ "${1:-}" == --* ]]; do
    case $1 in
        --quick) quick=(--quick) ;;
        *) echo "study.sh: $1 is no option; --quick is" >&2; exit 2 ;;
    esac
    shift
done
folder=${1:-docs/studies}
[[ $# -gt 0 ]] && shift
bin=${STRATUM_BIN:-build/release/bin}
study=$bin/vdbstudy
polygons=$study
[[ -x $bin/bench_vdbstudy ]] && polygons=$bin/bench_vdbstudy
print=data/gcode/hull.gcode
points=20000
times=(data/gcode/*.gcode)
if [[ ${#quick[@]} -gt 0 ]]; then
    print=data/gcode/tile.gcode
    points=4000
    times=(data/gcode/bridges_cura.gcode data/gcode/vase.gcode)
fi
# shellcheck disable=SC2206  # names, word by word
times+=(${STRATUM_TIMES:-})
files=()
for given in "$@"; do [[ -f $given && $given != *.json ]] && files+=("$given"); done
mkdir -p "$folder"
options=(-o "$folder" "${quick[@]}" --force)
"$study" memory "$print" "${files[@]}" "${options[@]}"
"$study" geometry "$print" --layers 1:20 --points "$points" "${options[@]}"
"$study" render "$print" "${options[@]}"
"$study" stability "${options[@]}"
"$study" deposit "$print" "${files[@]}" --times "${times[@]}" "${options[@]}"
# What capabilities cost while they are off: skipped, and said so, where there is no valgrind.
python3 scripts/need_off.py "$bin" "$print" "$folder/need_off.csv"
"$study" need "$print" "${options[@]}"
compare() {  # FOLDER [OPTION...]
    local into=$1
    shift
    # shellcheck disable=SC2086  # options, word by word
    "$polygons" polygons "${prints[@]}" "$@" ${STRATUM_ENV:+--env "$STRATUM_ENV"} ${STRATUM_POLYGONS:-} -o "$into" "${quick[@]}" --force
}
prints=("${@:-$print}")
compare "$folder" --scenes data/scenes/roukema_*.json
[[ ${#quick[@]} -eq 0 ]] && compare "$folder/one_thread" --threads 1
python3 scripts/studies_page.py "$folder"
if [[ $folder == docs/studies ]]; then python3 scripts/readme_tables.py docs/studies README.md; fi

#!/usr/bin/env bash
# slice_limits.sh FOLDER -- twelve prints by PrusaSlicer, each for a machine of other limits, for print_times.py.
#
# Models are those of the corpus ($STRATUM_CORPUS, or ../shared/corpus beside the project); needs prusa-slicer.
set -euo pipefail

[ $# -eq 1 ] || { echo "usage: slice_limits.sh FOLDER" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
models=${STRATUM_CORPUS:-$root/../shared/corpus}/models
mkdir -p "$1"
cd "$1"

slice() {
    local name=$1 model=$2; shift 2
    prusa-slicer --datadir profile --load "$root/data/prusa.ini" --center 100,100 --remaining-times \
        --machine-limits-usage emit_to_gcode "$@" --export-gcode -o "$name.gcode" "$models/$model.stl" >"$name.log" 2>&1
}

slice a_default  turned_example007
slice b_weak     gearwheel --machine-max-acceleration-x 500 --machine-max-acceleration-y 400 \
    --machine-max-acceleration-extruding 300 --machine-max-acceleration-travel 600
slice c_low_jerk CSG --machine-max-jerk-x 1 --machine-max-jerk-y 1 --machine-max-jerk-z 0.1 --machine-max-jerk-e 1
slice d_high_jerk CSG --machine-max-jerk-x 30 --machine-max-jerk-y 25 --machine-max-jerk-e 10
slice e_slow_axes turned_example007 --machine-max-feedrate-x 40 --machine-max-feedrate-y 60 \
    --machine-max-feedrate-z 3 --machine-max-feedrate-e 20
slice f_fast     gearwheel --machine-max-acceleration-x 20000 --machine-max-acceleration-y 20000 \
    --machine-max-acceleration-extruding 20000 \
    --machine-max-acceleration-travel 20000 --machine-max-feedrate-x 500 --travel-speed 400 --perimeter-speed 200 \
    --infill-speed 300 --external-perimeter-speed 150
slice g_legacy   turned_example007 --gcode-flavor marlin --machine-max-acceleration-extruding 800 \
    --machine-max-acceleration-travel 3000
slice h_by_feature CSG --default-acceleration 1000 --perimeter-acceleration 300 --infill-acceleration 2000 \
    --first-layer-acceleration 200 --bridge-acceleration 500
slice i_reprap   gearwheel --gcode-flavor reprapfirmware --machine-max-acceleration-extruding 2500
slice j_slow_e   turned_example007 --machine-max-acceleration-e 300 --machine-max-jerk-e 0.5 \
    --machine-max-acceleration-retracting 400
slice k_vase     fox --spiral-vase --perimeters 1 --top-solid-layers 0 --fill-density 0 \
    --machine-max-acceleration-extruding 700
slice l_no_lift  bob_small --retract-lift 0 --machine-max-jerk-x 5 --machine-max-jerk-y 5

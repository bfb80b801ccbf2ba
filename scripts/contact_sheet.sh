#!/usr/bin/env bash
# Pictures of forty real prints on one sheet: many slicers, colours, sizes, and ten white, black or clear ones. Each is
# "vdbtrace FILE" without an option but its plastic (one is half printed). Files of the corpus that are not there are left out and named.
# scripts/contact_sheet.sh SHEET.jpg [FOLDER for the single pictures, 1280 x 960; those that are there are kept]
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh
install_packages imagemagick fonts-dejavu-core
sheet=${1:?which file to write}
folder=${2:-$(mktemp -d)}
mkdir -p "$folder"
bin=${STRATUM_BIN:-build/release/bin}
corpus=${STRATUM_CORPUS:-../shared/corpus}/gcode
tiles=()
# picture LABEL FILE [OPTION...]
picture() {
    local label=$1 file=$2
    shift 2
    if [[ ! -f "$file" ]]; then
        echo "not there: $file"
        return
    fi
    local name
    name=$(printf '%s/%02d.png' "$folder" "$((${#tiles[@]} / 3))")
    [[ -f "$name" ]] || "$bin/vdbtrace" "$file" "$@" -o "$name"
    tiles+=(-label "$label" "$name")
}
picture "PrusaSlicer, defaults" data/gcode/hull.gcode
picture "FlashStudio, two colours" "$corpus/slicer-meta-flashstudio_2color.gcode.3mf"
picture "OrcaSlicer, one of two colours" "$corpus/slicer-meta-orca_twocolors.gcode.3mf"
picture "Orca-Flashforge" "$corpus/slicer-meta-orca_flashforge.gcode.3mf"
picture "BambuStudio" "$corpus/slicercompare-bambu_plate_1.gcode"
picture "PrusaSlicer, two tools, tower" data/gcode/two_tone_mmu.gcode
picture "Cura, four tools" "$corpus/filaswitch-mc_testmodel1_Cura.gcode"
picture "Simplify3D, four tools" "$corpus/filaswitch-mc_testmodel1_S3D.gcode"
picture "PrusaSlicer, .bgcode" "$corpus/libbgcode-mini_cube_b.bgcode"
picture "Slic3r" "$corpus/gcode-preview-benchy_slic3r.gcode"
picture "Slic3r, half printed" "$corpus/gcode-preview-benchy_slic3r.gcode" --printed 50%
picture "Pathio" "$corpus/RepRapFirmware-SD-benchy_pathio.gcode"
picture "FullControl, non-planar vase" "$corpus/gcode-preview-ripple_vase.gcode"
picture "PrusaSlicer, spiral vase, tall" "$corpus/vase_ps25.gcode"
picture "Cura" "$corpus/preprocess_cancellation-cura.gcode"
picture "ideaMaker" "$corpus/preprocess_cancellation-ideamaker.gcode"
picture "PrusaSlicer, supports" data/gcode/knot.gcode
picture "FlashPrint, .gx" "$corpus/slicer-meta-FlashPrint.gx"
picture "PrusaSlicer, 1000 cm3" "$corpus/spot_1000cc_0.1mm_grid.gcode.gz"
picture "by hand, one square" "$corpus/gcode-preview-square.gcode"
picture "Anycubic Slicer, many colours" "$corpus/AnycubicSlicerImageIntractor-multicolor.gcode.gz"
picture "PrusaSlicer, XL" "$corpus/ChestnutLabs-prim_cube_xl.bgcode"
picture "a Creality K1C's own file" "$corpus/K1_Series_Klipper-K1C_3DBenchy.gcode.gz"
picture "Cura 15" "$corpus/OctoPrint-bp_case_cura15.gcode.gz"
picture "PrusaSlicer 2.2, without tags" "$corpus/RRFInstall-cube_huelle.gcode.gz"
picture "KISSlicer" "$corpus/demestav-thinbox_kisslicer.gcode.gz"
picture "PrusaSlicer, MMU2" "$corpus/gcode-metadata-mk3s_mmu2s.gcode.gz"
picture "Cura, two extruders" "$corpus/gcode_metadata-cura_2ext.ufp"
picture "Kiri:Moto" "$corpus/preprocess_cancellation-kirimoto.gcode"
picture "PrusaSlicer, a gear wheel" data/gcode/gear.gcode
picture "white" data/gcode/knot.gcode --color white
picture "white, Cura" "$corpus/bgautrea-ender3_cura.gcode.gz" --color white
picture "white, Slic3r" "$corpus/slic3r_vol.gcode" --color white
picture "black" data/gcode/hull.gcode --color black
picture "black, a plate" "$corpus/preprocess_cancellation-superslicer.gcode" --color black
picture "Prusament Galaxy Black" data/gcode/gear.gcode --color "Prusament Galaxy Black"
picture "silver" "$corpus/RepRapFirmware-SD-benchy_pathio.gcode" --color silver
picture "clear PETG" data/gcode/hull.gcode --brdf clear-petg
picture "natural PLA" data/gcode/vase.gcode --brdf natural-pla
picture "white lithophane PLA" data/gcode/gear.gcode --brdf lithophane-white
montage "${tiles[@]}" -tile 5x -geometry 400x300+6+4 -font DejaVu-Sans -pointsize 15 -quality 88 -background white "$sheet"

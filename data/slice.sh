#!/usr/bin/env bash
# slice.sh -- make every file in data/gcode again from the models in data/models.
#
#   bash data/slice.sh               all of them
#   bash data/slice.sh hull vase     only these
#   bash data/slice.sh --list        their names
#
# Needs openscad, prusa-slicer, CuraEngine and, for CuraEngine, the file
# fdmprinter.def.json out of the package "cura" (see find_cura_definitions).
# Every command that it runs is printed first.
set -euo pipefail

data=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
mkdir -p "$data/gcode" "$tmp/prusa"

die()  { printf 'slice.sh: %s\n' "$*" >&2; exit 1; }
need() { command -v "$1" >/dev/null 2>&1 || die "$1 is missing. On Debian: apt-get install $2"; }

# run COMMAND...: show it, run it in the temporary folder, keep its chatter for a failure
run() {
    printf '+'; printf ' %q' "$@"; printf '\n'
    (cd "$tmp" && "$@") >"$tmp/log" 2>&1 || { cat "$tmp/log" >&2; die "failed: $1"; }
}

# What OpenSCAD and PrusaSlicer write depends a little on the addresses of their memory
# and on the order in which their threads end. With both held still, the same input
# gives the same file, but for the date in its first line.
still=()
if setarch -R taskset -c 0 true 2>/dev/null; then still=(setarch -R taskset -c 0); fi

# stl NAME: models/NAME.scad -> NAME.stl in the temporary folder, once
stl() {
    need openscad openscad
    [ -s "$tmp/$1.stl" ] || run "${still[@]}" openscad -q -o "$1.stl" "$data/models/$1.scad"
}

# prusa OUT MODEL [OPTION...]: slice MODEL with prusa.ini and the options
prusa() {
    need prusa-slicer prusa-slicer
    local out=$1 model=$2; shift 2
    run "${still[@]}" prusa-slicer --datadir "$tmp/prusa" --load "$data/prusa.ini" "$@" \
        --center 100,100 --export-gcode --output "$out" "$model"
    cp "$tmp/$out" "$data/gcode/$out"
}

# fdmprinter.def.json is the list of CuraEngine's settings. It comes with Cura; when
# Cura is not installed its package is fetched and unpacked, but not installed.
# Set CURA_DEFINITIONS to use a folder of your own.
find_cura_definitions() {
    local d
    for d in "${CURA_DEFINITIONS:-}" /usr/share/cura/resources/definitions "$tmp/cura/usr/share/cura/resources/definitions"; do
        if [ -n "$d" ] && [ -f "$d/fdmprinter.def.json" ]; then definitions=$d; return; fi
    done
    { command -v apt-get && command -v dpkg-deb; } >/dev/null 2>&1 ||
        die "fdmprinter.def.json is missing. Install Cura, or set CURA_DEFINITIONS to the folder that has it"
    mkdir -p "$tmp/cura"
    run apt-get download cura
    run dpkg-deb -x "$(echo "$tmp"/cura_*.deb)" "$tmp/cura"
    definitions=$tmp/cura/usr/share/cura/resources/definitions
    [ -f "$definitions/fdmprinter.def.json" ] || die "the package cura holds no fdmprinter.def.json"
}

# cura OUT MODEL [-s key=value...]: slice MODEL with cura.settings and the options.
# The filament's diameter is given to the extruder too (-e0), which has its own.
cura() {
    need CuraEngine cura-engine
    find_cura_definitions
    local out=$1 model=$2 line settings=(); shift 2
    while IFS= read -r line; do
        case $line in ''|'#'*) ;; *) settings+=(-s "$(printf '%b' "$line")") ;; esac
    done <"$data/cura.settings"
    printf '+ CuraEngine slice -v -j fdmprinter.def.json <cura.settings>%s -e0 -s material_diameter=1.75 -o %s -l %s\n' \
        "${*:+ $*}" "$out" "$model"
    (cd "$tmp" && CuraEngine slice -v -j "$definitions/fdmprinter.def.json" "${settings[@]}" "$@" \
        -e0 -s material_diameter=1.75 -o "$out" -l "$model") >"$tmp/log" 2>&1 ||
        { grep -v '^\[WARNING\]' "$tmp/log" >&2; die "failed: CuraEngine"; }
    cp "$tmp/$out" "$data/gcode/$out"
}

# amf OUT A.stl B.stl: one object of two volumes, the first for extruder 1, the second
# for extruder 2, in the coordinates that the two share
amf() {
    printf '+ write %s: volumes %s (extruder 1) and %s (extruder 2)\n' "$1" "$2" "$3"
    (cd "$tmp" && awk '
        FNR == 1 { part++ }
        $1 == "vertex" {
            k = $2 " " $3 " " $4
            if (!((part, k) in id)) { id[part, k] = n + 0; v[n++] = k }
            c = c % 3 + 1
            t[part] = t[part] (c == 1 ? "<triangle>" : "") "<v" c ">" id[part, k] "</v" c ">" (c == 3 ? "</triangle>\n" : "")
        }
        END {
            print "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<amf unit=\"millimeter\">\n<object id=\"0\"><mesh><vertices>"
            for (i = 0; i < n; i++) { split(v[i], p, " ")
                print "<vertex><coordinates><x>" p[1] "</x><y>" p[2] "</y><z>" p[3] "</z></coordinates></vertex>" }
            print "</vertices>"
            for (i = 1; i <= part; i++)
                print "<volume><metadata type=\"slic3r.extruder\">" i "</metadata>\n" t[i] "</volume>"
            print "</mesh></object>\n</amf>"
        }' "$2" "$3" >"$1")
}

# --- the files, one function each ---------------------------------------------

hull()     { stl hull;    prusa hull.gcode hull.stl; }
vase()     { stl vase;    prusa vase.gcode vase.stl --spiral-vase --layer-height 0.3 --first-layer-height 0.3 \
                 --perimeters 1 --top-solid-layers 0 --bottom-solid-layers 3 --fill-density 0 \
                 --external-perimeter-extrusion-width 0.5; }
gear()     { stl gear;    prusa gear.gcode gear.stl --layer-height 0.3 --first-layer-height 0.3 --perimeter-generator classic \
                 --fill-pattern rectilinear --fill-density 15% --top-solid-layers 3 --bottom-solid-layers 2 \
                 --skirts 2 --skirt-distance 8 --brim-type outer_only --brim-width 4 --gcode-resolution 0.08; }
knot()     { stl knot;    prusa knot.gcode knot.stl --layer-height 0.3 --first-layer-height 0.3 --perimeter-generator classic \
                 --fill-density 10% --top-solid-layers 3 --bottom-solid-layers 2 --retract-lift 0 \
                 --support-material --support-material-style snug --support-material-threshold 35 --support-material-spacing 3.5 \
                 --support-material-interface-layers 1 --support-material-interface-spacing 2 \
                 --brim-type outer_only --brim-width 3 --gcode-resolution 0.08; }
bridges()  { stl bridges; prusa bridges.gcode bridges.stl --layer-height 0.3 --first-layer-height 0.3 \
                 --perimeter-generator classic --retract-lift 0; }

two_tone()     { two_tone_amf; prusa two_tone.gcode two_tone.amf --load "$data/two_tools.ini" \
                     --layer-height 0.3 --first-layer-height 0.3 --perimeter-generator classic; }
two_tone_mmu() { two_tone_amf; prusa two_tone_mmu.gcode two_tone.amf --load "$data/two_tools.ini" --load "$data/mmu.ini" \
                     --layer-height 0.3 --first-layer-height 0.3 --perimeter-generator classic; }
two_tone_amf() { stl two_tone_a; stl two_tone_b; amf two_tone.amf two_tone_a.stl two_tone_b.stl; }

tile()            { stl tile; prusa tile.gcode tile.stl --perimeter-generator classic; }
tile_absolute()   { stl tile; prusa tile_absolute.gcode tile.stl --perimeter-generator classic --use-relative-e-distances=0 --layer-gcode ';[layer_z]'; }
tile_fwretract()  { stl tile; prusa tile_fwretract.gcode tile.stl --perimeter-generator classic --use-firmware-retraction; }
tile_volumetric() { stl tile; prusa tile_volumetric.gcode tile.stl --perimeter-generator classic --load "$data/volumetric.ini"; }

# Debian's slicers write no arcs.
tile_arcs()       { need python3 python3; [ -s "$data/gcode/tile.gcode" ] || tile
                    run python3 "$data/weld_arcs.py" "$data/gcode/tile.gcode" "$data/gcode/tile_arcs.gcode" 0.05; }

hull_cura()    { stl hull;    cura hull_cura.gcode hull.stl -s layer_height=0.3 -s layer_height_0=0.3 \
                     -s infill_sparse_thickness=0.3 -s retraction_combing=off; }
bridges_cura() { stl bridges; cura bridges_cura.gcode bridges.stl -s layer_height=0.3 -s layer_height_0=0.3 \
                     -s infill_sparse_thickness=0.3 -s relative_extrusion=true -s retraction_combing=off; }
tile_cura()    { stl tile;    cura tile_cura.gcode tile.stl; }

all=(hull vase gear knot bridges two_tone two_tone_mmu
     tile tile_absolute tile_fwretract tile_volumetric tile_arcs hull_cura bridges_cura tile_cura)

if [ "${1:-}" = --list ]; then printf '%s\n' "${all[@]}"; exit 0; fi
[ $# -gt 0 ] || set -- "${all[@]}"
for name in "$@"; do
    case " ${all[*]} " in *" $name "*) ;; *) die "no such file: $name. There are: ${all[*]}" ;; esac
    "$name"
    printf '  = data/gcode/%s.gcode, %s bytes\n' "$name" "$(wc -c <"$data/gcode/$name.gcode")"
done

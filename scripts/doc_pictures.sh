#!/usr/bin/env bash
# The pictures of README.md, docs/gallery.md, docs/shading.md, docs/colors.md, docs/films.md and docs/thumbnails.md, made anew with the tools of this tree. Those of files
# of the corpus are left as they are where it is not there. Minutes.
# scripts/doc_pictures.sh [NAME...]   only these, e.g. gallery_gear
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh
install_packages imagemagick
bin=${STRATUM_BIN:-build/release/bin}
corpus=${STRATUM_CORPUS:-../shared/corpus}
out=docs/pictures
wanted=("$@")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

asked() {
    [[ ${#wanted[@]} -eq 0 || " ${wanted[*]} " == *" $1 "* ]]
}
# picture NAME FILE [OPTION...]: one that vdbtrace makes by itself
picture() {
    local name=$1
    shift
    asked "$name" || return 0
    if [[ ! -f "$1" ]]; then
        echo "not there: $1"
        return 0
    fi
    "$bin/vdbtrace" "$@" -o "$out/$name.png"
}
# tiles NAME COLUMNS FILE 'OPTIONS' 'OPTIONS'...: several of one file, side by side
tiles() {
    local name=$1 columns=$2 file=$3 n=0
    shift 3
    asked "$name" || return 0
    if [[ ! -f "$file" ]]; then
        echo "not there: $file"
        return 0
    fi
    rm -f "$work"/*.png
    local options
    for options in "$@"; do
        # shellcheck disable=SC2086 # words
        "$bin/vdbtrace" "$file" $options -o "$(printf '%s/%02d.png' "$work" "$n")"
        n=$((n + 1))
    done
    montage "$work"/*.png -tile "${columns}x" -geometry +0+0 "$out/$name.png"
}

if asked strings; then
    python3 scripts/two_towers.py > "$work/towers.gcode"
    seen="--size 450x300 --spp 64 --printer typical --flow-lag 0.1 --sag 0.03 --voxel-size 0.03 --brdf pla-blue --eye 115,54,15"
    seen+=" --look-at 115,100,7 --fov 50"
    tiles strings 2 "$work/towers.gcode" "$seen" "$seen --strings"
fi
boat=$corpus/gcode/gcode-preview-benchy_slic3r.gcode
picture hull data/gcode/hull.gcode --size 900x675
picture two_color data/gcode/two_tone.gcode --color 'Prusament Galaxy Purple,3DJAKE Silk Gold' --size 900x600 --spp 64
tiles finishes 2 data/gcode/hull.gcode '--size 450x375 --zoom 1.2 --spp 64 --brdf plastic:0.7,0.25,0.08,0.22' \
    '--size 450x375 --zoom 1.2 --spp 64 --brdf matte:0.7,0.25,0.08' '--size 450x375 --zoom 1.2 --spp 64 --brdf silk:0.7,0.25,0.08' \
    '--size 450x375 --zoom 1.2 --spp 64 --brdf glitter:0.7,0.25,0.08'
if asked growing; then
    "$bin/vdbtrace" data/gcode/hull.gcode --film "$out/growing.png" --nozzle --turntable --grow time --size 240x180 \
        --seconds 3 --fps 8
fi
tiles hot_ends 2 data/gcode/two_tone.gcode '--size 360x270 --printed 60% --nozzle' '--size 360x270 --printed 60% --clear-nozzle'
if asked lamp; then
    "$bin/vdbtrace" data/gcode/vase.gcode --brdf natural-pla --light rectangle:100,100,24,4,0,0,0,0,14,11,7.5,4.5 \
        --env constant:0.16,0.2,0.28 --exposure 0.2 --size 480x600 --spp 96 -o "$out/lamp.jpg"
fi
if asked thumbnail; then
    "$bin/gcode2vdb" data/gcode/hull.gcode --thumbnail 300x300 -o "$work/hull.gcode"
    sed -n '/^; thumbnail begin/,/^; thumbnail end/{/thumbnail/d;s/^; //p}' "$work/hull.gcode" | base64 -d >"$out/thumbnail.png"
fi
for percent in 25 50 75 100; do
    picture "benchy_$percent" "$boat" --printed "$percent%" --frame all --size 720x540
done
near=(--voxels-per-layer 8 --zoom 4 --size 700x525)
tiles settled 2 data/gcode/tile.gcode "${near[*]}" "${near[*]} --beads settled"
# Top layer, seam, wall and corner: as commanded, and by a typical printer.
pairs=()
for camera in "--eye 94,88,16 --look-at 101,97,2.4" "--eye 118,88,10 --look-at 108,98,3.2" \
    "--eye 92,72,6 --look-at 96,87.4,1.6" "--eye 88,76,11 --look-at 92,90,2.4"; do
    for printer in ideal typical; do
        pairs+=("$camera --fov 22 --size 480x360 --spp 24 --voxels-per-layer 8 --printer $printer")
    done
done
tiles deposit 4 data/gcode/tile.gcode "${pairs[@]}"
# One layer of lines, 10 mm squares of them in four directions: gloss without and with a direction.
if asked gloss; then
    awk 'BEGIN {
        print "M83\nG1 Z0.2 F6000\n;LAYER_CHANGE\n;Z:0.2\n;HEIGHT:0.2\n;TYPE:Top solid infill\n;WIDTH:0.42"
        for (n = 0; n < 4; ++n) {
            c = cos(n * 3.14159265 / 4); s = sin(n * 3.14159265 / 4)
            for (k = -18; k <= 18; ++k) {
                d = 0.377 * k; from = -99; to = 99
                clip(c, -d * s); clip(s, d * c)
                if (to - from < 0.3) continue
                x = 100 + n % 2 * 11 - d * s; y = 100 + int(n / 2) * 11 + d * c
                printf "G0 X%.3f Y%.3f F9000\nG1 X%.3f Y%.3f E%.5f F1800\n", x + from * c, y + from * s, x + to * c, y + to * s,
                    (to - from) * 0.0314
            }
        }
    }
    # Of the line, what lies within 5 mm along one axis.
    function clip(along, at,   a, b) {
        if (along * along < 1e-9) { if (at * at > 25) to = from; return }
        a = (-5 - at) / along; b = (5 - at) / along
        if (a > b) { at = a; a = b; b = at }
        if (a > from) from = a
        if (b < to) to = b
    }' >"$work/lines.gcode"
    lines='--printer typical --size 450x300 --spp 128 --env sky:35,90 --eye 105.5,84,20 --look-at 105.5,104.5,0.2 --fov 42'
    tiles gloss 2 "$work/lines.gcode" "$lines --brdf fdm:0.05,0.12,0.3,0.22,1" "$lines --brdf fdm:0.05,0.12,0.3,0.22,2.5"
fi
# What photographs of extrusion tests show: flow, pressure advance, narrow infill. Sliced here: needs OpenSCAD and PrusaSlicer.
if asked plastic; then
    install_packages openscad prusa-slicer
    rm -f "$work"/*.png
    sliced() { # NAME SCAD PERIMETERS
        printf '%s\n' "$2" >"$work/$1.scad"
        openscad -q -o "$work/$1.stl" "$work/$1.scad"
        prusa-slicer --export-gcode "$work/$1.stl" -o "$work/$1.gcode" --layer-height 0.2 --perimeters "$3" \
            --extrusion-width 0.45 --external-perimeter-extrusion-width 0.45 --top-infill-extrusion-width 0.4 \
            --fill-density 40% --top-solid-layers 5 --nozzle-diameter 0.4 --filament-diameter 1.75 --skirts 0 \
            --center 100,100 >/dev/null
    }
    sliced cube 'cube([30, 30, 3]);' 3
    sliced bars 'cube([34, 3.2, 3]); translate([0, 6, 0]) cube([34, 2.2, 3]); translate([0, 12, 0]) cube([34, 4.4, 3]);' 2
    # Lines whose middle is printed fast, with an advance from 0 to twice the lag.
    {
        printf 'M83\nM204 S2000\nG1 Z0.2 F6000\n'
        for n in 0 1 2 3 4 5 6; do
            printf 'M900 K%s\nG0 X85 Y%d F9000\n;TYPE:External perimeter\n;WIDTH:0.45\n;HEIGHT:0.2\n' \
                "$(awk "BEGIN { print 0.08 * $n / 6 }")" $((90 + 3 * n))
            printf 'G1 X95 E0.3386 F1200\nG1 X115 E0.6772 F6000\nG1 X125 E0.3386 F1200\n'
        done
    } >"$work/pattern.gcode"
    shot() { # NAME FILE OPTION...
        "$bin/vdbtrace" "$work/$2.gcode" --size 400x300 --spp 64 --brdf plastic:0.03,0.17,0.34,0.25 "${@:3}" -o "$work/$1.png"
    }
    behind=(--env sky:18,60)
    aside=(--env sky:22,250)
    for flow in 90 95 100 105; do
        shot "1_$(printf %03d "$flow")" cube --printer typical --flow "$flow" "${behind[@]}" --eye 100,62,22 --look-at 100,94,3 --fov 24
    done
    for advance in 0 0.04 0.08; do
        shot "2_$advance" cube --printer typical --flow-lag 0.04 --pressure-advance "$advance" "${aside[@]}" \
            --eye 78,74,16 --look-at 86.5,86.5,1.6 --fov 20
    done
    shot 2_pattern pattern --beads settled --crown 0.2 --flow-lag 0.04 "${aside[@]}" --view top
    for flow in 100 105; do
        shot "3_$flow" bars --printer typical --flow "$flow" "${behind[@]}" --eye 93,84,14 --look-at 97,99.5,3 --fov 24
        shot "4_$flow" cube --printer typical --flow "$flow" "${behind[@]}" --eye 96,80,9 --look-at 98,87.2,3 --fov 24
    done
    montage "$work"/[1-4]_*.png -tile 4x -geometry +2+2 "$out/plastic.png"
fi
shown=(--size 640x480)
picture gallery_gear data/gcode/gear.gcode "${shown[@]}" --brdf pla-yellow
picture tutorial_feature data/gcode/gear.gcode --size 800x600 --printed 50% --color-by feature --legend
picture gallery_vase data/gcode/vase.gcode "${shown[@]}" --brdf silk-pink
picture gallery_ripple "$corpus/gcode/gcode-preview-ripple_vase.gcode" "${shown[@]}" --brdf petg-orange
picture gallery_knot data/gcode/knot.gcode "${shown[@]}" --brdf petg-black
picture gallery_tile data/gcode/tile.gcode "${shown[@]}" --brdf pla-white --view top --env sky:25,30
picture gallery_two_tone data/gcode/two_tone_mmu.gcode "${shown[@]}"
picture gallery_bridges data/gcode/bridges.gcode "${shown[@]}" --brdf pla-green --env sky
picture gallery_tug data/gcode/hull.gcode "${shown[@]}" --brdf pla-blue --bed-surface pei
picture hills "$boat" --size 400x300 --brdf petg-orange --env "$corpus/env/golden_gate_hills_1k.hdr" --env-rotation 200
tiles beds 2 data/gcode/hull.gcode "--size 480x360 --bed-surface pei" "--size 480x360 --bed-surface grid"
filaments=()
for filament in pla-blue pla-green pla-red pla-white pla-yellow petg-black petg-orange silk-pink; do
    filaments+=("--size 360x300 --features -skirt --zoom 1.15 --brdf $filament")
done
tiles filaments 4 "$boat" "${filaments[@]}"
# A print beside its model.
if asked deviation && [[ -f "$corpus/models/gearwheel.stl" ]]; then
    install_packages prusa-slicer
    prusa-slicer --export-gcode --layer-height 0.2 --first-layer-height 0.2 -o "$work/gear.gcode" "$corpus/models/gearwheel.stl"
    "$bin/gcode2vdb" "$work/gear.gcode" -o "$work/gear.vdb" --voxel-size 0.1 --compare "$corpus/models/gearwheel.stl" \
        --grids deviation
    "$bin/vdbtrace" "$work/gear.vdb" --color-by deviation --legend --size 900x560 -o "$work/deviation.png"
    convert "$work/deviation.png" -quality 88 "$out/deviation.jpg"
fi

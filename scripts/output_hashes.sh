#!/usr/bin/env bash
# Hashes of grids, meshes and pictures that go through most of the code: a change that should not change results prints
# the same before and after it. Two minutes.
# scripts/output_hashes.sh > before.txt; …; scripts/output_hashes.sh | diff before.txt -
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$(realpath "${STRATUM_BIN:-build/release/bin}")
prints=$PWD/data/gcode
scenes=$PWD/data/scenes
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# run TOOL OUTPUT OPTION...: a file, or files in a folder
run() {
    local tool=$1 output=$2
    shift 2
    mkdir -p "$(dirname "$output")"
    "$bin/$tool" "$@" -o "$output" --quiet
}
small=(--size 160x120 --spp 2)
two=(--voxels-per-layer 2)

run gcode2vdb grids/hull.vdb "$prints/hull.gcode" "${two[@]}"
run gcode2vdb grids/hull_cull.vdb "$prints/hull.gcode" "${two[@]}" --interior cull
run gcode2vdb grids/gear_half.vdb "$prints/gear.gcode" "${two[@]}" --precision half --layers 1:20
run gcode2vdb grids/two_tone.vdb "$prints/two_tone_mmu.gcode" "${two[@]}" --grids layer,feature,tool,width,speed,time,color
run gcode2vdb grids/vase.vdb "$prints/vase.gcode" --voxel-size 0.13 --up y --unit m --origin center
run gcode2vdb grids/bridges_cura.vdb "$prints/bridges_cura.gcode" "${two[@]}" --features -support --interior-distance
run gcode2vdb series/ "$prints/tile.gcode" "${two[@]}" --snapshots 25%,layer:9,100%
run gcode2vdb grids/fwretract.vdb "$prints/tile_fwretract.gcode" "${two[@]}" --dump-toolpath grids/fwretract.csv
run gcode2vdb meshes/tile.stl "$prints/tile.gcode" "${two[@]}"
run gcode2vdb meshes/two_tone.ply "$prints/two_tone.gcode" "${two[@]}" --grids color
run gcode2vdb meshes/gear.obj "$prints/gear.gcode" "${two[@]}" --mesh-error 0

run vdbtrace pictures/default.png "$prints/hull.gcode" --size 160x120
run vdbtrace pictures/series.png "$prints/tile.gcode" "${two[@]}" "${small[@]}" --progress-series 3
for integrator in path direct phong ao normal depth position mask; do
    run vdbtrace "pictures/$integrator.exr" grids/hull.vdb "${small[@]}" --integrator "$integrator"
done
for march in brick sphere vdb; do
    run vdbtrace "pictures/march_$march.exr" grids/hull.vdb "${small[@]}" --march "$march"
done
run vdbtrace pictures/floats.exr grids/hull_cull.vdb "${small[@]}" --brick-values float --normals smooth
run vdbtrace pictures/cache.exr "$prints/hull.gcode" "${two[@]}" "${small[@]}" --brick-cache 20MB
run vdbtrace pictures/auto.exr "$prints/hull.gcode" "${small[@]}" --voxel-size auto
run vdbtrace pictures/sky.png "$prints/knot.gcode" "${two[@]}" "${small[@]}" --env sky --brdf petg-black --bed-surface pei --f-number 4
run vdbtrace pictures/colors.png "$prints/two_tone_mmu.gcode" "${two[@]}" --size 160x120 --frame all --legend --color-by layer
run vdbtrace pictures/layers.exr "$prints/two_tone.gcode" "${two[@]}" "${small[@]}" --aov normal,albedo,layer,variance --noise 0.2
for scene in "$scenes"/*.json; do
    run vdbtrace "pictures/$(basename "$scene" .json).exr" "$scene" "${small[@]}"
done
# OpenVDB gives every file a random name in its header, 36 characters from byte 21 on.
find . -type f | LC_ALL=C sort | while read -r name; do
    if [[ $name == *.vdb ]]; then
        hash=$({ head -c 21 "$name"; tail -c +58 "$name"; } | sha256sum)
    else
        hash=$(sha256sum <"$name")
    fi
    echo "${hash%% *} $name"
done

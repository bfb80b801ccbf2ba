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

# Several files of one input, into a folder.
files() {
    local name=$1
    shift
    mkdir "$name"
    "$bin/gcode2vdb" "$@" -o "$name/" --quiet
}
file() {
    local name=$1
    shift
    mkdir -p "$(dirname "$name")"
    "$bin/gcode2vdb" "$@" -o "$name" --quiet
}
picture() {
    local name=$1
    shift
    mkdir -p "$(dirname "$name")"
    "$bin/vdbtrace" "$@" -o "$name" --quiet
}
small=(--size 160x120 --spp 2)
two=(--voxels-per-layer 2)

file grids/hull.vdb "$prints/hull.gcode" "${two[@]}"
file grids/hull_cull.vdb "$prints/hull.gcode" "${two[@]}" --interior cull
file grids/gear_half.vdb "$prints/gear.gcode" "${two[@]}" --precision half --layers 1:20
file grids/two_tone.vdb "$prints/two_tone_mmu.gcode" "${two[@]}" --grids layer,feature,tool,width,speed,time,color
file grids/vase.vdb "$prints/vase.gcode" --voxel-size 0.13 --up y --unit m --origin center
file grids/bridges_cura.vdb "$prints/bridges_cura.gcode" "${two[@]}" --features -support --interior-distance
files series "$prints/tile.gcode" "${two[@]}" --snapshots 25%,layer:9,100%
file grids/fwretract.vdb "$prints/tile_fwretract.gcode" "${two[@]}" --dump-toolpath grids/fwretract.csv
file meshes/tile.stl "$prints/tile.gcode" "${two[@]}"
file meshes/two_tone.ply "$prints/two_tone.gcode" "${two[@]}" --grids color
file meshes/gear.obj "$prints/gear.gcode" "${two[@]}" --mesh-error 0

picture pictures/default.png "$prints/hull.gcode" --size 160x120
picture pictures/series.png "$prints/tile.gcode" "${two[@]}" "${small[@]}" --progress-series 3
for integrator in path direct environment-sum phong ao normal depth position mask; do
    picture "pictures/$integrator.exr" grids/hull.vdb "${small[@]}" --integrator "$integrator"
done
for march in brick sphere vdb; do
    picture "pictures/march_$march.exr" grids/hull.vdb "${small[@]}" --march "$march"
done
picture pictures/floats.exr grids/hull_cull.vdb "${small[@]}" --brick-values float --normals smooth
picture pictures/cache.exr "$prints/hull.gcode" "${two[@]}" "${small[@]}" --brick-cache 20MB
picture pictures/auto.exr "$prints/hull.gcode" "${small[@]}" --voxel-size auto
picture pictures/sky.png "$prints/knot.gcode" "${two[@]}" "${small[@]}" --env sky --brdf petg-black --bed-surface pei --f-number 4
picture pictures/colors.png "$prints/two_tone_mmu.gcode" "${two[@]}" --size 160x120 --frame all --legend --color-by layer
picture pictures/layers.exr "$prints/two_tone.gcode" "${two[@]}" "${small[@]}" --aov normal,albedo,layer,variance --noise 0.2
for scene in "$scenes"/*.json; do
    picture "pictures/$(basename "$scene" .json).exr" "$scene" "${small[@]}"
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

#!/usr/bin/env bash
# Where patterns fail: the stored patterns of 118 mm and random on the model, re-rendered at one elevation, distance and light after the other, under a glossier
# coat, printed too large, too small, in a printer's colours and beside their place, on a part of the model, and on photos made worse. FOLDER/table.md has AP and
# the drop from random with its interval, FOLDER/*/differences.csv each pair of patterns. Steps go on where they were stopped. Three quarters of an hour on two
# cores.
#
#   PYTHON=venv/bin/python benches/attack_sweeps.sh MESH FOLDER
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). PYTHON: one with numpy and opencv-python-headless.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-python3} mesh=$1 folder=$2
stored=$home/print_templates
common=(--mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --detector yolox_nano --azimuth-deg every30 --field-of-view-deg 40)
patterns=(random="$stored/random16.png" attack_1="$stored/patterns/yolox_nano_118mm_1.png" attack_2="$stored/patterns/yolox_nano_118mm_2.png")
usual=(--light courtyard sunrise@60 --pitch-deg 15 --distance-mm 1200)
evaluate() {
    "$home/run" attack evaluate "${common[@]}" "${@:2}" -o "$folder/$1"
}
worn() {
    evaluate "$1" --pattern "${patterns[@]}" --tile-mm "$2" "${@:3}"
}
# Each pattern as a texture of sides that as_sides.py makes with these options.
as_sides() {
    local textures=() name made=$folder/$1
    mkdir -p "$made"
    for pattern in "${patterns[@]}"; do
        name=${pattern%%=*}
        "$python" "$home/benches/as_sides.py" "${pattern#*=}" "$made/$name.png" --tile-mm 118 "${@:2}"
        textures+=("$name=$made/$name.png")
    done
    evaluate "$1" --texture "${textures[@]}" "${usual[@]}"
}
for pitch_deg in 0 15 30 45 60 75; do
    worn "pitch_$pitch_deg" 118 --light courtyard sunrise@60 --pitch-deg $pitch_deg --distance-mm 1200
done
for distance_mm in 800 1100 1500 2000 2800; do
    worn "distance_$distance_mm" 118 --light courtyard sunrise@60 --pitch-deg 15 --distance-mm $distance_mm
done
worn light 118 --light courtyard sunrise@60 city forest interior night studio sunset --pitch-deg 15 --distance-mm 1200
for roughness in 0.25 0.1 0.03; do
    worn "roughness_$roughness" 118 "${usual[@]}" --roughness $roughness
done
for tile_mm in 106 112 124 130; do
    worn "tile_$tile_mm" $tile_mm "${usual[@]}"
done
for off_mm in 2 5 10; do
    as_sides "off_$off_mm" --off-mm $off_mm
done
as_sides without_front_and_rear --bare front rear bottom
as_sides without_roof --bare roof bottom
as_sides only_left_and_right --bare roof front rear bottom
as_sides only_roof --bare left right front rear bottom
mkdir -p "$folder/printed"
printed=()
for pattern in "${patterns[@]}"; do
    name=${pattern%%=*}
    "$home/run" pattern check "${pattern#*=}" --printer "$stored/printer_plain_paper.toml" -o "$folder/printed/$name.png"
    printed+=("$name=$folder/printed/$name.png")
done
evaluate printed/evaluation --pattern "${printed[@]}" --tile-mm 118 "${usual[@]}"
# Blur, JPEG and the like, on the photos of all lights: FOLDER/corrupted/robustness.csv.
"$home/run" score "$folder/light/session" --detector yolox_nano --corrupt blur,noise,jpeg,exposure,haze,scale,crop -o "$folder/corrupted"
"$python" "$home/benches/sweep_table.py" "$folder" | tee "$folder/table.md"

#!/usr/bin/env bash
# The table of patterns in docs/guide/reference/measured.md against yolox_nano: frames, two seeds of the attack, ER and CAMOU with as many pictures, all re-rendered.
# Two hours on two cores; each step goes on where it was stopped.
#
#   benches/attack_yolox_nano.sh MESH FOLDER
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). `print_templates/patterns` has what came out.
set -euo pipefail
if [ $# -ne 2 ]; then
    echo "usage: $0 MESH FOLDER" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
folder=$2
model=(--mesh "$1" --material Material.001 --length-mm 455)
frames=$folder/frames
"$run" attack render "${model[@]}" --light forest sunset@120 city@60 --azimuth-deg 15 45 75 105 135 165 195 225 255 285 315 345 --pitch-deg 3 18 \
    --distance-mm 650 1100 --flat 000000 808080 ffffff --size-px 256 --field-of-view-deg 50 --samples 16 -o "$frames"
for seed in 1 2; do
    "$run" attack run "$frames" --detector yolox_nano --cells 16 --tile-mm 240 --rate 0.03 --floor 0.001 --hard 0 --seed $seed -o "$folder/attack_$seed"
done
for method in er camou; do
    "$run" attack baseline $method "$frames" --detector yolox_nano --cells 16 --tile-mm 240 --queries 2400 -o "$folder/$method"
done
"$run" attack baseline random "$frames" --detector yolox_nano --cells 16 --tile-mm 240 -o "$folder/random"
"$run" attack history "$folder"/{attack_1,attack_2,er,camou,random} -o "$folder/history"
"$run" attack evaluate "${model[@]}" --normal 808080 --tile-mm 240 --target yolox_nano --light courtyard sunrise@60 --azimuth-deg every30 \
    --pitch-deg 0 15 30 --distance-mm 900 1200 1500 --field-of-view-deg 40 -o "$folder/evaluation" \
    --pattern attack_1="$folder/attack_1/pattern.png" attack_2="$folder/attack_2/pattern.png" er="$folder/er/pattern.png" \
    camou="$folder/camou/pattern.png" random="$folder/random/pattern.png"

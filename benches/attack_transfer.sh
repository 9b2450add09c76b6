#!/usr/bin/env bash
# Patterns of 118 mm against detectors they never saw: for each of the five, two made against the other four, judged on it beside random, DTA's published
# pattern, and ER and CAMOU, which asked all five; by a simpler recipe, two against the three convolutional detectors alone, for both DEIMv2, and two against two of
# these, for the third; and two textures (a pattern of 118 mm for each side) against all five. A pattern against four begins with 16 cells and is refined to 32. Each
# step goes on where it was stopped.
#
#   benches/attack_transfer.sh MESH FRAMES PUBLISHED FOLDER [STEPS] [STEPS_OF_FIVE]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh; PUBLISHED: DTA's
# pattern as a PNG. FOLDER/held_out and FOLDER/five have the tables; their differences.csv each pair of
# patterns with its interval. Five hours on two cores.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: $0 MESH FRAMES PUBLISHED FOLDER [STEPS] [STEPS_OF_FIVE]" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) published=$3 folder=$4 steps=${5:-300} steps_of_five=${6:-1000}
all=(yolox_nano nanodet_m fastestdet deimv2_femto deimv2_atto)
convolutional=(yolox_nano nanodet_m fastestdet)
but() { printf '%s\n' "${@:2}" | grep -vx "$1" | paste -sd,; }
five=$(but none "${all[@]}")
attack() { "$run" attack run "${frames[@]}" --seed $seed "$@"; }
worst() { attack --against worst "$@"; }
simple() { attack --steps $((8 * steps / 3)) --cells 16 "$@"; }
for seed in 1 2; do
    for held_out in "${all[@]}"; do
        others=$(but "$held_out" "${all[@]}")
        coarse=$folder/coarse_${held_out}_$seed
        worst --detector "$others" --steps "$steps" --cells 16 -o "$coarse"
        worst --detector "$others" --steps "$steps" --cells 32 --near "$coarse/pattern.png" --near-weight 10 -o "$folder/without_${held_out}_$seed"
    done
    simple --detector "$(but none "${convolutional[@]}")" -o "$folder/without_deimv2_$seed"
    for held_out in yolox_nano nanodet_m; do
        simple --detector "$(but $held_out "${convolutional[@]}")" -o "$folder/convolutional_without_${held_out}_$seed"
    done
    worst --detector "$five" --steps "$steps_of_five" --cells 24 --laying sides -o "$folder/five_$seed"
done
"$run" attack baseline random "$frames" --detector yolox_nano --cells 24 -o "$folder/random"
for method in er camou; do
    "$run" attack baseline $method "${frames[@]}" --detector "$five" --cells 24 --queries $((8 * steps)) -o "$folder/$method"
done
patterns=(random="$folder/random/pattern.png" camou="$folder/camou/pattern.png" er="$folder/er/pattern.png" dta="$published")
for made in "${all[@]/#/without_}" without_deimv2 convolutional_without_{yolox_nano,nanodet_m}; do
    patterns+=("${made}_1=$folder/${made}_1/pattern.png" "${made}_2=$folder/${made}_2/pattern.png")
done
evaluate() { "$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --tile-mm 118 --detector "$five" "$@"; }
views=(--pitch-deg 0 15 30 --distance-mm 900 1200 1500 --field-of-view-deg 40)
evaluate --light courtyard@120 sunrise@180 courtyard@240 sunrise@300 --azimuth-deg {1,4,7,10,13,16,19,22,25,28,31,34}5 "${views[@]}" \
    --pattern "${patterns[@]}" -o "$folder/held_out"
evaluate --light courtyard sunrise@60 --azimuth-deg every30 "${views[@]}" --pattern random="$folder/random/pattern.png" \
    --texture five_1="$folder/five_1/pattern.png" five_2="$folder/five_2/pattern.png" -o "$folder/five"

#!/usr/bin/env bash
# AP@0.5 on the model against the time of making the pattern: the attack with six budgets, ER and CAMOU with two each, random; two seeds, re-rendered at 72 views.
# Each step goes on where it was stopped, but times count only on a quiet machine and in one go. Three quarters of an hour on two cores.
#
#   benches/attack_time.sh MESH FRAMES FOLDER
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh. FOLDER/chart has the chart
# and its numbers.
set -euo pipefail
if [ $# -ne 3 ]; then
    echo "usage: $0 MESH FRAMES FOLDER" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) folder=$3
made=() patterns=()
add() { made+=("$folder/$1") patterns+=("$1=$folder/$1/pattern.png"); }
for seed in 1 2; do
    for steps in 20 40 75 150 300 600; do
        "$run" attack run "${frames[@]}" --detector yolox_nano --cells 16 --steps $steps --seed $seed -o "$folder/attack_${steps}_$seed"
        add "attack_${steps}_$seed"
    done
    for method in er camou; do
        for queries in 600 2400; do
            "$run" attack baseline $method "${frames[@]}" --detector yolox_nano --cells 16 --queries $queries --seed $seed -o "$folder/${method}_${queries}_$seed"
            add "${method}_${queries}_$seed"
        done
    done
    "$run" attack baseline random "${frames[@]}" --detector yolox_nano --cells 16 --seed $seed -o "$folder/random_$seed"
    add random_$seed
done
"$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --light courtyard sunrise@60 --azimuth-deg every30 \
    --pitch-deg 0 15 30 --distance-mm 1200 --field-of-view-deg 40 --detector yolox_nano -o "$folder/evaluation" --pattern "${patterns[@]}"
"$run" attack history "${made[@]}" --evaluation "$folder/evaluation" -o "$folder/chart"

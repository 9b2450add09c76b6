#!/usr/bin/env bash
# Patterns against detectors they never saw: for each of the five, one made against the other four, judged on it, beside one made against all five,
# the patterns of benches/attack_yolox_nano.sh, random, and DTA's published pattern. Each step goes on where it was stopped.
#
#   benches/attack_transfer.sh MESH FRAMES PUBLISHED FOLDER [STEPS]
#
# MESH: skyline_r32_lowpoly_ccby4.glb; FRAMES: those of benches/attack_yolox_nano.sh (FOLDER/frames there); PUBLISHED: DTA's pattern as a PNG.
# Renders 216 photos a pattern: hours on two cores.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: $0 MESH FRAMES PUBLISHED FOLDER [STEPS]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
mesh=$1 frames=$2 published=$3 folder=$4 steps=${5:-300}
all=(yolox_nano nanodet_m fastestdet deimv2_femto deimv2_atto)
stored=$home/print_templates/patterns
patterns=()
for held_out in "${all[@]}" none; do
    others=$(printf '%s\n' "${all[@]}" | grep -vx "$held_out" | paste -sd,)
    for seed in 1 2; do
        out=$folder/without_${held_out}_$seed
        "$home/run" attack run "$frames" --detector "$others" --against worst --tile-mm 240 --steps "$steps" --seed $seed -o "$out"
        patterns+=("without_${held_out}_$seed=$out/pattern.png")
    done
done
"$home/run" attack baseline random "$frames" --detector yolox_nano --tile-mm 240 -o "$folder/random"
"$home/run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --tile-mm 240 --light courtyard sunrise@60 \
    --azimuth-deg every30 --pitch-deg 0 15 30 --distance-mm 900 1200 1500 --field-of-view-deg 40 -o "$folder/evaluation" --pattern "${patterns[@]}" \
    camou="$stored/yolox_nano_camou.png" er="$stored/yolox_nano_er.png" random="$folder/random/pattern.png" dta="$published"

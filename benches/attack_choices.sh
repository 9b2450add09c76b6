#!/usr/bin/env bash
# What each augmentation and each loss buys: patterns of 118 mm against yolox_nano, three seeds each, re-rendered on the model and on another car, and shown to
# the four detectors that they were not made against. Each step goes on where it was stopped. Some 40 minutes a seed on two cores.
#
#   benches/attack_choices.sh MESH FRAMES OTHER FOLDER [STEPS] [SEED…]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh; OTHER: a folder with
# model_save.obj and exterior_face.txt (SeRAlab/Robust-and-Accurate-UV-map-based-Camouflage-Attack). FOLDER/model_SEED.csv and other_SEED.csv have each seed's AP,
# FOLDER/table.md the mean of the seeds and what each choice adds to the usual one. benches/attack_choices has the CSV files that measured.md shows.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: $0 MESH FRAMES OTHER FOLDER [STEPS] [SEED…]" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) other=$3 folder=$4 steps=${5:-100}
seeds=("${@:6}")
[ ${#seeds[@]} -gt 0 ] || seeds=(1 2 3)
lights=(courtyard sunrise@60 courtyard@240)
declare -A options=(
    [usual]="" [all_boxes]="--loss all" [overlap]="--loss overlap" [dta]="--floor 0.5" [no_hard]="--hard 0" [smooth]="--smooth 0.1" [none]="--augment none"
)
for kind in brightness contrast far noise white-balance blur jpeg background tone renderer shift size turn pose; do
    options[$kind]="--augment $kind"
done
for seed in "${seeds[@]}"; do
    patterns=()
    for choice in "${!options[@]}"; do
        out=$folder/${choice}_$seed
        # shellcheck disable=SC2086  # two words
        "$run" attack run "${frames[@]}" --detector yolox_nano --steps "$steps" --seed $seed ${options[$choice]} -o "$out"
        patterns+=("$choice=$out/pattern.png")
    done
    judged=(--normal 808080 --target yolox_nano --light "${lights[seed % 3]}" --azimuth-deg every30 --field-of-view-deg 40 --pattern "${patterns[@]}")
    "$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 "${judged[@]}" --pitch-deg 0 15 30 --distance-mm 1200 \
        --detector yolox_nano,nanodet_m,fastestdet,deimv2_femto,deimv2_atto -o "$folder/model_$seed"
    "$run" attack evaluate --mesh "$other/model_save.obj" --faces "$other/exterior_face.txt" --length-mm 490 "${judged[@]}" --pitch-deg 5 20 \
        --distance-mm 1200 --size-px 256x192 --detector yolox_nano -o "$folder/other_$seed"
    for place in model other; do
        cp "$folder/${place}_$seed/evaluation.csv" "$folder/${place}_$seed.csv"
    done
done
"${PYTHON:-python3}" "$(dirname "$0")/choices_table.py" "$folder" | tee "$folder/table.md"

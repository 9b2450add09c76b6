#!/usr/bin/env bash
# Which encoder of DTN, how deep, and from one reference colour or any of three: every choice with several seeds, trained on the same views for the same number of
# epochs, and tested in two lights and four colours that none has seen. Each step goes on where it was stopped. Half an hour on two cores.
#
#   benches/dtn_choices.sh MESH FOLDER [EPOCHS] [SEED…]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). Images are 64 px wide. FOLDER/table.md has the mean error of the seeds and
# what each choice adds to DTN's own (ResNet, k = 4, grey).
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER [EPOCHS] [SEED…]" >&2
    exit 2
fi
here=$(dirname "$0")
run="$here/../run"
# shellcheck source=benches/dtn_frames.sh
. "$here/dtn_frames.sh"
folder=$2 epochs=${3:-60}
seeds=("${@:4}")
[ ${#seeds[@]} -gt 0 ] || seeds=(1 2 3)
dtn_frames "$1" "$folder" 64 64 48
networks=()
train() { # NAME SEED OPTIONS…
    local file=$folder/$1_$2.dtn
    "$run" attack train-dtn "$folder"/{two,more,lights} --validation "$folder/test" --epochs "$epochs" --seed "$2" -o "$file" "${@:3}"
    networks+=("$file")
}
for seed in "${seeds[@]}"; do
    for encoder in resnet densenet convnet; do
        for depth in 2 3 4; do
            train "$encoder$depth" "$seed" --encoder $encoder --depth $depth
        done
    done
    train multiply_add "$seed" --transformer multiply-add
    train references "$seed" --reference 808080 000000 ffffff
done
"$run" attack chart "$folder/test" --network "${networks[@]}" -o "$folder/chart"
"${PYTHON:-python3}" "$here/dtn_table.py" "$folder/chart/renderers.json" "${networks[@]}" | tee "$folder/table.md"

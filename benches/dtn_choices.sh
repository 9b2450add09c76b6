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
here=$(dirname "$0") run="$(dirname "$0")/../run"
mesh=$1 folder=$2 epochs=${3:-60}
seeds=("${@:4}")
[ ${#seeds[@]} -gt 0 ] || seeds=(1 2 3)
flat=(--flat 000000 808080 ffffff)
render() {
    "$run" attack render --mesh "$mesh" --material Material.001 --length-mm 455 --field-of-view-deg 50 --size-px 64 "$@"
}
render --light forest sunset@120 --azimuth-deg 22.5 67.5 112.5 157.5 202.5 247.5 292.5 337.5 --pitch-deg 8 22 --distance-mm 650 1100 "${flat[@]}" --samples 48 \
    -o "$folder/two"
render --light studio@200 sunrise@90 forest@180 --azimuth-deg 0 55 125 180 235 310 --pitch-deg 15 --distance-mm 800 "${flat[@]}" --samples 48 -o "$folder/more"
render --light city city@150 night@60 studio@80 sunset@240 sunrise@200 forest@90 --azimuth-deg 20 110 200 290 --pitch-deg 12 --distance-mm 750 "${flat[@]}" \
    --samples 48 -o "$folder/lights"
render --light courtyard interior@45 --azimuth-deg 10 140 260 --pitch-deg 15 --distance-mm 700 "${flat[@]}" c83214 1e78c8 465a28 e6d23c --samples 64 \
    -o "$folder/test"
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

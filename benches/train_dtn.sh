#!/usr/bin/env bash
# DTN beside the closed forms, on one chart: trained for long on frames in twelve lights, at 128 px. Hours on two cores; each step goes on where it was stopped.
# Its encoders, depths and references beside each other: dtn_choices.sh.
#
#   benches/train_dtn.sh MESH FOLDER
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0).
set -euo pipefail
if [ $# -ne 2 ]; then
    echo "usage: $0 MESH FOLDER" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
folder=$2
render() {
    "$run" attack render --mesh "$mesh" --material Material.001 --length-mm 455 --field-of-view-deg 50 "$@"
}
mesh=$1
flat=(--flat 000000 808080 ffffff)
render --light forest sunset@120 --azimuth-deg 22.5 67.5 112.5 157.5 202.5 247.5 292.5 337.5 --pitch-deg 8 22 --distance-mm 650 1100 "${flat[@]}" \
    --size-px 256 --samples 32 -o "$folder/two"
render --light studio@200 sunrise@90 forest@180 --azimuth-deg 0 55 125 180 235 310 --pitch-deg 15 --distance-mm 800 "${flat[@]}" --size-px 128 \
    --samples 48 -o "$folder/more"
render --light city city@150 night@60 studio@80 sunset@240 sunrise@200 forest@90 --azimuth-deg 20 110 200 290 --pitch-deg 12 --distance-mm 750 \
    "${flat[@]}" --size-px 128 --samples 48 -o "$folder/lights"
render --light courtyard interior@45 --azimuth-deg 10 140 260 --pitch-deg 15 --distance-mm 700 "${flat[@]}" c83214 1e78c8 465a28 e6d23c --size-px 128 \
    --samples 64 -o "$folder/test"
"$run" attack train-dtn "$folder"/{two,more,lights} --width-px 128 --validation "$folder/test" --epochs 560 -o "$folder/long.dtn"
"$run" attack chart "$folder/test" --network "$folder/long.dtn" -o "$folder/chart"

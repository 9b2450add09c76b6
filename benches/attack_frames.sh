#!/usr/bin/env bash
# Frames to make patterns on: 288 views of a model under twelve lights, no two of which have light, azimuths, pitches and distance in common. Courtyard
# and sunrise are left for judging. Some ten minutes on two cores; goes on where it was stopped.
#
#   benches/attack_frames.sh FOLDER MODEL…
#
# MODEL…: what describes the model, as in --mesh car.glb --material body --length-mm 455. FOLDER gets the folders 0 to 11, all of which `attack run` takes; with
# LOTS in the environment, as in LOTS="1 5 9", those alone. SIZE_PX (256), FIELD_OF_VIEW_DEG (50) and SAMPLES (8 paths a pixel) are those of the frames,
# SCALEPROOF is the program instead of ./run.
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 FOLDER --mesh FILE …" >&2
    exit 2
fi
run=${SCALEPROOF:-"$(dirname "$0")/../run"}
folder=$1
shift
lights=(forest sunset@40 city@200 studio@90 interior@150 night@250 forest@130 sunset@220 city@320 studio@290 interior@20 forest@250)
pitches=("0 18" "4 24" "9 30" "2 14" "12 35" "6 21" "1 27" "10 16" "3 32" "7 19" "13 38" "5 25")
distances=(600 1000 1400 700 1150 850 1500 650 950 1250 750 1100)
for k in ${LOTS:-${!lights[@]}}; do
    # Every 30°, beginning at another multiple of 2.5° each time.
    azimuths=$(awk -v k="$k" 'BEGIN { for (i = 0; i < 12; i++) printf "%g ", 30 * i + 2.5 * (5 * k % 12) }')
    # shellcheck disable=SC2086  # lists of numbers
    "$run" attack render "$@" --light "${lights[$k]}" --azimuth-deg $azimuths --pitch-deg ${pitches[$k]} --distance-mm "${distances[$k]}" \
        --flat 000000 808080 ffffff --size-px "${SIZE_PX:-256}" --field-of-view-deg "${FIELD_OF_VIEW_DEG:-50}" --samples "${SAMPLES:-8}" --denoise -o "$folder/$k"
done

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
here=$(dirname "$0")
run="$here/../run"
# shellcheck source=benches/dtn_frames.sh
. "$here/dtn_frames.sh"
folder=$2
dtn_frames "$1" "$folder" 128 256 32
"$run" attack train-dtn "$folder"/{two,more,lights} --width-px 128 --validation "$folder/test" --epochs 560 -o "$folder/long.dtn"
"$run" attack chart "$folder/test" --network "$folder/long.dtn" -o "$folder/chart"

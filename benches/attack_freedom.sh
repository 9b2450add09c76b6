#!/usr/bin/env bash
# How much freedom a pattern needs: AP against the number of cells, the width of a repeat, the number of colours, and patterns of the sides' own; two seeds
# each, all re-rendered at 72 views. Each step goes on where it was stopped. An hour on two cores with 150 steps.
#
#   benches/attack_freedom.sh MESH FRAMES FOLDER [STEPS]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh. Names are
# LAYING_CELLS_TILE_COLOURS_SEED. FOLDER/table.md says of each pattern what it leaves, and chart.svg shows it (PYTHON has matplotlib).
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 MESH FRAMES FOLDER [STEPS]" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) folder=$3 steps=${4:-300}
patterns=() textures=()
for freedom in world_{4,8,16,24,32,64}_118_free world_16_118_{2,4,8,12} world_{16,32}_240_free world_{32,64}_480_free sides_24_118_free sides_64_480_free; do
    IFS=_ read -r laying cells tile colours <<<"$freedom"
    options=(--laying "$laying" --cells "$cells" --tile-mm "$tile" --steps "$steps")
    [ "$colours" = free ] || options+=(--paints "$colours")
    for seed in 1 2; do
        out=$folder/${freedom}_$seed
        "$run" attack run "${frames[@]}" --detector yolox_nano "${options[@]}" --seed $seed -o "$out"
        if [ "$laying" = world ]; then
            patterns+=("${freedom}_$seed=$out/pattern.png")
        else
            textures+=("${freedom}_$seed=$out/pattern.png")
        fi
    done
done
"$run" attack baseline random "$frames" --detector yolox_nano --cells 16 -o "$folder/random"
patterns+=(random="$folder/random/pattern.png")
"$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --light courtyard sunrise@60 --azimuth-deg every30 \
    --pitch-deg 0 15 30 --distance-mm 1200 --field-of-view-deg 40 --detector yolox_nano -o "$folder/evaluation" \
    --pattern "${patterns[@]}" --texture "${textures[@]}"
"${PYTHON:-python3}" "$(dirname "$0")/freedom_chart.py" "$folder" | tee "$folder/table.md"

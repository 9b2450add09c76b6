#!/usr/bin/env bash
# How much freedom a pattern needs: AP against the number of cells, the width of a repeat, and patterns of the sides' own; two seeds each, all re-rendered at
# 72 views. Each step goes on where it was stopped. Two hours on two cores.
#
#   benches/attack_freedom.sh MESH FRAMES FOLDER [STEPS]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh. Names are
# LAYING_CELLS_TILE_SEED.
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 MESH FRAMES FOLDER [STEPS]" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) folder=$3 steps=${4:-300}
patterns=() textures=()
for freedom in world_{4,8,16,24,32}_118 world_{8,16}_60 world_16_80 world_{16,32}_240 world_64_480 sides_{16,24}_118 sides_64_480; do
    IFS=_ read -r laying cells tile <<<"$freedom"
    for seed in 1 2; do
        out=$folder/${freedom}_$seed
        "$run" attack run "${frames[@]}" --detector yolox_nano --laying "$laying" --cells "$cells" --tile-mm "$tile" --steps "$steps" --seed $seed -o "$out"
        if [ "$laying" = world ]; then
            patterns+=("${freedom}_$seed=$out/pattern.png")
        else
            textures+=("${freedom}_$seed=$out/pattern.png")
        fi
    done
done
"$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --light courtyard sunrise@60 --azimuth-deg every30 \
    --pitch-deg 0 15 30 --distance-mm 1200 --field-of-view-deg 40 --detector yolox_nano -o "$folder/evaluation" \
    --pattern "${patterns[@]}" --texture "${textures[@]}"

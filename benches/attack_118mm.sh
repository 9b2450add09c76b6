#!/usr/bin/env bash
# The figures of patterns of 118 mm and of textures against yolox_nano in docs/guide/reference/measured.md: frames, two seeds of each, random, all re-rendered and
# looked at by five detectors. An hour and a half on two cores; each step goes on where it was stopped.
#
#   benches/attack_118mm.sh MESH FOLDER [OTHER]
#
# With OTHER, a folder with model_save.obj and exterior_face.txt (SeRAlab/Robust-and-Accurate-UV-map-based-Camouflage-Attack), the same patterns on that car, too.
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). `print_templates/patterns` has what came out.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER [OTHER]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
folder=$2
model=(--mesh "$1" --material Material.001 --length-mm 455)
"$home/benches/attack_frames.sh" "$folder/frames" "${model[@]}"
frames=("$folder"/frames/{0,1,2,3,4,5,6,7,8,9,10,11})
for seed in 1 2; do
    "$home/run" attack run "${frames[@]}" --detector yolox_nano --cells 16 --steps 1600 --seed $seed -o "$folder/attack_$seed"
    "$home/run" attack run "${frames[@]}" --detector yolox_nano --laying sides --tile-mm 480 --cells 64 --steps 600 --seed $seed -o "$folder/texture_$seed"
done
"$home/run" attack baseline random "$folder/frames/0" --detector yolox_nano --cells 16 -o "$folder/random"
patterns=(random="$folder/random/pattern.png" attack_1="$folder/attack_1/pattern.png" attack_2="$folder/attack_2/pattern.png")
judged=(--normal 808080 --target yolox_nano --light courtyard sunrise@60 --azimuth-deg every30 --field-of-view-deg 40 --pattern "${patterns[@]}")
"$home/run" attack evaluate "${model[@]}" "${judged[@]}" --detector yolox_nano,nanodet_m,fastestdet,deimv2_femto,deimv2_atto \
    --texture texture_1="$folder/texture_1/pattern.png" texture_2="$folder/texture_2/pattern.png" \
    --pitch-deg 0 15 30 --distance-mm 900 1200 1500 -o "$folder/evaluation"
if [ $# -gt 2 ]; then
    "$home/run" attack evaluate --mesh "$3/model_save.obj" --faces "$3/exterior_face.txt" --length-mm 490 "${judged[@]}" --detector yolox_nano \
        --pitch-deg 5 20 --distance-mm 1000 1400 --size-px 256x192 -o "$folder/other"
fi

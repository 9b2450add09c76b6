#!/usr/bin/env bash
# The figures of textures in docs/guide/reference/measured.md: a pattern rendered by its rule and as its baked image, from 96 views each; a published
# camouflage beside a random pattern on its own mesh. Half an hour on two cores; each step goes on where it was stopped.
#
#   benches/textures.sh SKYLINE CAMOUFLAGE FOLDER
#
# SKYLINE: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). CAMOUFLAGE: a folder with model_save.obj and its
# atlas, and exterior_face.txt (SeRAlab/Robust-and-Accurate-UV-map-based-Camouflage-Attack).
set -euo pipefail
if [ $# -ne 3 ]; then
    echo "usage: $0 SKYLINE CAMOUFLAGE FOLDER" >&2
    exit 2
fi
run="$(dirname "$0")/../run"
pattern="$(dirname "$0")/../print_templates/random16.png"
folder=$3
mkdir -p "$folder"
skyline=(--mesh "$1" --material Material.001 --length-mm 455)
etron=(--mesh "$2/model_save.obj" --faces "$2/exterior_face.txt" --length-mm 490)
views=(--light courtyard sunrise@60 --pitch-deg 10 25 --size-px 256x192 --detector yolox_nano)
"$run" texture bake "${skyline[@]}" --pattern "$pattern" --tile-mm 240 -o "$folder/baked.png"
"$run" attack evaluate "${skyline[@]}" --normal 808080 --pattern tile="$pattern" --tile-mm 240 --texture baked="$folder/baked.obj" \
    "${views[@]}" --azimuth-deg every30 --distance-mm 900 1300 -o "$folder/skyline"
"$run" attack evaluate "${etron[@]}" --normal 808080 --pattern random="$pattern" --tile-mm 240 --texture camouflage="$2/model_save.obj" \
    "${views[@]}" --azimuth-deg every60 --distance-mm 1000 -o "$folder/camouflage"

#!/usr/bin/env bash
# What paints and a printer cost: two patterns of 118 mm each that are free, that end on twelve paints, and that are optimised for a printer; the free ones
# also as that printer prints them. Each step goes on where it was stopped. An hour on two cores.
#
#   benches/attack_printed.sh MESH FRAMES FOLDER [STEPS]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); FRAMES: those of benches/attack_frames.sh. The printer is the
# simulated one of print_templates/printer_plain_paper.toml.
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 MESH FRAMES FOLDER [STEPS]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
run=$home/run mesh=$1 frames=("$2"/{0,1,2,3,4,5,6,7,8,9,10,11}) folder=$3 steps=${4:-600}
paints=$home/print_templates/paints12.toml printer=$home/print_templates/printer_plain_paper.toml
patterns=()
for seed in 1 2; do
    made=(attack run "${frames[@]}" --detector yolox_nano --cells 16 --steps "$steps" --seed $seed)
    "$run" "${made[@]}" -o "$folder/free_$seed"
    "$run" "${made[@]}" --palette "$paints" -o "$folder/paints_$seed"
    "$run" "${made[@]}" --printer "$printer" -o "$folder/printer_$seed"
    for kind in free printer; do
        "$run" pattern check "$folder/${kind}_$seed/pattern.png" --printer "$printer" -o "$folder/${kind}_$seed/printed.png"
    done
    patterns+=(free_$seed="$folder/free_$seed/pattern.png" paints_$seed="$folder/paints_$seed/pattern.png"
        free_printed_$seed="$folder/free_$seed/printed.png" printer_printed_$seed="$folder/printer_$seed/printed.png")
done
"$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --tile-mm 118 --light courtyard sunrise@60 \
    --azimuth-deg every30 --pitch-deg 0 15 30 --distance-mm 900 1200 1500 --field-of-view-deg 40 --detector yolox_nano -o "$folder/evaluation" \
    --pattern "${patterns[@]}"

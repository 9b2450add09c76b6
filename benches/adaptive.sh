#!/usr/bin/env bash
# Does a pattern that was made knowing a defence beat it? For each seed a pattern made without, and one for each defence (`attack run --augment`), alike in all
# else; rendered at the paper's 108 viewpoints in a light that none was made in, and scored under all defences. Each step goes on where it was stopped. A pattern
# takes some 3 minutes of one core at 60 steps, its photos 2, scoring them under three defences half a minute.
#
#   benches/adaptive.sh MESH DETECTOR FRAMES FOLDER [STEPS] [SEED…]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); DETECTOR: a name or a manifest with its weights; FRAMES: a folder of
# folders of frames (benches/attack_frames.sh). FOLDER/defended/defences.csv has every drop from the plain car, FOLDER/seed_N/defences.csv from the pattern of
# that seed that knows no defence. DEFENCES names others than these.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: $0 MESH DETECTOR FRAMES FOLDER [STEPS] [SEED…]" >&2
    exit 2
fi
here=$(dirname "$0")
run=${SCALEPROOF:-"$here/../run"}
mesh=$1 detector=$2 frames=("$3"/*/) folder=$4 steps=${5:-60}
seeds=("${@:6}")
[ ${#seeds[@]} -gt 0 ] || seeds=(1)
read -ra defences <<<"${DEFENCES:-crops=5 jpeg=75 median=3}"
patterns=(random="$here/../print_templates/random16.png")
for seed in "${seeds[@]}"; do
    for knows in unaware "${defences[@]}"; do
        name=${knows/=/}_$seed
        [ "$knows" = unaware ] && augment=() || augment=(--augment "$knows")
        "$run" attack run "${frames[@]}" --detector "$detector" --steps "$steps" --seed "$seed" ${augment[@]+"${augment[@]}"} -o "$folder/$name"
        patterns+=("$name=$folder/$name/pattern.png")
    done
done
"$run" attack evaluate --mesh "$mesh" --material Material.001 --length-mm 455 --normal 808080 --tile-mm 118 --detector "$detector" --light courtyard \
    --azimuth-deg every30 --pitch-deg 0 15 30 --distance-mm 500 1000 1500 --field-of-view-deg 68 --size-px 256x192 --samples 4 \
    --pattern "${patterns[@]}" -o "$folder/judged"
score() { "$run" score "$folder/judged/session" --detector "$detector" --defence "$(IFS=,; echo "${defences[*]}")" "$@"; }
score -o "$folder/defended"
for seed in "${seeds[@]}"; do
    score --base "unaware_$seed" -o "$folder/seed_$seed"
done

#!/usr/bin/env bash
# Patterns of 118 mm made on one car and on three, judged on two cars that neither was made on: yolox_nano, the same number of views (144) and images, two seeds.
# Each step goes on where it was stopped. Half an hour on two cores.
#
#   benches/attack_cars.sh MESH OTHER TORCS FOLDER [STEPS]
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); OTHER: a folder with model_save.obj and exterior_face.txt
# (SeRAlab/Robust-and-Accurate-UV-map-based-Camouflage-Attack); TORCS: usr/share/games/torcs/cars of Debian's package torcs-data (`apt-get download torcs-data`,
# `dpkg-deb -x`), cars under the Free Art License and the GPL. The three cars: the Skyline and two coupés of TORCS, each in a third of the first six lots of
# benches/attack_frames.sh; the cars held out: the e-tron and a saloon of TORCS. FOLDER/etron and FOLDER/p406 have the tables; their differences.csv each pair of
# patterns with its interval. PYTHON needs Pillow.
set -euo pipefail
if [ $# -lt 4 ]; then
    echo "usage: $0 MESH OTHER TORCS FOLDER [STEPS]" >&2
    exit 2
fi
here=$(dirname "$0")
run="$here/../run"
mesh=$1 other=$2 torcs=$3 folder=$4 steps=${5:-300}
game() { # NAME LENGTH_MM: what describes a car of the game
    model=(--mesh "$folder/cars/$1.obj" --material paint --length-mm "$2" --mesh-front +x --mesh-up +y)
}
"${PYTHON:-python3}" "$here/torcs_cars.py" "$torcs" "$folder/cars"
LOTS="0 1 2 3 4 5" "$here/attack_frames.sh" "$folder/skyline" --mesh "$mesh" --material Material.001 --length-mm 455
one=("$folder"/skyline/{0,1,2,3,4,5}) three=("$folder"/skyline/{0,3})
lots=("1 4" "2 5") names=(car1-trb1 car4-trb1) lengths=(452 460)
for i in 0 1; do
    game "${names[$i]}" "${lengths[$i]}"
    LOTS=${lots[$i]} "$here/attack_frames.sh" "$folder/${names[$i]}" "${model[@]}"
    for lot in ${lots[$i]}; do
        three+=("$folder/${names[$i]}/$lot")
    done
done
"$run" attack baseline random "$folder/skyline/0" --detector yolox_nano -o "$folder/random"
patterns=(random="$folder/random/pattern.png")
for seed in 1 2; do
    "$run" attack run "${one[@]}" --detector yolox_nano --steps "$steps" --seed $seed -o "$folder/one_$seed"
    "$run" attack run "${three[@]}" --detector yolox_nano --steps "$steps" --seed $seed -o "$folder/three_$seed"
    patterns+=("one_$seed=$folder/one_$seed/pattern.png" "three_$seed=$folder/three_$seed/pattern.png")
done
evaluate() { # as attack_118mm.sh looks at the e-tron
    "$run" attack evaluate "$@" --normal 808080 --target yolox_nano --light courtyard sunrise@60 --azimuth-deg every30 --field-of-view-deg 40 \
        --pitch-deg 5 20 --distance-mm 1000 1400 --size-px 256x192 --detector yolox_nano,nanodet_m,fastestdet,deimv2_femto,deimv2_atto \
        --pattern "${patterns[@]}"
}
evaluate --mesh "$other/model_save.obj" --faces "$other/exterior_face.txt" --length-mm 490 -o "$folder/etron"
game p406 464
evaluate "${model[@]}" -o "$folder/p406"

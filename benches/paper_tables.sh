#!/usr/bin/env bash
# The experiment of DTA (Suryanto et al., CVPR 2022) from rendered frames to its tables, on detectors of its families that are to be had: YOLOv4-tiny and
# SSDLite as targets, seven others and a second car for the transfer. Rows: plain, random, CAMOU, ER, UPC and DAS (where their textures are given), DTA by its
# algorithm (its renderer DTN, its projection, its loss), DTA's published pattern, ours in two seeds, against each target and, on three cars, against both; then
# one pattern against all nine detectors at once.
#
#   benches/paper_tables.sh MESH MORE PUBLISHED TORCS FOLDER
#
# MESH: skyline_r32_lowpoly_ccby4.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0); MORE: a folder with yolov4_tiny.toml,
# ssdlite_mobilenet_v2_coco.toml, yolo_fastest_xl.toml, picodet_s_320.toml and their weights; PUBLISHED: DTA's pattern as a PNG; TORCS: as benches/attack_cars.sh
# has it, for the second car (p406). The weights of the five known detectors are looked up as usual. FOLDER/tables.md has the tables, FOLDER/times.tsv what each
# stage took. A stage that is done is skipped, one that was stopped goes on where it was (its time is then that of its last part). PYTHON needs PyTorch, numpy
# and Pillow.
#
# The environment sets the scale; what is not the same as in the paper stands above the tables:
#   PLACES 72        lights × turns that DTN learns from, at most 72, instead of 75 places; in each 8 azimuths at 500 mm and 15°, as in the paper
#   TEST_PLACES 8    other lights × turns in which DTN is tested, at most 24, instead of 50
#   DTN_PX 256       width of DTN's frames; the paper: 512
#   EPOCHS 60        of DTN, of 4 colours a view; the paper's 25 of 50 colours were 312
#   LOTS "0 … 11"    lots of 24 views that patterns are made on (benches/attack_frames.sh); the paper: 250 places
#   STEPS 300        of 8 views, for every attack; CAMOU and ER may look at as many images
#   NINE_STEPS 600   of the attack on all nine
#   LIGHTS           in which patterns are judged at the paper's 108 viewpoints: courtyard sunrise@60; the paper: 200 places
#   AZIMUTHS every30 of the 108 viewpoints: fewer to try the script
#   FRAME_PX 256, PHOTO_PX 320x240: sizes of these frames and of the photos; FRAME_SAMPLES 8, PHOTO_SAMPLES 8: paths a pixel, before denoising
#   UPC, DAS         textures that `attack evaluate --texture` takes; without them these rows are the paper's alone
set -euo pipefail
if [ $# -ne 5 ]; then
    echo "usage: $0 MESH MORE PUBLISHED TORCS FOLDER" >&2
    exit 2
fi
here=$(dirname "$0")
export SCALEPROOF=${SCALEPROOF:-"$here/../run"}
mesh=$1 more=$2 published=$3 torcs=$4 folder=$5
python=${PYTHON:-python3} steps=${STEPS:-300} lots=(${LOTS:-0 1 2 3 4 5 6 7 8 9 10 11}) lights=(${LIGHTS:-courtyard sunrise@60})
targets=(yolov4_tiny ssdlite_mobilenet_v2_coco)
known=yolox_nano,nanodet_m,fastestdet,deimv2_femto,deimv2_atto
nine=$more/yolov4_tiny.toml,$more/ssdlite_mobilenet_v2_coco.toml,$more/yolo_fastest_xl.toml,$more/picodet_s_320.toml,$known
model=(--mesh "$mesh" --material Material.001 --length-mm 455)
of_torcs=(--material paint --mesh-front +x --mesh-up +y)
second=(--mesh "$folder/cars/p406.obj" --length-mm 464 "${of_torcs[@]}")
mkdir -p "$folder/done"
echo "${PLACES:-72} lights × turns for DTN (frames of ${DTN_PX:-256} px, ${EPOCHS:-60} epochs), ${TEST_PLACES:-8} to test it;" \
    "patterns on $((24 * ${#lots[@]})) views of ${FRAME_PX:-256} px, $steps steps of 8 images each, ${NINE_STEPS:-600} against all nine;" \
    "judged in ${lights[*]}, photos of ${PHOTO_PX:-320x240} px, ${PHOTO_SAMPLES:-8} paths a pixel" >"$folder/scale.txt"

stage() { # NAME COMMAND…: unless it is done; with its time
    local name=$1 start=$SECONDS
    shift
    [ ! -e "$folder/done/$name" ] || return 0
    echo "== $name ($(date +%T))"
    "$@"
    printf '%s\t%s\n' "$name" "$((SECONDS - start))" >>"$folder/times.tsv"
    touch "$folder/done/$name"
}

places() { # COUNT FIRST_TURN LIGHT…: so many lights × turns, turns every 30°, all lights before the next turn
    local count=$1 first=$2
    shift 2
    for k in {0..11}; do
        for light in "$@"; do
            [ $((count--)) -gt 0 ] || return 0
            echo "$light@$((first + 30 * k))"
        done
    done
}

render_for_dtn() { # FOLDER PLACES COLOURS…
    local out=$1 where=$2
    shift 2
    # shellcheck disable=SC2086  # lists of lights
    "$SCALEPROOF" attack render "${model[@]}" --light $where --azimuth-deg every45 --pitch-deg 15 --distance-mm 500 --flat "$@" --size-px "${DTN_PX:-256}" \
        --field-of-view-deg 68 --samples "${FRAME_SAMPLES:-8}" --denoise -o "$out"
}

dtn_frames() {
    render_for_dtn "$folder/dtn_frames" "$(places "${PLACES:-72}" 15 forest sunset city studio interior night)" 000000 808080 ffffff
    render_for_dtn "$folder/dtn_test" "$(places "${TEST_PLACES:-8}" 5 courtyard sunrise)" 808080 c83214 1e78c8 465a28 e6d23c
}

train_dtn() { # with the error over whole images, as the paper has it, measured after it
    "$SCALEPROOF" attack train-dtn "$folder/dtn_frames" --validation "$folder/dtn_test" --epochs "${EPOCHS:-60}" -o "$folder/network.dtn"
    "$python" "$here/dtn_predicted.py" "$folder/network.dtn" "$folder/dtn_test" error >"$folder/dtn_error.json"
}

attack_frames() { # FOLDER LOTS MODEL…: with the camera of the judging, as in the paper: a car that is larger hardly shows a detector under random cells, and nothing is learnt from it
    local out=$1 lots=$2
    shift 2
    LOTS="$lots" FIELD_OF_VIEW_DEG=68 SIZE_PX=${FRAME_PX:-256} SAMPLES=${FRAME_SAMPLES:-8} "$here/attack_frames.sh" "$out" "$@"
}

frames_of_two_more() { # coupés of TORCS; the second car is none of them
    attack_frames "$folder/frames_car1-trb1" "1 4" --mesh "$folder/cars/car1-trb1.obj" --length-mm 452 "${of_torcs[@]}"
    attack_frames "$folder/frames_car4-trb1" "2 6" --mesh "$folder/cars/car4-trb1.obj" --length-mm 460 "${of_torcs[@]}"
}

predict() { # the attack's frames as DTN predicts them, from one grey image a view; and how well the closed form that is fitted to them stands for the network
    for lot in "${lots[@]}"; do
        "$python" "$here/dtn_predicted.py" "$folder/network.dtn" "$folder/frames/$lot" "$folder/predicted/$lot"
    done
    "$python" "$here/dtn_predicted.py" "$folder/network.dtn" "$folder/frames/${lots[0]}" "$folder/nine_colours" \
        000000 404040 808080 c0c0c0 ffffff 202020 606060 a0a0a0 e0e0e0
    "$SCALEPROOF" attack chart "$folder/nine_colours" --reference 000000 404040 808080 c0c0c0 ffffff -o "$folder/closed_form"
}

frames=("${lots[@]/#/$folder/frames/}") predicted=("${lots[@]/#/$folder/predicted/}")
attack() { "$SCALEPROOF" attack run "$@" --batch 8; }
search() { "$SCALEPROOF" attack baseline "$1" "${frames[@]}" --detector "$more/$2.toml" --cells 16 --queries $((8 * steps)) -o "$folder/$1_$2"; }
as_published() { # algorithm 1 of the paper: DTN, Repeated Texture Projection with its random pose, −ln(1 − C), views at random
    attack "${predicted[@]}" --detector "$more/$1.toml" --laying repeated --floor 0.5 --hard 0 --cells 16 --steps "$steps" -o "$folder/dta_$1"
}
ours() { attack "${frames[@]}" --detector "$more/$1.toml" --steps "$steps" --seed "$2" -o "$folder/ours_$1_$2"; }
against_both() { # both targets at once, on three cars
    attack "${frames[@]}" "$folder"/frames_car1-trb1/{1,4} "$folder"/frames_car4-trb1/{2,6} --detector "$more/${targets[0]}.toml,$more/${targets[1]}.toml" --steps "$steps" \
        --seed "$1" -o "$folder/both_$1"
}
against_all() { attack "${frames[@]}" --detector "$nine" --against worst --steps "${NINE_STEPS:-600}" -o "$folder/nine"; }

patterns=(random="$here/../print_templates/random16.png" published="$published")
for target in "${targets[@]}"; do
    for name in camou er dta; do
        patterns+=("${name}_$target=$folder/${name}_$target/pattern.png")
    done
    patterns+=("ours_${target}_1=$folder/ours_${target}_1/pattern.png" "ours_${target}_2=$folder/ours_${target}_2/pattern.png")
done
patterns+=(both_1="$folder/both_1/pattern.png" both_2="$folder/both_2/pattern.png")
stored=("$here"/../print_templates/patterns/{yolox_nano_118mm,three_convolutional}_1.png)
last=(nine="$folder/nine/pattern.png" stored_yolox_nano="${stored[0]}" stored_three_convolutional="${stored[1]}")
textures=()
[ -z "${UPC:-}" ] || textures+=(upc="$UPC")
[ -z "${DAS:-}" ] || textures+=(das="$DAS")
evaluate() { # FOLDER MODEL… -- PATTERN…
    local out=$1 car=()
    shift
    while [ "$1" != -- ]; do
        car+=("$1")
        shift
    done
    shift
    # shellcheck disable=SC2086  # a list of numbers
    "$SCALEPROOF" attack evaluate "${car[@]}" --normal 808080 --tile-mm 118 --target "${targets[0]},${targets[1]}" --detector "$nine" \
        --light "${lights[@]}" --azimuth-deg ${AZIMUTHS:-every30} --pitch-deg 0 15 30 --distance-mm 500 1000 1500 --field-of-view-deg 68 \
        --size-px "${PHOTO_PX:-320x240}" --samples "${PHOTO_SAMPLES:-8}" --pattern "$@" -o "$folder/$out"
}
on_target() { evaluate target "${model[@]}" ${textures[@]+--texture "${textures[@]}"} -- "$@"; }
on_second() { evaluate second "${second[@]}" -- "$@"; }
tables() { "$python" "$here/paper_tables.py" "$folder" >"$folder/tables.md.partial" && mv "$folder/tables.md.partial" "$folder/tables.md"; }

stage dtn_frames dtn_frames
stage train_dtn train_dtn
stage attack_frames attack_frames "$folder/frames" "${lots[*]}" "${model[@]}"
stage predict predict
for target in "${targets[@]}"; do
    stage "dta_$target" as_published "$target"
    stage "ours_${target}_1" ours "$target" 1
    stage "ours_${target}_2" ours "$target" 2
    stage "er_$target" search er "$target"
    stage "camou_$target" search camou "$target"
done
stage cars "$python" "$here/torcs_cars.py" "$torcs" "$folder/cars"
stage frames_of_two_more frames_of_two_more
stage both_1 against_both 1
stage both_2 against_both 2
stage judge_target on_target "${patterns[@]}"
tables
stage judge_second on_second "${patterns[@]}"
tables
stage nine against_all
stage judge_nine_target on_target "${patterns[@]}" "${last[@]}"
stage judge_nine_second on_second "${patterns[@]}" "${last[@]}"
tables
cat "$folder/tables.md"

# Sourced by train_dtn.sh and dtn_choices.sh, with $run set: the frames that DTN learns from, 110 views in twelve lights, and six in two other lights to test on.
#
#   dtn_frames MESH FOLDER WIDTH WIDTH_OF_TWO SAMPLES_OF_TWO
#
# FOLDER gets two, more, lights and test, WIDTH px wide; two may be wider, to be reduced, and have other samples.
dtn_frames() {
    local mesh=$1 folder=$2 width=$3 two=(--size-px "$4" --samples "$5") flat=(--flat 000000 808080 ffffff)
    render() {
        "$run" attack render --mesh "$mesh" --material Material.001 --length-mm 455 --field-of-view-deg 50 "$@"
    }
    render --light forest sunset@120 --azimuth-deg 22.5 67.5 112.5 157.5 202.5 247.5 292.5 337.5 --pitch-deg 8 22 --distance-mm 650 1100 "${flat[@]}" \
        "${two[@]}" -o "$folder/two"
    render --light studio@200 sunrise@90 forest@180 --azimuth-deg 0 55 125 180 235 310 --pitch-deg 15 --distance-mm 800 "${flat[@]}" --size-px "$width" \
        --samples 48 -o "$folder/more"
    render --light city city@150 night@60 studio@80 sunset@240 sunrise@200 forest@90 --azimuth-deg 20 110 200 290 --pitch-deg 12 --distance-mm 750 \
        "${flat[@]}" --size-px "$width" --samples 48 -o "$folder/lights"
    render --light courtyard interior@45 --azimuth-deg 10 140 260 --pitch-deg 15 --distance-mm 700 "${flat[@]}" c83214 1e78c8 465a28 e6d23c \
        --size-px "$width" --samples 64 -o "$folder/test"
}

#!/usr/bin/env bash
# What a filmed walk round the model gives, against the truth of the renderer: pose error, what sigma says of it, and how many frames are fit to be photos, by exposure (motion
# blur) and bit rate, with a read-out of 20 ms (rolling shutter). FOLDER/table.md and FOLDER/chart.svg; FOLDER/camera.md: the camera that the tags of each video give. A video that is there is
# not rendered again. Half an hour on two cores at 1280x720 and 6 s, half a round with four stops; hours at 1920x1080 and 12 s.
#
#   PYTHON=venv/bin/python benches/walk_around.sh MESH FOLDER [SIZE [SECONDS]]
#
# MESH: skyline_r32_lowpoly.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). PYTHON: one with what walk_around.py needs, and matplotlib. SCALEPROOF: another program than ./run.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER [SIZE [SECONDS]]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-python3} program=${SCALEPROOF:-$home/run} mesh=$1 folder=$2 size=${3:-1280x720} seconds=${4:-6}
mkdir -p "$folder"
# As much of a round of 12 s with a stop at each of eight sides as there is time.
degrees=$("$python" -c "print(30 * $seconds)") stops=$("$python" -c "print(8 / 12 * $seconds)")
film() { # NAME EXPOSURE_MS READOUT_MS MBIT...
    local name=$1 exposure=$2 readout=$3
    shift 3
    if [ ! -e "$folder/$name.done" ]; then
        "$python" "$home/benches/walk_around.py" "$folder/$name" --mesh "$mesh" --size "$size" --seconds "$seconds" --from-deg -22.5 --round-deg "$degrees" --steps "$stops" \
            --exposure-ms "$exposure" --readout-ms "$readout" --mbit "$@"
        touch "$folder/$name.done"
    fi
    for rate; do
        local video=${folder}/${name}_${rate}M
        [ -e "$video.session" ] || "$program" session from-video "$video.mp4" --scene "$home/captures/skyline/scene.toml" --camera "$folder/$name.camera.yaml" \
            --variant normal --place table --per-bin 1000 --apart 0 -o "$video.session" --json > "$video.json" || true
        "$program" calibrate "$video.mp4" --scene "$home/captures/skyline/scene.toml" --json > "$video.camera.json" 2> "$video.camera.txt" || true
    done
}
film blur_4_shutter_20 4 20 2 10 40
film blur_8_shutter_20 8 20 2 10 40
film blur_16_shutter_20 16.667 20 2 10 40
film blur_33_shutter_20 33.333 20 2 10 40
"$python" "$home/benches/walk_around_table.py" "$folder"

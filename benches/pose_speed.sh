#!/usr/bin/env bash
# From a photo's file to its pose: `scaleproof locate` against C AprilTag and OpenCV's ArUco in Python, whole programs, one core, same files.
#
#   python3 -m venv venv && venv/bin/pip install opencv-python-headless pupil-apriltags numpy
#   benches/pose_speed.sh FOLDER venv/bin/python [ROUNDS] [scaleproof]
#
# FOLDER is made and filled: the sixteen plain and random photos of captures/skyline three times, enlarged to 4000×3000 px, and spoiled copies of them (blur, motion,
# darkness, noise, small, windows, covered; seeds 1 to 3). In each of ROUNDS (5) rounds every program runs once on each set; the figures are
# medians of processor time a photo, start-up included, and their ratios to ours. Then what each answers of the spoiled photos.
set -euo pipefail
folder=$1 python=$2 rounds=${3:-5}
home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=${4:-${SCALEPROOF:-$home/target/release/scaleproof}}
session=$home/captures/skyline
peer=$home/benches/pose_speed.py
[ -d "$folder/spoiled" ] || "$python" "$peer" make "$session" "$folder"

ours() { "$program" locate "$2"/*.jpg --scene "$session/scene.toml" --camera "$session/camera.yaml" --json --quiet --tag-detector "$1" || true; }
theirs() { "$python" "$peer" locate "$session" "$2" "$1"; }
declare -A run=([cascade]=ours [coarse-to-fine]=ours [apriltag-1]=theirs [apriltag-2]=theirs [aruco]=theirs)
order=(cascade coarse-to-fine apriltag-1 apriltag-2 aruco)

for round in $(seq "$rounds"); do
  for set in clean large spoiled; do
    for name in "${order[@]}"; do
      TIMEFORMAT='%U %S'
      # One core: threads share it, so that processor time is what one core takes.
      { time taskset -c 0 bash -c "$(declare -f ours theirs); $(declare -p program session python peer); ${run[$name]} $name $folder/$set" \
        >"$folder/$set.$name.json" 2>/dev/null; } 2>"$folder/time"
      awk -v set="$set" -v name="$name" -v n="$(ls "$folder/$set"/*.jpg | wc -l)" '{ print set, name, 1000 * ($1 + $2) / n }' "$folder/time"
    done
  done
done >"$folder/times.txt"
"$python" "$peer" table "$session" "$folder"

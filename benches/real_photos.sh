#!/usr/bin/env bash
# Real photos with independent truth, set by set: `scaleproof locate` beside C AprilTag and OpenCV's ArUco, each with SQPnP, as Markdown; then how many of
# the errors are within the stated σ, by one, two, three and more tags (`chart sigma`): of these sets, of the plain and random renders in captures/skyline, and of VIEWS
# (1000) simulated views for each number of tags.
#
#   python3 -m venv venv && venv/bin/pip install opencv-python-headless pupil-apriltags numpy
#   benches/real_photos.sh PHOTOS FOLDER venv/bin/python [scaleproof]
#
# PHOTOS: the shared material's photos/real, with the sets swatbotics, veldrovive, photonvision and aprilgrid; others' photos, of which nothing may be
# committed. FOLDER is made; its charts/sigma.svg is docs/chart_sigma.svg.
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 PHOTOS FOLDER PYTHON [scaleproof]" >&2
    exit 2
fi
photos=$1 folder=$2 python=$3
home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=${4:-${SCALEPROOF:-$home/target/release/scaleproof}}
"$python" "$home/benches/real_photos.py" table "$photos" "$program"
"$python" "$home/benches/real_photos.py" sessions "$photos" "$folder/sessions"
"$python" "$home/benches/two_textures.py" "$home/captures/skyline" "$folder/skyline"
sets=(--session "$folder/skyline" --truth "$folder/skyline/truth.json")
for session in "$folder"/sessions/*/*/; do
    sets+=(--session "$session" --truth "$session/truth.json")
done
echo
"$program" chart sigma "${sets[@]}" --views "${VIEWS:-1000}" -o "$folder/charts" --quiet
echo
"$python" "$home/benches/real_photos.py" sigma "$folder/charts" .

#!/usr/bin/env bash
# What a detector makes of a film's frames and of sharp stills at the same poses: frames chosen of the stored walk (captures/walk, --per-bin 3), and the same views drawn without blur and
# rolling shutter. Stills are drawn four times, with other noise and other places within the pixel, which says how much a score is worth; they are scored as a camera writes them (JPEG
# of quality 95 with colours of half the resolution, 4:2:0) and as drawn (PNG). FOLDER has the reports; the table goes to standard output. Ten minutes on two cores.
#
#   PYTHON=venv/bin/python benches/walk_stills.sh MESH FOLDER [DETECTOR...]
#
# MESH: skyline_r32_lowpoly.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). PYTHON: one with what walk_around.py needs. DETECTOR: names or manifests; all whose weights
# are here when none is given. SCALEPROOF: another program than ./run. DETECTORS: where the weights are, when not at their place. ROUND: instead of the stored walk a plain round of 30 s
# that `walk_around.py ROUND --mesh MESH --size 1280x720 --seconds 30 --mbit 10` made, with a frame of each view, or PER_BIN of them.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER [DETECTOR...]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-python3} program=${SCALEPROOF:-$home/run} mesh=$1 folder=$2 walk=$home/captures/walk
camera=$walk/camera.yaml per_bin=${PER_BIN:-3} variants=(normal random)
# As the film was made.
made=(--size 1280x720 --fps 12 --seconds 10 --from-deg -22.5 --round-deg 360 --steps 8 --pace 0.97 --exposure-ms 8 --readout-ms 10 --shake 0.5 --noise 1)
if [ -n "${ROUND:-}" ]; then
    camera=$ROUND.camera.yaml per_bin=${PER_BIN:-1} variants=(normal)
    made=(--size 1280x720 --seconds 30)
fi
shift 2
detectors=(${DETECTORS:+--detectors "$DETECTORS"})
for detector; do detectors+=(--detector "$detector"); done
draws=4
mkdir -p "$folder"
for variant in "${variants[@]}"; do
    film=$walk/$variant.mp4 && [ -z "${ROUND:-}" ] || film=${ROUND}_10M.mp4
    "$program" session from-video "$film" --scene "$walk/scene.toml" --camera "$camera" \
        --variant $variant --place table --per-bin "$per_bin" -o "$folder/session" --json > "$folder/$variant.json"
    mapfile -t frames < <("$python" -c 'import json, sys; print(*(one["frame"] for one in json.load(open(sys.argv[1]))["chosen"]), sep="\n")' "$folder/$variant.json")
    seed=1 && [ $variant = normal ] || seed=2
    mkdir -p "$folder/drawn"
    "$python" "$home/benches/walk_around.py" "$folder/drawn/$variant" --mesh "$mesh" --paint $variant --seed $seed "${made[@]}" --stills "${frames[@]}" --draws $draws
done
# A report for each draw, as views that are drawn twice would count once.
"$python" - "$folder" <<'PY'
import sys
from pathlib import Path

import cv2

folder = Path(sys.argv[1])
as_cameras = [cv2.IMWRITE_JPEG_QUALITY, 95, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420]
for still in sorted((folder / "drawn").glob("*.png")):
    variant, _, draw = still.stem.split("_")
    for kind, ending, options in (("jpeg", "jpg", as_cameras), ("png", "png", [])):
        path = folder / f"{kind}{draw}" / variant / f"{still.stem}.{ending}"
        path.parent.mkdir(parents=True, exist_ok=True)
        cv2.imwrite(str(path), cv2.imread(str(still)), options)
PY
"$program" score "$folder/session" "${detectors[@]}" -o "$folder/film" --json > "$folder/film.json"
for draw in $(seq 0 $((draws - 1))); do
    for kind in jpeg png; do
        stills=$folder/$kind$draw
        sets=() && for variant in "${variants[@]}"; do sets+=("$variant=$stills/$variant"); done
        "$program" score "${sets[@]}" --place table --scene "$walk/scene.toml" --camera "$camera" "${detectors[@]}" \
            -o "$stills.report" --json > "$stills.json"
    done
done
"$python" - "$folder" $draws <<'PY'
import json
import sys
from statistics import mean

folder, draws = sys.argv[1], range(int(sys.argv[2]))


def scored(report):
    return {(one["detector"], one["variant"]): one["overall"]["mean_confidence"] for one in json.load(open(f"{folder}/{report}.json"))["results"]}


film, stills = scored("film"), {kind: [scored(f"{kind}{draw}") for draw in draws] for kind in ("jpeg", "png")}
print("film − stills in mean confidence; in brackets the stills of one draw, from … to")
for which, of_film in film.items():
    parts = []
    for kind, reports in stills.items():
        of_draws = [report[which] for report in reports]
        parts.append(f"{kind} {of_film - mean(of_draws):+.3f} ({min(of_draws):.3f} … {max(of_draws):.3f})")
    print(f"{which[0]:16} {which[1]:8} film {of_film:.3f}  " + "  ".join(parts))
PY

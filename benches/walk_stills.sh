#!/usr/bin/env bash
# What a detector makes of a film's frames and of sharp stills at the same poses: the stored walk's chosen frames (captures/walk), and the same views drawn without blur, rolling
# shutter and compression. FOLDER/film and FOLDER/stills are the two reports; the table goes to standard output. Some minutes on two cores.
#
#   PYTHON=venv/bin/python benches/walk_stills.sh MESH FOLDER [DETECTOR...]
#
# MESH: skyline_r32_lowpoly.glb (low-poly Nissan Skyline R32 by W1ZZERZ, CC BY 4.0). PYTHON: one with what walk_around.py needs. DETECTOR: names or manifests; all whose weights
# are here when none is given. SCALEPROOF: another program than ./run.
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: $0 MESH FOLDER [DETECTOR...]" >&2
    exit 2
fi
home=$(cd "$(dirname "$0")/.." && pwd)
python=${PYTHON:-python3} program=${SCALEPROOF:-$home/run} mesh=$1 folder=$2 walk=$home/captures/walk
shift 2
detectors=()
for detector; do detectors+=(--detector "$detector"); done
mkdir -p "$folder"
for variant in normal random; do
    "$program" session from-video "$walk/$variant.mp4" --scene "$walk/scene.toml" --camera "$walk/camera.yaml" \
        --variant $variant --place table -o "$folder/session" --json > "$folder/$variant.json"
    mapfile -t frames < <("$python" -c 'import json, sys; print(*(one["frame"] for one in json.load(open(sys.argv[1]))["chosen"]), sep="\n")' "$folder/$variant.json")
    mkdir -p "$folder/$variant"
    # As captures/walk was made.
    seed=1 && [ $variant = normal ] || seed=2
    "$python" "$home/benches/walk_around.py" "$folder/$variant/still" --mesh "$mesh" --paint $variant --seed $seed --size 1280x720 --fps 12 --seconds 10 --from-deg -22.5 --round-deg 360 \
        --steps 8 --pace 0.97 --exposure-ms 8 --readout-ms 10 --shake 0.5 --noise 1 --stills "${frames[@]}"
done
"$program" score "$folder/session" "${detectors[@]}" -o "$folder/film" --json > "$folder/film.json"
"$program" score normal="$folder/normal" random="$folder/random" --place table --scene "$walk/scene.toml" --camera "$walk/camera.yaml" "${detectors[@]}" \
    -o "$folder/stills" --json > "$folder/stills.json"
"$python" - "$folder/film.json" "$folder/stills.json" <<'PY'
import json, sys
film, stills = ({(one["detector"], one["variant"]): one["overall"]["mean_confidence"] for one in json.load(open(path))["results"]} for path in sys.argv[1:])
for which in film:
    print(f"{which[0]:28} {which[1]:8} film {film[which]:.3f}  stills {stills[which]:.3f}  {film[which] - stills[which]:+.3f}")
differences = [film[which] - stills[which] for which in film]
print(f"mean difference {sum(differences) / len(differences):+.3f}, largest {max(differences, key=abs):+.3f}")
PY

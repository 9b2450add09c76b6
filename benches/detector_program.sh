#!/usr/bin/env bash
# Is a detector in Python scored as the built-in one? Scores the plain and random photos of the stored session with yolox_nano by ONNX Runtime in Python
# (python/examples/onnxruntime_yolox.py) and in this program, and compares every detection.
#
#   python3 -m venv venv && venv/bin/pip install onnxruntime==1.31.1 'opencv-python-headless<5' numpy
#   PYTHON=venv/bin/python benches/detector_program.sh yolox_nano.onnx [scaleproof]
set -euo pipefail

home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
weights=$(realpath "$1")
program=${2:-$home/run}
python=${PYTHON:-python3}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

export PYTHONPATH="$home/python"
"$python" "$home/benches/two_textures.py" "$home/captures/skyline" "$out/skyline"
score() { "$program" --quiet score "$out/skyline" "$@" --cache "$out/cache" >/dev/null; }
score --detector yolox_nano --detectors "$(dirname "$weights")" -o "$out/own"
score --detector "exec:$python $home/python/examples/onnxruntime_yolox.py $weights" -o "$out/python"
"$python" - "$out" <<'PYTHON'
import json, sys

own, other = ([json.load(open(f"{sys.argv[1]}/{folder}/{file}")) for file in ("summary.json", "coco_results_yolox_nano.json")] for folder in ("own", "python"))
pairs = list(zip(own[1], other[1]))
alike = [(a, b) for a, b in pairs if (a["image_id"], a["category_id"]) == (b["image_id"], b["category_id"])]
print(f"{len(own[1])} detections in Rust, {len(other[1])} in Python, {len(alike)} of one image and label at one rank")
print("largest difference: score %.6f, box %.2f px" % (
    max(abs(a["score"] - b["score"]) for a, b in alike),
    max(abs(x - y) for a, b in alike for x, y in zip(a["bbox"], b["bbox"])),
))
for a, b in zip(own[0]["results"], other[0]["results"]):
    figures = [[r["overall"]["ap50"], r["overall"]["hit_rate"]["count"], round(r["overall"]["mean_confidence"], 5)] for r in (a, b)]
    print(a["variant"], *figures, "same" if figures[0] == figures[1] else "DIFFERENT")
PYTHON

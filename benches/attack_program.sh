#!/usr/bin/env bash
# Do gradients of another framework make the same pattern? Attacks yolox_nano on the stored frames for four steps, once with the gradients of
# this program and once with those of JAX (python/examples/jax_yolox.py) from the same weights, and compares every cell and every step's loss.
#
#   python3 -m venv venv && venv/bin/pip install jax onnx numpy pillow
#   PYTHON=venv/bin/python benches/attack_program.sh yolox_nano.onnx [scaleproof]
set -euo pipefail

home=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
weights=$(realpath "$1")
program=${2:-$home/run}
python=${PYTHON:-python3}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

export PYTHONPATH="$home/python"
attack() { "$program" --quiet attack run "$home/captures/skyline_attack" --cells 16 --steps 4 "$@" >/dev/null; }
attack --detector yolox_nano --detectors "$(dirname "$weights")" -o "$out/own"
attack --detector "exec:$python $home/python/examples/jax_yolox.py $weights" -o "$out/jax"
"$python" - "$out" <<'PYTHON'
import json, sys
import numpy as np
from PIL import Image

folders = [f"{sys.argv[1]}/{name}" for name in ("own", "jax")]
own, jax = (np.asarray(Image.open(f"{folder}/pattern.png").convert("RGB")).astype(int) for folder in folders)
print(f"{(own == jax).all(-1).sum()} of {own.shape[0] * own.shape[1]} cells are the same, largest difference {abs(own - jax).max()} of 255")
for a, b in zip(*(json.load(open(f"{folder}/history.json"))["entries"] for folder in folders)):
    print(f"step {a['step']}: loss {a['loss']:.7f} and {b['loss']:.7f}, {abs(b['loss'] / a['loss'] - 1):.1e} of it; held out {a['held_out']} and {b['held_out']}")
PYTHON

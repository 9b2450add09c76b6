"""A pattern as a texture of the model's six sides, some of them grey, or each printed a little beside its place.

    venv/bin/python benches/as_sides.py PATTERN.png OUT.png [--tile-mm MM] [--bare SIDE …] [--off-mm MM --seed N]

The sides are left, right, roof, front, rear and bottom. `--bare` leaves sides grey (808080). With `--off-mm` every side's pattern is shifted by that much
in a random direction. Without `--tile-mm` PATTERN.png's card says how wide a repeat is; OUT.png gets a card that says "sides", so that `attack evaluate
--texture` takes it. Needs numpy and opencv-python-headless. `benches/attack_sweeps.sh` uses it.
"""

import argparse
import hashlib
import json
from pathlib import Path

import cv2
import numpy as np

SIDES = ["left", "right", "roof", "front", "rear", "bottom"]
# Shifts are rounded to this share of a cell.
PARTS = 4


def shifted(cells, cell_mm, off_mm, rng):
    """The pattern with PARTS pixels along a cell's side, moved in a random direction."""
    fine = cells.repeat(PARTS, axis=0).repeat(PARTS, axis=1)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    pixels = np.rint(PARTS * off_mm / cell_mm * np.array([np.cos(angle), np.sin(angle)])).astype(int)
    return np.roll(fine, tuple(pixels), axis=(0, 1))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("pattern", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--tile-mm", type=float)
    parser.add_argument("--bare", nargs="*", choices=SIDES, default=[])
    parser.add_argument("--off-mm", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    cells = cv2.imread(str(args.pattern), cv2.IMREAD_COLOR)
    tile_mm = args.tile_mm or json.loads(args.pattern.with_suffix(".json").read_text())["tile_mm"]
    rng = np.random.default_rng(args.seed)
    cell_mm = tile_mm / cells.shape[1]
    own = [shifted(cells, cell_mm, args.off_mm, rng) if args.off_mm else cells for _ in SIDES]
    own = [np.full_like(side, 128) if name in args.bare else side for name, side in zip(SIDES, own)]
    _, png = cv2.imencode(".png", np.vstack(own))
    args.out.write_bytes(png.tobytes())
    about = {"pattern_sha256": hashlib.sha256(png.tobytes()).hexdigest(), "tile_mm": tile_mm, "sides": True}
    args.out.with_suffix(".json").write_text(json.dumps(about, indent=2) + "\n")


if __name__ == "__main__":
    main()

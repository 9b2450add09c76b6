"""The images that tests/defences.rs holds `score --defence` against, made of tests/data/corruptions/piece.png by others' code.

    python -m venv venv && venv/bin/pip install numpy scipy pillow
    venv/bin/python tests/data/make_defences.py

The median is scipy's, as in the code of Xu et al. (2018), the rounding of values their formula, the JPEG Pillow's, as in Guo et al. (2018).
"""

import io
from pathlib import Path

import numpy as np
from PIL import Image
from scipy import ndimage

DATA = Path(__file__).resolve().parent
OUT = DATA / "defences"


def main():
    piece = np.array(Image.open(DATA / "corruptions/piece.png").convert("RGB"))
    OUT.mkdir(exist_ok=True)
    for side in (2, 3, 4):
        save(f"median_{side}", ndimage.median_filter(piece, size=(side, side, 1), mode="reflect"))
    for bits in (3, 5):
        steps = 2**bits - 1
        save(f"bit_depth_{bits}", np.rint(255 * (np.rint(piece / 255 * steps) / steps)).astype(np.uint8))
    jpeg = io.BytesIO()
    Image.fromarray(piece).save(jpeg, format="jpeg", quality=75)
    save("jpeg_75", np.array(Image.open(jpeg)))


def save(name, image):
    Image.fromarray(image).save(OUT / f"{name}.png", optimize=True)


if __name__ == "__main__":
    main()

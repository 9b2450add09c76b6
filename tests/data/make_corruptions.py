"""The images that tests/corruptions.rs holds `score --corrupt` against: a piece of a stored photo, as the published code makes it worse.

    python -m venv venv && venv/bin/pip install imagecorruptions opencv-python-headless "setuptools<81"
    venv/bin/python tests/data/make_corruptions.py

imagecorruptions 1.1.2 (Michaelis et al. 2019) has the functions of ImageNet-C for images of any size. Noise and fog are random: of 600 images the mean
and the standard deviation are printed (averages and how far they vary from image to image), for the test.
"""

from pathlib import Path

import cv2
import numpy as np

np.float_ = np.float64  # which imagecorruptions 1.1.2 still calls so

from imagecorruptions import corrupt  # noqa: E402

HOME = Path(__file__).resolve().parents[2]
OUT = HOME / "tests/data/corruptions"
EXACT = [("defocus_blur", 2), ("defocus_blur", 5), ("brightness", 3), ("pixelate", 1), ("pixelate", 4), ("jpeg_compression", 1), ("jpeg_compression", 5)]


def main():
    photo = cv2.imread(str(HOME / "captures/skyline/random_010.jpg"))[300:620, 400:880]
    piece = cv2.resize(photo, (60, 40), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(OUT / "piece.png"), piece)
    rgb = cv2.cvtColor(piece, cv2.COLOR_BGR2RGB)
    for name, severity in EXACT:
        worse = corrupt(rgb, corruption_name=name, severity=severity)
        cv2.imwrite(str(OUT / f"{name}_{severity}.png"), cv2.cvtColor(worse, cv2.COLOR_RGB2BGR))
    for name in ("gaussian_noise", "fog"):
        for severity in (1, 5):
            np.random.seed(1)
            many = np.array([corrupt(rgb, corruption_name=name, severity=severity) for _ in range(600)], dtype=float)
            means, sigmas = many.mean(axis=(1, 2, 3)), many.std(axis=(1, 2, 3))
            print(f"{name} {severity}: mean {means.mean():.2f} ± {means.std():.2f}, σ {sigmas.mean():.2f} ± {sigmas.std():.2f}")


if __name__ == "__main__":
    main()

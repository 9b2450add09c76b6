"""Makes tests/data/jpeg: JPEGs of every kind that cameras and programs write, and the pixels that libjpeg-turbo (in OpenCV) makes of them.

    python -m venv venv && venv/bin/pip install opencv-python-headless numpy pillow && venv/bin/python tests/data/make_jpegs.py

Each NAME.jpg has its colours in NAME.png and its luma in NAME.luma.png; `inks.jpg` is a CMYK image of Pillow, whose inks follow from their place.
"""

from pathlib import Path

import cv2
import numpy as np
from PIL import Image

FOLDER = Path(__file__).parent / "jpeg"
SAMPLING = {
    "444": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
    "422": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422,
    "420": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
    "411": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_411,
    "440": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_440,
}


def picture(width, height):
    """Waves, an edge, saturated colours and noise."""
    random = np.random.default_rng(width)
    y, x = np.mgrid[:height, :width]
    waves = [127 + 120 * np.sin(x / (3 + k) + y / (5 - k) + k) for k in range(3)]
    colours = np.stack(waves, -1) + random.normal(0, 6, (height, width, 3))
    colours[:, width // 2 : width // 2 + 6] = [250, 5, 5]
    colours[height // 3 : height // 3 + 3] = 255
    return colours.clip(0, 255).astype(np.uint8)


def save(name, pixels, *options):
    encoded = cv2.imencode(".jpg", pixels, [int(option) for option in options])[1]
    (FOLDER / f"{name}.jpg").write_bytes(encoded.tobytes())
    cv2.imwrite(str(FOLDER / f"{name}.png"), cv2.imdecode(encoded, cv2.IMREAD_COLOR))
    cv2.imwrite(str(FOLDER / f"{name}.luma.png"), cv2.imdecode(encoded, cv2.IMREAD_GRAYSCALE))


FOLDER.mkdir(exist_ok=True)
quality, progressive, restarts = cv2.IMWRITE_JPEG_QUALITY, cv2.IMWRITE_JPEG_PROGRESSIVE, cv2.IMWRITE_JPEG_RST_INTERVAL
for sampling, value in SAMPLING.items():
    save(f"{sampling}_odd", picture(61, 45), quality, 90, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, value)
    save(f"{sampling}_progressive", picture(53, 39), quality, 85, progressive, 1, cv2.IMWRITE_JPEG_SAMPLING_FACTOR, value)
save("best", picture(48, 40), quality, 100)
save("coarse", picture(64, 48), quality, 12)
save("restarts", picture(75, 50), quality, 92, restarts, 3)
save("restarts_progressive", picture(75, 51), quality, 92, restarts, 2, progressive, 1)
save("grey", picture(43, 37)[:, :, 1], quality, 90)
save("grey_progressive", picture(43, 38)[:, :, 1], quality, 90, progressive, 1)
save("tiny", picture(3, 2), quality, 90)
save("wide", picture(130, 1), quality, 90)

y, x = np.mgrid[:24, :32]
# Pillow stores inks inverted, as Adobe's programs do.
inks = np.stack([255 - 8 * x, 255 - 10 * y, np.full_like(x, 165), np.full_like(x, 55)], -1)
Image.fromarray(inks.astype(np.uint8), "CMYK").save(FOLDER / "inks.jpg", quality=95)

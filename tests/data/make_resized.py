"""What Pillow and OpenCV make of a small picture at other sizes: `python make_resized.py` beside this file, with Pillow 13.0.0 and OpenCV 5.0.0 of PyPI.

A file `FILTER_WxH.bin` has the picture's bytes, row after row of red, green, blue."""

import pathlib

import cv2
import numpy
from PIL import Image, __version__

folder = pathlib.Path(__file__).parent / "resized"
# Smooth parts, edges and noise from a generator that a test can repeat.
state, rows = 1, bytearray()
for y in range(37):
    for x in range(53):
        state = (state * 1103515245 + 12345) % 2**31
        noise = state >> 23
        edge = 255 if (x // 5 + y // 7) % 2 else 0
        rows += bytes([noise, edge, (3 * x + 2 * y) % 256])
picture = Image.frombytes("RGB", (53, 37), bytes(rows))
for name, filter in [("box", Image.BOX), ("bilinear", Image.BILINEAR), ("bicubic", Image.BICUBIC)]:
    for size in [(20, 11), (53, 12), (7, 37), (106, 74), (61, 30)]:
        (folder / f"{name}_{size[0]}x{size[1]}.bin").write_bytes(picture.resize(size, filter).tobytes())
for size in [(20, 11), (61, 30)]:
    made = cv2.resize(numpy.asarray(picture), size, interpolation=cv2.INTER_CUBIC)
    (folder / f"opencv_cubic_{size[0]}x{size[1]}.bin").write_bytes(made.tobytes())
print("Pillow", __version__, "OpenCV", cv2.__version__)

"""What OpenCV's cubic resizing makes of a small picture: `python make_resized.py` beside this file, with OpenCV 5.0.0 of PyPI.

A file `opencv_cubic_WxH.bin` has the picture's bytes, row after row."""

import pathlib

import cv2
import numpy

folder = pathlib.Path(__file__).parent / "resized"
# Smooth parts, edges and noise from a generator that a test can repeat.
state, rows = 1, bytearray()
for y in range(37):
    for x in range(53):
        state = (state * 1103515245 + 12345) % 2**31
        noise = state >> 23
        edge = 255 if (x // 5 + y // 7) % 2 else 0
        rows += bytes([noise, edge, (3 * x + 2 * y) % 256])
picture = numpy.frombuffer(bytes(rows), numpy.uint8).reshape(37, 53, 3)
for size in [(20, 11), (61, 30)]:
    made = cv2.resize(picture, size, interpolation=cv2.INTER_CUBIC)
    (folder / f"opencv_cubic_{size[0]}x{size[1]}.bin").write_bytes(made.tobytes())
print("OpenCV", cv2.__version__)

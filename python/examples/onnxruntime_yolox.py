"""YOLOX in ONNX Runtime, as the built-in yolox_nano: the same figures by another program.

    pip install onnxruntime 'opencv-python-headless<5' ./python
    scaleproof score SESSION --detector 'exec:python3 python/examples/onnxruntime_yolox.py yolox_nano.onnx' -o report
"""

import sys

import scaleproof_detector  # first: it keeps standard output for itself
import cv2
import numpy as np
import onnxruntime

SIZE, NMS_IOU, FLOOR = 416, 0.45, 0.001
weights = sys.argv[1]
options = onnxruntime.SessionOptions()
options.intra_op_num_threads = 1
session = onnxruntime.InferenceSession(weights, options, providers=["CPUExecutionProvider"])
grids = [(SIZE // stride, stride) for stride in (8, 16, 32)]
cells = np.concatenate([np.stack(np.meshgrid(range(n), range(n)), -1).reshape(-1, 2) for n, _ in grids])
strides = np.concatenate([np.full((n * n, 1), stride) for n, stride in grids])


def detect(image):
    height, width = image.shape[:2]
    ratio = min(SIZE / width, SIZE / height)
    resized = cv2.resize(image, (int(width * ratio), int(height * ratio)), interpolation=cv2.INTER_LINEAR)
    padded = np.full((SIZE, SIZE, 3), 114, np.float32)
    padded[: resized.shape[0], : resized.shape[1]] = resized[..., ::-1]
    (rows,) = session.run(None, {session.get_inputs()[0].name: padded.transpose(2, 0, 1)[None]})[0]
    centre = (rows[:, :2] + cells) * strides
    half = np.exp(rows[:, 2:4]) * strides / 2
    boxes = np.concatenate([centre - half, centre + half], 1)
    labels = rows[:, 5:].argmax(1)
    scores = rows[:, 4] * rows[:, 5:].max(1)
    limit = np.array([width, height, width, height])
    for label in np.unique(labels):
        for row in kept(boxes, np.where(labels == label, scores, 0)):
            yield label, scores[row], np.clip(boxes[row] / ratio, 0, limit)


def kept(boxes, scores):
    """The rows of one label that no better box covers, best first."""
    order = [row for row in np.argsort(-scores, kind="stable") if scores[row] >= FLOOR]
    chosen = []
    for row in order:
        if all(iou(boxes[row], boxes[other]) <= NMS_IOU for other in chosen):
            chosen.append(row)
    return chosen


def iou(a, b):
    inner = np.maximum(0, np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2])).prod()
    return inner / ((a[2:] - a[:2]).prod() + (b[2:] - b[:2]).prod() - inner)


scaleproof_detector.run(
    detect,
    name="yolox_nano",
    version=f"onnxruntime {onnxruntime.__version__}, OpenCV {cv2.__version__}",
    labels="coco80",
    files=[weights],
    deterministic=True,
)

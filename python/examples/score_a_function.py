"""YOLOX in ONNX Runtime as a function of this process: the same figures as the built-in yolox_nano.

    pip install scaleproof 'opencv-python-headless<5'
    python score_a_function.py SESSION yolox_nano.onnx
"""

import sys
from collections.abc import Iterator

import cv2
import numpy as np
import numpy.typing as npt
import onnxruntime

import scaleproof

SIZE, NMS_IOU, FLOOR = 416, 0.45, 0.001
Floats = npt.NDArray[np.float32]


class Yolox:
    def __init__(self, weights: str) -> None:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        self.network = onnxruntime.InferenceSession(weights, options, providers=["CPUExecutionProvider"])
        self.name = self.network.get_inputs()[0].name
        grids = [(SIZE // stride, stride) for stride in (8, 16, 32)]
        cells = [np.stack(np.meshgrid(np.arange(n), np.arange(n)), -1).reshape(-1, 2) for n, _ in grids]
        self.cells, self.strides = np.concatenate(cells), np.concatenate([np.full((n * n, 1), stride) for n, stride in grids])

    def __call__(self, images: list[npt.NDArray[np.uint8]]) -> list[list[scaleproof.Found]]:
        return [list(self.find(image)) for image in images]

    def find(self, image: npt.NDArray[np.uint8]) -> Iterator[scaleproof.Found]:
        height, width = image.shape[:2]
        ratio = min(SIZE / width, SIZE / height)
        resized = cv2.resize(image, (int(width * ratio), int(height * ratio)), interpolation=cv2.INTER_LINEAR)
        padded = np.full((SIZE, SIZE, 3), 114, np.float32)
        padded[: resized.shape[0], : resized.shape[1]] = resized[..., ::-1]
        rows = self.network.run(None, {self.name: padded.transpose(2, 0, 1)[None]})[0][0]
        centre = (rows[:, :2] + self.cells) * self.strides
        half = np.exp(rows[:, 2:4]) * self.strides / 2
        boxes = np.concatenate([centre - half, centre + half], 1)
        labels, scores = rows[:, 5:].argmax(1), rows[:, 4] * rows[:, 5:].max(1)
        limit = np.array([width, height, width, height])
        for label in np.unique(labels):
            for row in kept(boxes, np.where(labels == label, scores, 0)):
                yield int(label), float(scores[row]), np.clip(boxes[row] / ratio, 0, limit).tolist()


def kept(boxes: Floats, scores: Floats) -> list[int]:
    """The rows of one label that no better box covers, best first."""
    order = [int(row) for row in np.argsort(-scores, kind="stable") if scores[row] >= FLOOR]
    chosen: list[int] = []
    for row in order:
        if all(iou(boxes[row], boxes[other]) <= NMS_IOU for other in chosen):
            chosen.append(row)
    return chosen


def iou(a: Floats, b: Floats) -> float:
    inner = np.maximum(0, np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2])).prod()
    return float(inner / ((a[2:] - a[:2]).prod() + (b[2:] - b[:2]).prod() - inner))


if __name__ == "__main__":
    session, weights = sys.argv[1:]
    detector = scaleproof.Detector(Yolox(weights), "yolox", version=f"onnxruntime {onnxruntime.__version__}", files=[weights], deterministic=True)
    print(scaleproof.score(session, detector))

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
            rest = np.flatnonzero((labels == label) & (scores >= FLOOR))
            rest = rest[np.argsort(-scores[rest], kind="stable")]
            while len(rest):
                best, rest = rest[0], rest[1:]
                yield int(label), float(scores[best]), np.clip(boxes[best] / ratio, 0, limit).tolist()
                rest = rest[ious(boxes[rest], boxes[best]) <= NMS_IOU]


def ious(boxes: Floats, box: Floats) -> Floats:
    sides = np.maximum(0, np.minimum(boxes[:, 2:], box[2:]) - np.maximum(boxes[:, :2], box[:2]))
    inner, areas = sides.prod(1), (boxes[:, 2:] - boxes[:, :2]).prod(1)
    found: Floats = inner / (areas + (box[2:] - box[:2]).prod() - inner)
    return found


if __name__ == "__main__":
    session, weights = sys.argv[1:]
    detector = scaleproof.Detector(Yolox(weights), "yolox", version=f"onnxruntime {onnxruntime.__version__}", files=[weights], deterministic=True)
    print(scaleproof.score(session, detector))

"""A straightforward Python pipeline over a session: OpenCV decodes, ONNX Runtime detects, pycocotools scores.

    python -m venv venv && venv/bin/pip install opencv-python-headless onnxruntime pycocotools numpy
    venv/bin/python benches/python_pipeline.py SESSION coco_truth.json yolox_nano.onnx --threads 2 [--pool] [--tags]

It is what `score_12_megapixels.sh` is held against. The truth boxes come from a `coco_truth.json` of `scaleproof score`, so nothing is
computed for them here; with --tags the photos' AprilTags are searched too (OpenCV's detector with corner refinement and one solvePnP), as a
pipeline without given truth would have to. With --pool photos are spread over threads with a session each; without it ONNX Runtime gets the
threads, as in most scripts.
"""

import argparse
import contextlib
import io
import json
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cv2
import numpy as np
import onnxruntime
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

SIZE = 416
CAR, CAR_CATEGORY = 2, 3
STRIDES = (8, 16, 32)


def session(model, threads):
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    return onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])


def grid():
    cells, strides = [], []
    for stride in STRIDES:
        n = SIZE // stride
        xs, ys = np.meshgrid(np.arange(n), np.arange(n))
        cells.append(np.stack([xs, ys], -1).reshape(-1, 2))
        strides.append(np.full((n * n, 1), stride))
    return np.concatenate(cells), np.concatenate(strides)


CELLS, CELL_STRIDES = grid()


def detect(net, picture):
    """COCO results (bbox, score) of cars in one BGR picture: letterbox, network, decoding, NMS."""
    height, width = picture.shape[:2]
    ratio = min(SIZE / width, SIZE / height)
    small = cv2.resize(picture, (int(width * ratio), int(height * ratio)), interpolation=cv2.INTER_LINEAR)
    canvas = np.full((SIZE, SIZE, 3), 114, np.uint8)
    canvas[: small.shape[0], : small.shape[1]] = small
    tensor = canvas.transpose(2, 0, 1)[None].astype(np.float32)
    (out,) = net.run(None, {net.get_inputs()[0].name: tensor})
    out = out[0]
    centres = (out[:, :2] + CELLS) * CELL_STRIDES / ratio
    sizes = np.exp(out[:, 2:4]) * CELL_STRIDES / ratio
    scores = out[:, 4:5] * out[:, 5:]
    labels = scores.argmax(1)
    best = scores.max(1)
    keep = (labels == CAR) & (best >= 0.001)
    corners = np.concatenate([centres - sizes / 2, centres + sizes / 2], 1)[keep]
    corners = np.clip(corners, 0, [width, height, width, height])
    boxes = np.concatenate([corners[:, :2], corners[:, 2:] - corners[:, :2]], 1)
    best = best[keep]
    kept = cv2.dnn.NMSBoxes(boxes.tolist(), best.tolist(), 0.001, 0.45)
    return [(boxes[i].tolist(), float(best[i])) for i in np.asarray(kept).flatten()[:100]]


def tag_finder():
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    return cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11), parameters)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("session", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("model")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--pool", action="store_true")
    parser.add_argument("--tags", action="store_true")
    args = parser.parse_args()
    began = time.perf_counter()
    photos = json.loads((args.session / "session.json").read_text())["photos"]
    truth = json.loads(args.truth.read_text())
    ids = {image["file_name"]: image["id"] for image in truth["images"]}
    cv2.setNumThreads(1 if args.pool else args.threads)
    workers = args.threads if args.pool else 1
    nets = [session(args.model, 1 if args.pool else args.threads) for _ in range(workers)]
    finders = [tag_finder() for _ in range(workers)]

    def share(worker):
        found = []
        for photo in photos[worker::workers]:
            picture = cv2.imread(str(args.session / photo["file"]))
            if args.tags:
                corners, _, _ = finders[worker].detectMarkers(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY))
                if corners:
                    square = np.array([[-25, 25, 0], [25, 25, 0], [25, -25, 0], [-25, -25, 0]], np.float64)
                    cv2.solvePnP(square, corners[0][0].astype(np.float64), np.diag([3687.5, 3687.5, 1.0]), None)
            for box, score in detect(nets[worker], picture):
                found.append({"image_id": ids[photo["file"]], "category_id": CAR_CATEGORY, "bbox": box, "score": score})
        return found

    with ThreadPoolExecutor(workers) as pool:
        results = [r for part in pool.map(share, range(workers)) for r in part]
    ap = {}
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO()
        coco.dataset = truth
        coco.createIndex()
        found = coco.loadRes(results)
        for variant in sorted({photo["variant"] for photo in photos}):
            evaluation = COCOeval(coco, found, "bbox")
            evaluation.params.imgIds = [image["id"] for image in truth["images"] if image["variant"] == variant]
            evaluation.params.catIds = [CAR_CATEGORY]
            evaluation.params.iouThrs = np.array([0.5])
            evaluation.evaluate()
            evaluation.accumulate()
            precision = evaluation.eval["precision"][0, :, 0, 0, -1]
            ap[variant] = round(float(precision[precision > -1].mean()), 3)
    seconds = time.perf_counter() - began
    print(json.dumps({"photos_per_s": round(len(photos) / seconds, 2), "photos": len(photos), "ap50": ap}))


main()

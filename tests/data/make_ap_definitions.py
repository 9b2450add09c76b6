#!/usr/bin/env python3
"""Makes ap_definitions.json: what numpy makes of ap_cases.json by the definitions that pycocotools does not have. Needs numpy."""
import json, os
import numpy as np

FOLDER = os.path.dirname(os.path.abspath(__file__))


def iou(a, b):
    w, h = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if w <= 0 or h <= 0:
        return 0.0
    both = w * h
    return both / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both)


def curve(c):
    """Precision and recall after each detection; greedy matching by score, of equal overlaps the later truth."""
    judged = []
    for image in c["images"]:
        free = [t["box"] for t in c["truth"] if t["image"] == image]
        own = [d for d in c["detections"] if d["image"] == image]
        for d in sorted(own, key=lambda d: -d["score"]):
            overlaps = [iou(d["box"], t) for t in free]
            right = bool(overlaps) and max(overlaps) >= c["iou"]
            if right:
                free.pop(max(i for i, o in enumerate(overlaps) if o == max(overlaps)))
            judged.append((d["score"], right))
    judged.sort(key=lambda j: -j[0])
    right = np.cumsum([j[1] for j in judged])
    return right / np.arange(1, len(judged) + 1), right / len(c["truth"])


def all_point(precision, recall):
    """Area under the envelope: rectangles between the recalls where it changes."""
    r, p = np.r_[0, recall, 1], np.r_[0, precision, 0]
    p = np.maximum.accumulate(p[::-1])[::-1]
    steps = np.flatnonzero(np.diff(r))
    return float(np.sum((r[steps + 1] - r[steps]) * p[steps + 1]))


def voc_11(precision, recall):
    best = [max(precision[recall >= i / 10], default=0) for i in range(11)]
    return float(np.mean(best))


def yolov5_ramp(precision, recall):
    """The envelope of (0, 1), the curve and (1, 0), sampled at 101 recalls by linear interpolation, by the trapezoidal rule."""
    r, p = np.r_[0, recall, 1], np.r_[1, precision, 0]
    p = np.maximum.accumulate(p[::-1])[::-1]
    x = np.linspace(0, 1, 101)
    return float(np.trapezoid(np.interp(x, r, p), x))


def evaluate(c):
    if not c["truth"]:
        return None
    if not c["detections"]:
        return {"all-point": 0, "voc-11": 0, "yolov5-ramp": 0}
    precision, recall = curve(c)
    return {"all-point": all_point(precision, recall), "voc-11": voc_11(precision, recall), "yolov5-ramp": yolov5_ramp(precision, recall)}


cases = json.load(open(f"{FOLDER}/ap_cases.json"))["cases"]
json.dump({"cases": [evaluate(c) for c in cases]}, open(f"{FOLDER}/ap_definitions.json", "w"), indent=0)

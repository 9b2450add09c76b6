#!/usr/bin/env python3
"""Makes ap_cases.json: random small AP cases and what pycocotools says of them. Needs numpy and pycocotools."""
import contextlib, io, json, os
import numpy as np
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

rng = np.random.default_rng(20261121)


def case():
    images = list(range(1, int(rng.integers(1, 9)) + 1))
    truth, detections = [], []
    for image in images:
        for _ in range(int(rng.integers(0, 3))):
            x, y, w, h = rng.uniform([0, 0, 30, 20], [400, 300, 200, 150])
            box = [x, y, x + w, y + h]
            truth.append({"image": image, "box": [round(v, 3) for v in box]})
            for _ in range(int(rng.integers(0, 4))):
                moved = [v + d for v, d in zip(box, rng.normal(0, 0.12 * w, 4))]
                if moved[2] > moved[0] and moved[3] > moved[1]:
                    # Few different scores, so that ties happen.
                    score = float(rng.choice([0.02, 0.2, 0.5, 0.9, round(rng.uniform(), 2)]))
                    detections.append({"image": image, "box": [round(v, 3) for v in moved], "score": score})
        for _ in range(int(rng.integers(0, 3))):
            x, y, w, h = rng.uniform([0, 0, 30, 20], [400, 300, 200, 150])
            detections.append({"image": image, "box": [round(v, 3) for v in (x, y, x + w, y + h)], "score": round(float(rng.uniform()), 2)})
    return {"images": images, "truth": truth, "detections": detections, "iou": float(rng.choice([0.5, 0.75]))}


def xywh(b):
    return [b[0], b[1], b[2] - b[0], b[3] - b[1]]


def evaluate(c):
    coco = COCO()
    coco.dataset = {
        "images": [{"id": i} for i in c["images"]],
        "categories": [{"id": 3, "name": "car"}],
        "annotations": [{"id": n + 1, "image_id": t["image"], "category_id": 3, "bbox": xywh(t["box"]),
                         "area": xywh(t["box"])[2] * xywh(t["box"])[3], "iscrowd": 0} for n, t in enumerate(c["truth"])]}
    coco.createIndex()
    results = [{"image_id": d["image"], "category_id": 3, "bbox": xywh(d["box"]), "score": d["score"]} for d in c["detections"]]
    if not results:
        return None
    e = COCOeval(coco, coco.loadRes(results), "bbox")
    e.params.iouThrs = np.array([c["iou"]])
    e.params.areaRng, e.params.areaRngLbl = [[0, 1e10]], ["all"]
    e.evaluate()
    e.accumulate()
    precision, recall = e.eval["precision"][0, :, 0, 0, -1], e.eval["recall"][0, 0, 0, -1]
    return float(np.mean(precision)), float(recall)


cases = []
while len(cases) < 25:
    c = case()
    with contextlib.redirect_stdout(io.StringIO()):
        result = evaluate(c)
    if result:
        c["ap_coco101"], c["recall"] = result
        cases.append(c)
path = os.path.join(os.path.dirname(__file__), "ap_cases.json")
with open(path, "w") as f:
    json.dump({"source": "pycocotools, by make_ap_cases.py", "cases": cases}, f, separators=(",", ":"))
    f.write("\n")

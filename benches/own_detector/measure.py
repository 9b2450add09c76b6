"""What the network finds: `python measure.py NETWORK.onnx SHARED`, from the project's root; SHARED has the meshes and photos it never saw.

Renders of two cars by the rasteriser of the training in plain paint, path-traced photos of one of them, empty scenes, real photos.
"""

import json
import sys
from pathlib import Path

import cv2
import numpy as np
import onnxruntime
import trimesh

import scenes

OVERLAP = 0.45  # as in the manifest


def detections(session, image):
    """Rows of x0, y0, x1, y1, score of an image (BGR), the best first: letterboxed in the middle, as YOLOv8's own program does."""
    side = session.get_inputs()[0].shape[2]
    h, w = image.shape[:2]
    scale = min(side / w, side / h)
    nw, nh = round(w * scale), round(h * scale)
    left, above = round((side - nw) / 2 - 0.1), round((side - nh) / 2 - 0.1)
    canvas = np.full((side, side, 3), 114, np.uint8)
    canvas[above : above + nh, left : left + nw] = cv2.resize(image, (nw, nh), interpolation=cv2.INTER_LINEAR)
    table = session.run(None, {"images": canvas[None, ..., ::-1].transpose(0, 3, 1, 2).astype(np.float32) / 255})[0][0].T
    table = table[table[:, 4] > 0.001]
    table = table[np.argsort(-table[:, 4])][:300]
    boxes = np.concatenate([table[:, :2] - table[:, 2:4] / 2, table[:, :2] + table[:, 2:4] / 2], 1)
    kept = []
    for i, box in enumerate(boxes):
        if all(overlap(box, boxes[j]) <= OVERLAP for j in kept):
            kept.append(i)
    boxes = ((boxes[kept] - [left, above] * 2) / scale).clip(0, [w - 1, h - 1] * 2)
    return np.column_stack([boxes, table[kept, 4]])


def overlap(a, b):
    inner = np.prod(np.clip(np.minimum(a[2:4], b[2:4]) - np.maximum(a[:2], b[:2]), 0, None))
    return inner / (np.prod(a[2:4] - a[:2]) + np.prod(b[2:4] - b[:2]) - inner + 1e-9)


def precision(session, photos):
    """AP@0.5 (101 points); at a confidence of 0.5 the share of cars hit and the false positives an image, over pairs of image and boxes."""
    rows, total, hits, false = [], 0, 0, 0
    for image, boxes in photos:
        free, total = list(boxes), total + len(boxes)
        for row in detections(session, image):
            best = max(range(len(free)), key=lambda j: overlap(row, free[j]), default=None)
            is_hit = best is not None and overlap(row, free[best]) >= 0.5
            if is_hit:
                free.pop(best)
            hits += is_hit and row[4] >= 0.5
            false += not is_hit and row[4] >= 0.5
            rows.append((row[4], is_hit))
    rows.sort(key=lambda row: -row[0])
    found = np.cumsum([is_hit for _, is_hit in rows])
    share, recall = found / np.arange(1, len(rows) + 1), found / total
    share = np.maximum.accumulate(share[::-1])[::-1]
    return np.mean([share[recall >= r].max(initial=0) for r in np.linspace(0, 1, 101)]), hits / total, false / len(photos)


def skyline(path):
    """Parts in metres, x front, z up."""
    return [(part(g.vertices), g.faces, None if g.visual.material.name == "Material.001" else g.visual.material.baseColorFactor[:3] / 255.0)
            for g in trimesh.load(path, force="scene").dump()]


def part(v):
    """The skyline's file has y up, and its front at +z; 4.55 m long."""
    return (v[:, [2, 0, 1]] - [0.01351663, 0, -0.35484956]) * (4.55 / 3.32535)


def etron(folder):
    """The published mesh: its paint in one colour, all else as its atlas has it, in eight greys."""
    v, vt, f, ft = [], [], [], []
    for line in open(folder / "model_save.obj"):
        word, *rest = line.split() or [""]
        if word == "v":
            v.append([float(x) for x in rest[:3]])
        elif word == "vt":
            vt.append([float(x) for x in rest[:2]])
        elif word == "f":
            f.append([int(x.split("/")[0]) - 1 for x in rest])
            ft.append([int(x.split("/")[1]) - 1 for x in rest])
    v, vt, f, ft = np.array(v), np.array(vt), np.array(f), np.array(ft)
    v = (v - [*(v.min(0) + v.max(0))[:2] / 2, v[:, 2].min()]) * (4.87 / np.ptp(v[:, 0]))
    atlas = cv2.imread(str(folder / "model_save.png"), 0)
    at = vt[ft].mean(1)
    grey = atlas[((1 - at[:, 1]) * atlas.shape[0]).astype(int) % atlas.shape[0], (at[:, 0] * atlas.shape[1]).astype(int) % atlas.shape[1]]
    level = grey.astype(int) // 32
    paint = np.loadtxt(folder / "exterior_face.txt", int)
    level[paint[paint < len(f)]] = -1
    return [(v, f[level == k], None if k < 0 else np.full(3, (k / 8 + 0.06) ** 2.2)) for k in np.unique(level)]


def traced(shared, paint):
    """The path-traced photos and film of the skyline in `paint`, with the box of its outline."""
    folder = Path("captures/skyline")
    for photo in json.loads((folder / "truth.json").read_text())["photos"]:
        if photo["file"].startswith(paint):
            yield cv2.imread(str(folder / photo["file"])), [np.array(photo["box_xyxy_px"])]
    mesh = np.concatenate([v for v, _, _ in skyline(shared / "meshes/skyline_r32_lowpoly_ccby4.glb")]) * 100  # 1:10, in mm
    k = np.array([[946.6667, 0, 645.1], [0, 946.6667, 356.0333], [0, 0, 1]])  # captures/walk/camera.yaml
    film = cv2.VideoCapture(f"captures/walk/{paint}.mp4")
    for frame in json.loads(Path(f"captures/walk/{paint}.truth.json").read_text())["frames"]:
        pose = np.array(frame["T_camera_model_mm"])
        points = cv2.projectPoints(mesh, cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3], k, np.array([-0.06, 0.02, 0, 0, 0]))[0][:, 0]
        yield film.read()[1], [np.concatenate([points.min(0), points.max(0)])]


def seen(session, photos, name):
    """How many of the photos have a detection of 0.5 or more, and the mean of the best confidences."""
    best = [max(detections(session, cv2.imread(str(p)))[:, 4], default=0) for p in photos]
    print(f"{name}: {sum(b >= 0.5 for b in best)} of {len(best)} photos at 0.5, mean best confidence {np.mean(best):.2f}")


def main():
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    session, shared = onnxruntime.InferenceSession(sys.argv[1], options), Path(sys.argv[2])
    cv2.setNumThreads(1)
    models = {"skyline": skyline(shared / "meshes/skyline_r32_lowpoly_ccby4.glb"), "e-tron": etron(shared / "meshes/rauca_etron")}
    both = []
    for name, model in models.items():
        photos = [scenes.make(np.random.default_rng([47, i]), model=model) for i in range(100)]
        both += photos
        print("{}, 100 renders: AP@0.5 {:.3f}, hits {:.2f}, false positives {:.2f} each".format(name, *precision(session, photos)))
    print("both, 200 renders: AP@0.5 {:.3f}, hits {:.2f}, false positives {:.2f} each".format(*precision(session, both)))
    for paint in ("normal", "random"):
        photos = list(traced(shared, paint))
        print("skyline path-traced, {}, {} photos and frames: AP@0.5 {:.3f}, hits {:.2f}, false positives {:.2f} each".format(paint, len(photos), *precision(session, photos)))
    false = [(detections(session, scenes.make(np.random.default_rng([49, i]), number=0)[0])[:, 4] >= 0.5).sum() for i in range(200)]
    print(f"empty scenes, 200 renders: {np.mean(false):.3f} false positives each")
    real = sorted([*shared.glob("photos/tags/*/*.[jp][pn]g"), *shared.glob("photos/real/**/*.jpg"), *shared.glob("sessions/board/*.jpg")])
    false = [(detections(session, cv2.imread(str(p)))[:, 4] >= 0.5).sum() for p in real]
    print(f"real photos and boards without a car, {len(real)}: {np.mean(false):.3f} false positives each")
    seen(session, sorted(shared.glob("photos/cars/*.jpg")), "real cars")
    seen(session, sorted(shared.glob("photos/toys/*.jpg")), "toy cars")


if __name__ == "__main__":
    main()

"""Trains on the scenes of a folder: `python train.py SCENES STATE.pt [STEPS]`. Stopped, it goes on from STATE.pt; at its end it writes STATE.onnx.

`python train.py SCENES STATE.pt export [SIDE]` only writes STATE.onnx, for images of SIDE pixels.
"""

import copy
import functools
import math
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import torch
from torch.nn import functional as F

import network
import scenes

BATCH, RATE, DECAY = 24, 3e-3, 0.02
SIDES = ((0.62, 192), (0.93, 256), (1.0, 320))  # small first: most is learnt there for a third of the time
# A box belongs to the grids whose stride times these its longer side lies between.
REACH = {8: (0, 9), 16: (3, 11), 32: (4.5, 1e9)}


@functools.cache
def load(path):
    """A scene, kept at three quarters of its size, and its boxes."""
    boxes = np.array(path.read_text().split(), float).reshape(-1, 4)
    image = cv2.imread(str(path.with_suffix(".jpg")))
    return cv2.resize(image, None, fx=0.75, fy=0.75, interpolation=cv2.INTER_AREA), boxes * 0.75


def placed(rng, canvas, image, boxes, share, corner=None):
    """`image` pasted into `canvas` at `share` of its side; the boxes there."""
    side = canvas.shape[0]
    w, h = (max(8, int(side * share * math.exp(rng.normal(0, 0.07)))) for _ in range(2))
    small = cv2.resize(image, (w, h), interpolation=cv2.INTER_AREA if w < image.shape[1] else cv2.INTER_LINEAR)
    boxes = boxes * np.tile([w / image.shape[1], h / image.shape[0]], 2)
    if corner is None:
        # A cut must not halve a car: the first one stays inside, as far as it fits.
        room = np.array([side - w, side - h])
        low, high = np.minimum(room, 0), np.maximum(room, 0)
        if len(boxes):
            slack = 0.12 * (boxes[0, 2:] - boxes[0, :2])
            low, high = np.maximum(low, np.minimum(-boxes[0, :2] - slack, high)), np.minimum(high, np.maximum(side - boxes[0, 2:] + slack, low))
        corner = rng.uniform(low, np.maximum(low, high) + 1e-6)
    x, y = (int(v) for v in corner)
    x0, y0, x1, y1 = max(x, 0), max(y, 0), min(x + w, side), min(y + h, side)
    canvas[y0:y1, x0:x1] = small[y0 - y : y1 - y, x0 - x : x1 - x]
    moved = boxes + [x, y, x, y]
    cut = moved.clip(0, side - 1)
    area = lambda b: (b[:, 2] - b[:, 0]) * (b[:, 3] - b[:, 1])
    return cut[area(cut) > 0.4 * area(moved)] if len(boxes) else cut


def spoil(rng, image):
    """Another white balance, exposure, sharpness, noise, compression, as cameras have them."""
    if rng.random() < 0.15:
        image = image[..., rng.permutation(3)]
    v = image.astype(np.float32) / 255
    if rng.random() < 0.8:
        grey = v.mean(-1, keepdims=True)
        v = grey + (v - grey) * (rng.uniform(0.2, 1.3) if rng.random() < 0.9 else 0)
        v = np.clip(v * rng.uniform(0.55, 1.35) * (1 + rng.normal(0, 0.09, 3).astype(np.float32)) + rng.normal(0, 0.05), 0, 1) ** rng.uniform(0.65, 1.5)
    blur = rng.random()
    if blur < 0.25:
        v = cv2.GaussianBlur(v, (0, 0), rng.uniform(0.3, 1.4))
    elif blur < 0.33:
        k = np.zeros((7, 7), np.float32)
        end = (np.array([3, 3]) + 3 * np.array([math.cos(a := rng.uniform(0, 6.3)), math.sin(a)])).round().astype(int).tolist()
        cv2.line(k, (3, 3), end, 1)
        v = cv2.filter2D(v, -1, k / k.sum())
    if rng.random() < 0.6:
        v = v + rng.standard_normal(v.shape[:2] + (rng.choice([1, 3]),), np.float32) * rng.uniform(0, 0.05)
    image = (np.clip(v, 0, 1) * 255).astype(np.uint8)
    if rng.random() < 0.3:
        image = cv2.imdecode(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, int(rng.uniform(25, 90))])[1], 1)
    return image


def lay_cards(rng, canvas, boxes):
    """Markers, charts and other cards in perspective, beside the cars: where cars are photographed here, they lie everywhere."""
    side = canvas.shape[0]
    make = scenes.tags if rng.random() < 0.8 else lambda rng, n: scenes.texture(rng, n)
    card = (np.clip(make(rng, 64), 0, 1) ** (1 / 2.2) * 255 * rng.uniform(0.5, 1)).astype(np.uint8)
    base = rng.uniform(0.03, 0.13) * side
    for _ in range(rng.integers(3, 16)):
        size = base * rng.uniform(0.7, 1.4)
        at = rng.uniform(0, 1, 2) * (side - 2.2 * size)
        end = at + 2.2 * size
        if any(at[0] < b[2] and end[0] > b[0] and at[1] < b[3] and end[1] > b[1] for b in boxes):
            continue
        turn = rng.uniform(0, 6.3)
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        square = square / (1 - 0.12 * square[:, 1:]) * [1, rng.uniform(0.3, 1)] + rng.normal(0, 0.05, (4, 2))
        corners = ((square * 0.7 + 1.1) * size + at).astype(np.float32)
        if rng.random() < 0.5:  # its shadow
            cv2.fillPoly(canvas, [(corners + rng.normal(0, 0.15, 2) * size).astype(np.int32)], (canvas[int(at[1]), int(at[0])] * 0.5).tolist())
        warp = cv2.getPerspectiveTransform(np.array([[0, 0], [64, 0], [64, 64], [0, 64]], np.float32), corners)
        warped = cv2.warpPerspective(card, warp, (side, side), flags=cv2.INTER_AREA)
        mask = cv2.fillConvexPoly(np.zeros((side, side), np.uint8), corners.astype(np.int32), 1)
        canvas[mask > 0] = warped[mask > 0]


def sample(rng, scenes_made, empty, side):
    any_scene = lambda: load(scenes_made[rng.integers(len(scenes_made))])
    canvas = np.full((side, side, 3), 114, np.uint8)
    if rng.random() < 0.6:
        canvas[:] = cv2.resize(load(empty[rng.integers(len(empty))])[0], (side, side), interpolation=cv2.INTER_AREA)
    if rng.random() < 0.2:  # four scenes
        found = [placed(rng, canvas, *any_scene(), 0.5, (x, y)) for x in (0, side // 2) for y in (0, side // 2)]
        boxes = np.concatenate(found)
    else:
        share = rng.uniform(0.45, 1.0) if rng.random() < 0.4 else rng.uniform(0.95, 1.35)
        boxes = placed(rng, canvas, *any_scene(), share)
    if rng.random() < 0.4:
        lay_cards(rng, canvas, boxes)
    if rng.random() < 0.15:  # something in front, too small to hide a car
        w, h = (rng.uniform(0.03, 0.16, 2) * side).astype(int) + 1
        x, y = (rng.uniform(0, 1, 2) * (side - np.array([w, h]))).astype(int)
        canvas[y : y + h, x : x + w] = rng.integers(0, 256, (1, 1, 3)) if rng.random() < 0.5 else cv2.resize(canvas[:h, :w], (w, h))
    canvas = spoil(rng, canvas)
    if rng.random() < 0.4 and not len(boxes) or len(boxes) and rng.random() < 0.4 and boxes[:, 1].min() > side / 8 and boxes[:, 3].max() < side * 7 / 8:
        canvas[: side // 8] = canvas[side - side // 8 :] = 114  # the bars of a letterboxed photo
    if rng.random() < 0.5:
        canvas = canvas[:, ::-1]
        boxes = np.stack([side - 1 - boxes[:, 2], boxes[:, 1], side - 1 - boxes[:, 0], boxes[:, 3]], 1)
    return np.ascontiguousarray(canvas[..., ::-1].transpose(2, 0, 1)), boxes


def overlaps(a, b):
    """IoU and generalised IoU of rows of centre and size."""
    a0, a1, b0, b1 = a[:, :2] - a[:, 2:] / 2, a[:, :2] + a[:, 2:] / 2, b[:, :2] - b[:, 2:] / 2, b[:, :2] + b[:, 2:] / 2
    inner = (torch.minimum(a1, b1) - torch.maximum(a0, b0)).clamp(0).prod(1)
    union = a[:, 2:].prod(1) + b[:, 2:].prod(1) - inner
    hull = (torch.maximum(a1, b1) - torch.minimum(a0, b0)).prod(1)
    iou = inner / (union + 1e-6)
    return iou, iou - (hull - union) / (hull + 1e-6)


def loss_of(grids, truth, side):
    table = network.decode(grids, side)
    corner, stride = network.cells(side)
    middle, s = (corner + 0.5) * stride, stride[0]
    low = sum((s == k) * v[0] * k for k, v in REACH.items())
    high = sum((s == k) * v[1] * k for k, v in REACH.items())
    rows, columns, targets = [], [], []
    for i, boxes in enumerate(truth):
        best = torch.full((len(s),), 1e9)
        owner = torch.full((len(s),), -1)
        boxes = torch.tensor(boxes, dtype=torch.float32).reshape(-1, 4)
        boxes = torch.cat([(boxes[:, :2] + boxes[:, 2:]) / 2, boxes[:, 2:] - boxes[:, :2]], 1)
        for j, box in enumerate(boxes):
            off = (middle - box[:2, None]).abs()
            long, area = box[2:].max(), box[2:].prod()
            fits = (off < torch.minimum(1.5 * s, box[2:, None] / 2)).all(0) & (long >= low) & (long < high)
            if not fits.any():
                fits = ((off / s).sum(0) == (off / s)[:, s == 8].sum(0).min()) & (s == 8)
            wins = fits & (area < best)
            best[wins], owner[wins] = area, j
        at = torch.nonzero(owner >= 0)[:, 0]
        rows.append(torch.full_like(at, i))
        columns.append(at)
        targets.append(boxes[owner[at]])
    rows, columns, targets = torch.cat(rows), torch.cat(columns), torch.cat(targets)
    wanted = torch.zeros_like(table[:, 4])
    boxes_loss = table.sum() * 0
    if len(rows):
        iou, generalised = overlaps(table[rows, :4, columns], targets)
        wanted[rows, columns] = iou.detach().clamp(0.05, 1) ** 0.5
        boxes_loss = (1 - generalised).sum() / len(rows)
    score = table[:, 4]
    weight = torch.where(wanted > 0, 1.0, torch.sigmoid(score.detach()) ** 1.5)
    scores_loss = (F.binary_cross_entropy_with_logits(score, wanted, reduction="none") * weight).sum() / max(1, len(rows))
    return scores_loss + 2 * boxes_loss, scores_loss.item(), boxes_loss.item()


def main():
    folder, path = Path(sys.argv[1]), Path(sys.argv[2])
    steps = int(sys.argv[3]) if len(sys.argv) > 3 and sys.argv[3] != "export" else 4000
    torch.set_num_threads(1)
    cv2.setNumThreads(1)
    torch.manual_seed(46)
    net = network.Detector().to(memory_format=torch.channels_last)
    slow = copy.deepcopy(net)
    optimiser = torch.optim.AdamW(net.parameters(), RATE, weight_decay=DECAY)
    step, spent = 0, 0.0
    if path.exists():
        state = torch.load(path)
        net.load_state_dict(state["net"])
        slow.load_state_dict(state["slow"])
        optimiser.load_state_dict(state["optimiser"])
        step, spent = state["step"], state["spent"]
    if sys.argv[3:4] == ["export"]:
        return network.export(slow, int(sys.argv[4]) if len(sys.argv) > 4 else 320, path.with_suffix(".onnx"))
    print(sum(p.numel() for p in net.parameters()), "weights", flush=True)
    began, saved, made, losses = time.time(), time.time(), [], []
    while step < steps:
        if step % 100 == 0 or not made:  # more scenes may have been made
            made = sorted(folder.glob("*.txt"))
            empty = [s for s in made if s.stat().st_size == 0]
        share = step / steps
        side = next(size for until, size in SIDES if share < until)
        for group in optimiser.param_groups:
            group["lr"] = RATE * min(1, (step + 1) / 150) * (0.02 + 0.98 * (1 + math.cos(math.pi * share)) / 2)
        rng = np.random.default_rng([46, step])
        images, truth = zip(*(sample(rng, made, empty, side) for _ in range(BATCH)))
        batch = torch.from_numpy(np.stack(images)).to(memory_format=torch.channels_last).float() / 255
        loss, *parts = loss_of(net(batch), truth, side)
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 10)
        optimiser.step()
        step += 1
        keep = min(0.99, (1 + step) / (10 + step))
        with torch.no_grad():
            for a, b in zip(slow.state_dict().values(), net.state_dict().values()):
                a.copy_(a * keep + b * (1 - keep) if a.is_floating_point() else b)
        losses.append(parts)
        if step % 25 == 0:
            print(step, side, len(made), *np.mean(losses, 0).round(3), f"{(time.time() - began):.0f} s", flush=True)
            losses = []
        if time.time() - saved > 120 or step == steps:
            saved = time.time()
            state = {"net": net.state_dict(), "slow": slow.state_dict(), "optimiser": optimiser.state_dict(), "step": step, "spent": spent + saved - began}
            torch.save(state, path.with_suffix(".part"))
            path.with_suffix(".part").replace(path)
    network.export(slow, 320, path.with_suffix(".onnx"))


if __name__ == "__main__":
    main()

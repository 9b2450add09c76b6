"""Scenes with cars and without: `python scenes.py FOLDER COUNT [FIRST]` writes NNNNNN.jpg and NNNNNN.txt (a car's x0 y0 x1 y1 a line)."""

import sys
from pathlib import Path

import cv2
import numpy as np

import cars
import render

SIDE = 384


def clouds(rng, n, roughness, colours):
    """Noise of many scales, between two or three colours."""
    total = np.zeros((n, n), np.float32)
    for octave in range(1, 8):
        size = min(n, 2**octave)
        total += cv2.resize(rng.random((size, size), np.float32), (n, n), interpolation=cv2.INTER_CUBIC) * roughness**octave
    rank = (total - total.min()) / (np.ptp(total) + 1e-6)
    at = np.linspace(0, 1, len(colours))
    return np.stack([np.interp(rank, at, colours[:, i]) for i in range(3)], -1)


def colour(rng, dull=False):
    c = rng.random(3) ** 1.5
    return c * 0.5 + 0.25 * c.mean() if dull else c


def tags(rng, n):
    """Square markers on paper."""
    image = np.full((n, n, 3), 0.8) * rng.uniform(0.7, 1)
    cells = rng.integers(6, 11)
    count = rng.integers(1, 4)
    pitch = n // count
    side = int(pitch * rng.uniform(0.6, 0.95)) // cells * cells
    for i in range(count):
        for j in range(count):
            code = (rng.random((cells, cells)) > 0.5).astype(np.uint8)
            code[[0, -1]] = code[:, [0, -1]] = 0
            code = cv2.resize(code, (side, side), interpolation=cv2.INTER_NEAREST)
            image[i * pitch : i * pitch + side, j * pitch : j * pitch + side] = 0.02 + 0.75 * code[..., None]
    return image


def texture(rng, n=256):
    kind = rng.integers(0, 12)
    if kind == 0:
        return tags(rng, n)
    if kind == 1:  # a checkerboard
        size = n // rng.integers(2, 12)
        y, x = np.indices((n, n)) // size
        a, b = (np.full(3, 0.03), np.full(3, 0.8)) if rng.random() < 0.5 else (colour(rng), colour(rng))
        return np.where(((x + y) % 2)[..., None], a, b)
    if kind in (2, 3):  # cells, as adversarial patterns and colour charts have them
        cells = rng.integers(3, 24)
        return cv2.resize(rng.random((cells, cells, 3)) ** 1.3, (n, n), interpolation=cv2.INTER_NEAREST)
    if kind == 4:  # planks or tiles
        base = clouds(rng, n, 0.6, np.stack([colour(rng, True) * 0.8, colour(rng, True)]))
        rows, columns = rng.integers(2, 14), rng.integers(1, 14)
        shade = cv2.resize(rng.uniform(0.7, 1.1, (rows, columns)), (n, n), interpolation=cv2.INTER_NEAREST)
        y, x = np.indices((n, n))
        joint = ((y * rows % n < rows * 2) | (x * columns % n < columns * 2))[..., None]
        return base * shade[..., None] * np.where(joint, 0.55, 1)
    if kind == 5:  # camouflage: flat spots
        base = clouds(rng, n, rng.uniform(0.4, 0.8), np.array([[0.0] * 3, [1.0] * 3]))[..., 0]
        colours = np.stack([colour(rng, rng.random() < 0.6) for _ in range(rng.integers(2, 6))])
        return colours[(base * len(colours)).astype(int).clip(0, len(colours) - 1)]
    if kind == 6:  # stripes
        y, x = np.indices((n, n))
        wave = np.sin((x * rng.integers(0, 9) + y * rng.integers(0, 9)) * 2 * np.pi / n) > rng.uniform(-0.7, 0.7)
        return np.where(wave[..., None], colour(rng), colour(rng))
    if kind in (7, 8):  # asphalt, concrete, sand, cloth
        grain = rng.normal(1, rng.uniform(0.02, 0.25), (n, n, 1))
        return clouds(rng, n, 0.5, np.stack([c := colour(rng, True) * 0.6, c * 1.4])) * grain
    if kind == 9:  # grass
        green = np.array([0.12, 0.22, 0.05]) * rng.uniform(0.4, 1.6, 3)
        return clouds(rng, n, 0.95, np.stack([green * 0.4, green, green * 1.6]))
    return clouds(rng, n, rng.uniform(0.4, 1.0), np.stack([colour(rng, True) for _ in range(3)]))


def backdrop(rng, n, horizon, sky):
    """What is behind everything: a sky over clutter, or a wall, mostly out of focus."""
    image = np.empty((n, n, 3), np.float32)
    y = np.clip((horizon - np.arange(n)) / n, 0, 1)[:, None]
    image[:] = (sky[1] * (1 - y) + sky[0] * y)[:, None]
    if rng.random() < 0.3:
        image *= cv2.resize(texture(rng).astype(np.float32), (n, n)) * 1.2 + 0.2
    for _ in range(rng.integers(0, 26)):
        c, w, h = colour(rng, rng.random() < 0.7) * rng.uniform(0.3, 1.5), *(rng.uniform(0.02, 0.35, 2) ** 1.2 * n).astype(int) + 1
        x, base = int(rng.uniform(0, n)), int(horizon + rng.normal(0, 0.03) * n) if rng.random() < 0.6 else int(rng.uniform(0, n))
        shape = rng.integers(0, 3)
        if shape == 0:
            cv2.rectangle(image, (x - w, base - 2 * h), (x + w, base), c.tolist(), -1)
        elif shape == 1:
            cv2.ellipse(image, (x, base - h), (w, h), float(rng.uniform(0, 180)), 0, 360, c.tolist(), -1)
        else:
            corners = (np.array([x, base - h]) + rng.normal(0, 1, (rng.integers(3, 7), 2)) * (w, h)).astype(np.int32)
            cv2.fillPoly(image, [corners], c.tolist())
    if rng.random() < 0.6:
        image *= clouds(rng, n, 0.85, np.array([[0.5] * 3, [1.3] * 3]))
    return cv2.GaussianBlur(image, (0, 0), rng.choice([0.6, 1.5, 4.0, 9.0])).astype(np.float64)


def paint(rng, count):
    """A car's looks: colour and gloss, a pattern's repeat, a second colour, its rims."""
    look = np.zeros(16)
    look[:3] = colour(rng) if rng.random() < 0.6 else rng.choice([0.02, 0.06, 0.2, 0.4, 0.6, 0.85]) * rng.uniform(0.9, 1.1, 3)
    look[:3] = look[:3].clip(0.01, 0.9)
    look[3] = rng.choice([0.1, 0.5, 1.0])
    if rng.random() < 0.22:
        look[4] = rng.uniform(0.7, 5)
    elif rng.random() < 0.3:
        look[5], look[6:9] = rng.integers(1, 4), colour(rng)
    look[9:13] = rng.random() < 0.5, rng.integers(4, 12), rng.uniform(0.15, 0.35), rng.choice([0.1, 0.5, 0.8])
    look[13] = rng.integers(0, count)
    return look


class Scene:
    def __init__(self):
        self.things, self.vertices, self.faces, self.corners, self.locals, self.owner = [], [], [], [], [], []
        self.start = 0

    def add(self, kind, v, f, place, turn, look, tables=None, numbers=None, local=None, is_smooth=True, car=-1):
        c, s = np.cos(turn), np.sin(turn)
        r = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        world = v @ r + place
        self.vertices.append(world)
        self.corners.append(render.normals(world, f, is_smooth))
        self.locals.append(v if local is None else v - local)
        self.owner.append(np.full(len(f), len(self.things)))
        self.faces.append(f + self.start)
        self.things.append((kind, look, np.zeros((4, cars.SAMPLES)) if tables is None else tables, np.zeros(19) if numbers is None else numbers, (c, s), car))
        self.start += len(v)
        return world


def make(rng, side=SIDE, model=None, number=None):
    """One image (BGR, 8 bits) and the boxes of its cars: `number` of random ones, or one of parts (vertices, faces, colour; None: paint)."""
    scene, count = Scene(), 4
    patterns = np.stack([texture(rng) for _ in range(count)])
    drawn = rng.choice([0, 1, 2, 3], p=[0.22, 0.53, 0.17, 0.08])
    number = 1 if model else drawn if number is None else number
    placed, spots = [], []
    for i in range(number):
        parts, tables, numbers = cars.car(rng) if model is None else ([(cars.SOLID, v, f) for v, f, _ in model], None, None)
        spot = np.zeros(3) if i == 0 else np.append(rng.normal(0, 5, 2), 0)
        if any(np.hypot(*(spot - other)[:2]) < 4.5 for other in spots):
            continue
        spots.append(spot)
        turn, look, is_smooth = rng.uniform(0, 2 * np.pi), paint(rng, count), rng.random() < 0.7
        if model:
            look[4] = 0
        every = []
        for j, (kind, v, f) in enumerate(parts):
            local = None
            if model and model[j][2] is not None:
                look = look.copy()
                look[:4] = *model[j][2], 0.3
            if kind == cars.WHEEL:
                local = np.array([numbers[8] if v[:, 0].mean() > 0 else numbers[9], 0, numbers[10]])
            every.append(scene.add(kind, v, f, spot, turn, look, tables, numbers, local, is_smooth or kind == cars.WHEEL, len(placed)))
        placed.append(np.concatenate(every))
    for _ in range(rng.integers(0, 9) if number else rng.integers(0, 14)):
        spot = np.append(rng.normal(0, 5, 2), 0)
        if any(np.hypot(*(spot - other)[:2]) < 3.0 for other in spots):
            continue
        v, f = cars.clutter(rng, rng.choice([0.6, 1.2, 2.5, 4.0]))
        look = np.zeros(16)
        look[:3], look[3] = colour(rng, rng.random() < 0.5), rng.choice([0.05, 0.3, 1.0])
        look[4] = rng.uniform(0.3, 4) if rng.random() < 0.5 else 0
        look[13] = rng.integers(0, count)
        scene.add(cars.SOLID, v, f, spot, rng.uniform(0, 6.3), look, is_smooth=rng.random() < 0.5)

    # The camera, looking near the first car.
    field = np.radians(rng.uniform(22, 75))
    focal = side / 2 / np.tan(field / 2)
    pitch = np.radians(rng.choice([rng.uniform(-3, 20), rng.uniform(5, 40), rng.uniform(30, 70)], p=[0.5, 0.35, 0.15]))
    share = rng.uniform(0.22, 0.95)
    distance = 4.4 * focal / (share * side)
    target = np.array([0, 0, rng.uniform(0.4, 0.9)])
    eye = target + distance * np.array([np.cos(pitch), 0, np.sin(pitch)])
    eye[2] = max(eye[2], 0.25)
    aim = target + rng.normal(0, 0.11, 3) * distance * np.tan(field / 2) * (1.3 if share < 0.6 else 0.6)
    forward = (aim - eye) / np.linalg.norm(aim - eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    roll = rng.normal(0, 0.05)
    down = np.cross(forward, right)
    right, down = right * np.cos(roll) + down * np.sin(roll), down * np.cos(roll) - right * np.sin(roll)
    axes = np.stack([right, down, forward])
    middle = (side - 1) / 2

    def project(world):
        p = (world - eye) @ axes.T
        w = np.where(p[:, 2] > 0.05, 1 / np.maximum(p[:, 2], 0.05), 0)
        return np.stack([p[:, 0] * w * focal + middle, p[:, 1] * w * focal + middle, w], -1)

    # Light.
    sun = np.zeros(6)
    height, round_ = np.radians(rng.uniform(15, 85)), rng.uniform(0, 2 * np.pi)
    sun[:3] = np.cos(height) * np.cos(round_), np.cos(height) * np.sin(round_), np.sin(height)
    warm = np.array([1 + rng.uniform(0, 0.25), 1, 1 - rng.uniform(0, 0.3)])
    sun[3:] = warm[::-1] * rng.choice([0.2, 0.7, 1.3, 2.2])
    blue = 1 + np.array([0.4, 0.1, -0.2]) * rng.uniform(-0.5, 1)
    sky = np.stack([blue * rng.uniform(0.2, 0.8), (blue + 1) / 2 * rng.uniform(0.3, 1.1), colour(rng, True) * 0.5 + 0.03])
    panels = cv2.resize(rng.random((1, rng.integers(3, 14))), (64, 1))[0]
    ground = texture(rng)
    sky[2] = ground.mean((0, 1)) * 0.7
    ground_size = rng.choice([1.5, 3.0, 8.0, 20.0])
    n = 256
    shade = np.zeros((n, n, 2), np.float32)
    extent = 20.0
    if scene.start:
        v, f = np.concatenate(scene.vertices), np.concatenate(scene.faces)
        corners, local, owner = np.concatenate(scene.corners), np.concatenate(scene.locals), np.concatenate(scene.owner)
        for layer, slope in ((0, sun[:2] / sun[2]), (1, np.zeros(2))):
            flat = np.column_stack([(v[:, :2] - v[:, 2:] * slope + extent / 2) / extent * n, np.ones(len(v))])
            depth, hit, bary = np.zeros((n, n)), np.full((n, n), -1, np.int32), np.zeros((n, n, 3))
            render.rasterise(flat, f, n, n, owner, depth, hit, bary)
            soft = rng.uniform(0.8, 5) if layer == 0 else 2.5
            shade[..., layer] = cv2.GaussianBlur((hit >= 0).astype(np.float32), (0, 0), soft) * (0.95 if layer == 0 else 0.9)
    else:
        v, f, corners, local, owner = np.zeros((3, 3)), np.zeros((0, 3), np.int64), np.zeros((0, 3, 3)), np.zeros((3, 3)), np.zeros(0, np.int64)
        scene.things.append((3, np.zeros(16), np.zeros((4, cars.SAMPLES)), np.zeros(19), (1.0, 0.0), -1))
    depth, index, bary = np.zeros((side, side)), np.full((side, side), -1, np.int32), np.zeros((side, side, 3))
    render.rasterise(project(v), f, side, side, owner, depth, index, bary)
    y, x = np.indices((side, side), np.float64)
    ray = np.stack([(x - middle) / focal, (y - middle) / focal, np.ones_like(x)], -1) @ axes
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    flat_level = np.hypot(*forward[:2])
    horizon = middle + focal * forward[2] / max(flat_level, 0.05)
    image = backdrop(rng, side, np.clip(horizon, -side, 2 * side), sky)
    has_ground = rng.random() < 0.93
    kinds, looks, tables, numbers, turns = (np.array([t[i] for t in scene.things]) for i in range(5))
    shade_at = np.array([-extent / 2, -extent / 2, extent / n, rng.choice([0.0, 0.0, 0.1, 0.6]), 0.6])
    render.light(index, bary, f, owner, v, corners, local, turns, kinds, looks, *(np.ascontiguousarray(tables[:, i]) for i in range(3)), numbers, patterns,
                 sun, sky, panels, eye, ray, ground, ground_size, shade, shade_at, has_ground, image)
    exposure = rng.uniform(0.5, 1.0) / (np.percentile(image, rng.uniform(80, 97)) + 1e-3)
    image = np.clip(image * exposure, 0, None)
    image = image / (1 + image * rng.uniform(0, 0.35)) if rng.random() < 0.7 else image
    image = np.ascontiguousarray(np.clip(image, 0, 1)[..., ::-1] ** (1 / 2.2) * 255).astype(np.uint8)

    boxes = []
    shown = np.where(index >= 0, owner[np.maximum(index, 0)] if len(owner) else -1, -1)
    car_of = np.array([t[5] for t in scene.things])
    for i, world in enumerate(placed):
        at = project(world)
        if (at[:, 2] <= 0).any():
            return make(rng, side, model, number)
        whole = np.concatenate([at[:, :2].min(0), at[:, :2].max(0)])
        cut = whole.clip(0, side - 1)
        area = lambda b: max(0, b[2] - b[0]) * max(0, b[3] - b[1])
        visible = ((car_of[np.maximum(shown, 0)] == i) & (shown >= 0)).sum()
        if area(cut) == 0 or visible < 0.25 * area(cut) or area(cut) < 0.3 * area(whole) or min(cut[2] - cut[0], cut[3] - cut[1]) < 12:
            if visible > 30:  # neither a car nor none
                return make(rng, side, model, number)
            continue
        boxes.append(cut)
    return image, boxes


if __name__ == "__main__":
    folder, count = Path(sys.argv[1]), int(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    cv2.setNumThreads(1)
    for number in range(int(sys.argv[3]) if len(sys.argv) > 3 else 0, count):
        label = folder / f"{number:06}.txt"
        if label.exists():
            continue
        image, boxes = make(np.random.default_rng([46, number]))
        cv2.imwrite(str(label.with_suffix(".jpg")), image, [cv2.IMWRITE_JPEG_QUALITY, 93])
        label.write_text("".join(" ".join(f"{v:.1f}" for v in box) + "\n" for box in boxes))

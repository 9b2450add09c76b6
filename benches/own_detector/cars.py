"""Cars and clutter as meshes, all of random proportions: lofted bodies, wheels, boxes, balls, furniture. Metres; x front, y left, z up."""

import numpy as np

STATIONS, SAMPLES = 44, 64
BODY, WHEEL, SOLID = 1, 2, 3

# x as a share of the length from the rear bumper: where the bonnet ends, the roof begins and ends, the boot begins; then length, height.
KINDS = {
    "sedan": (0.68, 0.54, 0.28, 0.13, (4.2, 5.1), (1.36, 1.5)),
    "coupe": (0.64, 0.47, 0.33, 0.08, (4.0, 4.8), (1.15, 1.35)),
    "hatchback": (0.73, 0.57, 0.14, 0.02, (3.5, 4.4), (1.4, 1.6)),
    "estate": (0.70, 0.55, 0.07, 0.01, (4.3, 5.0), (1.4, 1.55)),
    "suv": (0.73, 0.59, 0.08, 0.01, (4.1, 5.0), (1.6, 1.9)),
    "van": (0.86, 0.72, 0.03, 0.005, (4.2, 5.4), (1.8, 2.3)),
    "pickup": (0.72, 0.60, 0.38, 0.34, (4.7, 5.6), (1.6, 1.9)),
    "wedge": (0.72, 0.50, 0.34, 0.05, (4.0, 4.7), (1.05, 1.22)),
}


def grid_faces(rows, columns, wrap=False):
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(columns if wrap else columns - 1), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    quads = np.stack([a, a + columns, b + columns, b], -1).reshape(-1, 4)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def box(size, at=(0, 0, 0), turn=0.0):
    """A box standing on `at`."""
    v = np.array([[x, y, z] for z in (0, 1) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]) * size
    c, s = np.cos(turn), np.sin(turn)
    v = v @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + at
    f = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]]
    return v, np.array(f)


def turned(profile, around=20):
    """A surface of revolution round z: `profile` is rows of (radius, z), from below to above."""
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    r, z = np.array(profile, float).T
    v = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle)), np.outer(z, np.ones(around))], -1)
    return v.reshape(-1, 3), grid_faces(len(r), around, wrap=True)[:, [0, 2, 1]]


def smooth(values, width):
    if width < 0.3:
        return values
    k = np.exp(-0.5 * (np.arange(-9, 10) / width) ** 2)
    return np.convolve(np.pad(values, 9, mode="edge"), k / k.sum(), "valid")


def car(rng):
    """Parts (kind, vertices, faces), and the tables and numbers by which the shader tells glass, lamps and paint apart."""
    kind = rng.choice(list(KINDS), p=[0.2, 0.14, 0.16, 0.09, 0.15, 0.08, 0.07, 0.11])
    cowl, roof0, roof1, boot, lengths, heights = KINDS[kind]
    length, height = rng.uniform(*lengths), rng.uniform(*heights)
    cowl, roof0, roof1 = (v + rng.normal(0, 0.015) for v in (cowl, roof0, roof1))
    half = rng.uniform(0.82, 0.98) * (1.08 if kind in ("suv", "van", "pickup") else 1.0)
    belt = height * rng.uniform(0.58, 0.68) if kind != "van" else height * rng.uniform(0.5, 0.6)
    nose, tail = belt * rng.uniform(0.66, 0.9), belt * rng.uniform(0.92, 1.12)
    if kind == "wedge":
        nose *= 0.8
    end = tail if kind in ("sedan", "coupe", "pickup", "wedge") else belt * rng.uniform(0.95, 1.1)
    deck = tail if kind != "pickup" else belt * rng.uniform(0.95, 1.08)
    at = [0, 0.012, max(boot, 0.02), roof1, (roof0 + roof1) / 2, roof0, cowl, 0.97, 1.0]
    crown = rng.uniform(0.0, 0.05)
    up = [end * 0.72, end, deck, height - crown, height, height - crown * 0.5, belt + 0.03, nose, nose * rng.uniform(0.65, 0.9)]
    t = np.linspace(0, 1, SAMPLES)
    top = smooth(np.interp(t, at, up), rng.uniform(0, 1.6))
    rise = rng.uniform(-0.03, 0.1)
    belts = belt + rise * (0.5 - t)
    floor = rng.uniform(0.14, 0.22) if kind not in ("suv", "pickup") else rng.uniform(0.25, 0.38)
    under = floor + 0.25 * np.clip((0.06 - t) / 0.06, 0, 1) * rng.uniform(0, 1) + 0.12 * np.clip((t - 0.95) / 0.05, 0, 1) * rng.uniform(0, 1)
    round_by, power = rng.uniform(0.08, 0.4), rng.uniform(4, 11)
    wide = half * (1 - round_by * np.abs(2 * t - 1) ** power)
    x = (t - 0.5) * length
    s = np.linspace(0, 1, STATIONS)
    zt, zb, zbelt, w = (np.interp(s, t, v) for v in (top, under, belts, wide))
    tumble = rng.uniform(0.08, 0.3) * (0.4 if kind == "van" else 1)
    sill, shoulder = rng.uniform(0.88, 1.0), rng.uniform(0.93, 1.0)
    zs = np.minimum(zbelt, zt - 0.05)
    inward = tumble * np.clip((zt - zs) / (height - belt), 0, 1)
    half_section = [(0 * w, zb), (w * 0.86, zb), (w * sill, zb + 0.2 * (zs - zb)), (w, zb + 0.6 * (zs - zb)), (w * shoulder, zs)]
    for k in (0.12, 0.5, 0.88):
        half_section.append((w * (shoulder - inward * k), zs + (zt - zs) * k))
    half_section += [(w * (shoulder - inward) * 0.86, zt - 0.012), (w * 0.45, zt), (0 * w, zt + 0.008)]
    ring = half_section + [(-y, z) for y, z in half_section[-2:0:-1]]
    columns = len(ring)
    v = np.stack([np.stack([(s - 0.5) * length, y, z], -1) for y, z in ring], 1).reshape(-1, 3)
    f = grid_faces(STATIONS, columns, wrap=True)[:, [0, 2, 1]]
    caps = []
    for first, order in ((0, (0, 1, 2)), ((STATIONS - 1) * columns, (0, 2, 1))):
        middle = len(v)
        v = np.vstack([v, v[first : first + columns].mean(0)])
        fan = np.array([[middle, first + j, first + (j + 1) % columns] for j in range(columns)])
        caps.append(fan[:, order])
    parts = [(BODY, v, np.concatenate([f, *caps]))]

    radius = rng.uniform(0.29, 0.36) * (1.12 if kind in ("suv", "pickup") else 1.0)
    front, rear = length * rng.uniform(0.28, 0.33), -length * rng.uniform(0.27, 0.33)
    thick = rng.uniform(0.18, 0.28)
    wheel_v, wheel_f = turned([(0, 0), (radius * 0.93, 0), (radius, 0.03), (radius, thick - 0.03), (radius * 0.93, thick), (radius * 0.6, thick - 0.02), (0, thick - 0.03)], 24)
    for axle in (front, rear):
        edge = np.interp(axle, x, wide) + rng.uniform(-0.03, 0.03)
        for side in (1, -1):
            y = side * (edge - thick + wheel_v[:, 2])
            turned_v = np.stack([wheel_v[:, 0] + axle, y, wheel_v[:, 1] + radius], -1)
            parts.append((WHEEL, turned_v, wheel_f if side < 0 else wheel_f[:, ::-1]))
    cowl_x = (cowl - 0.5) * length
    if rng.random() < 0.85:
        for side in (1, -1):
            parts.append((BODY, *box((0.14, 0.2, 0.14), (cowl_x - 0.28, side * (half + 0.04), belt + 0.03))))
    if rng.random() < 0.2:
        z = tail + rng.uniform(0.1, 0.35) if kind in ("sedan", "coupe", "wedge") else height
        parts.append((BODY, *box((0.28, half * 1.7, 0.04), (-length * 0.45, 0, z))))
        if kind in ("sedan", "coupe", "wedge"):
            for side in (1, -1):
                parts.append((BODY, *box((0.15, 0.05, z - tail * 0.8), (-length * 0.45, side * half * 0.5, tail * 0.8))))
    if kind == "pickup":
        bed = box((length * (roof1 - 0.06), half * 1.5, 0.01), (-length * (0.5 - roof1 / 2) + 0.08, 0, deck + 0.02))
        parts.append((SOLID, *bed))
    tables = np.stack([top, belts, wide, under])
    numbers = np.array([length, half, height, belt, (roof0 - 0.5) * length, cowl_x, (roof1 - 0.5) * length, (max(boot, 0.02) - 0.5) * length, front, rear, radius, tumble,
                        nose, tail, rng.uniform(0.3, 0.75), rng.uniform(0.05, 0.1), rng.random(), rng.random(), floor])
    return parts, tables, numbers


def clutter(rng, scale):
    """One thing that is no car, standing near the origin, about `scale` wide; vertices and faces."""
    kind = rng.integers(0, 12)
    a, b, c = rng.uniform(0.3, 1.0, 3) * scale
    if kind < 3:
        return box((a, b, c), turn=rng.uniform(0, 3))
    if kind == 3:
        angle = np.linspace(0, np.pi, 14)
        return turned(np.stack([np.sin(angle) * a / 2, (1 - np.cos(angle)) * a / 2], -1))
    if kind == 4:
        return turned([(0, 0), (a / 3, 0), (a / 3 * rng.uniform(0, 1), c), (0, c)])
    if kind == 5:  # a bottle, a vase, a lamp
        z = np.sort(rng.uniform(0, c, 6))
        return turned([(0, 0), *zip(rng.uniform(0.1, 0.4, 6) * a, z), (0, c)])
    if kind in (6, 7):  # a table, a stool
        made = [box((a, b, c * 0.08), (0, 0, c * 0.6))]
        made += [box((a * 0.07, b * 0.07, c * 0.6), (sx * a * 0.45, sy * b * 0.45, 0)) for sx in (1, -1) for sy in (1, -1)]
        if kind == 7:
            made.append(box((a * 0.07, b, c * 0.5), (a * 0.46, 0, c * 0.66)))
    elif kind == 8:  # a tent card
        v, f = box((a * 0.7, a * 0.5, a * 0.7))
        v[4:, 1] *= 0.05
        made = [(v, f)]
    elif kind == 9:  # a stack
        made, z = [], 0.0
        for _ in range(rng.integers(2, 5)):
            size = rng.uniform(0.2, 0.7, 3) * scale * (1, 1, 0.5)
            made.append(box(size, (*rng.normal(0, 0.03, 2) * scale, z), rng.uniform(0, 3)))
            z += size[2]
    elif kind == 10:  # a card or a sheet lying on the ground
        made = [box((a, a, 0.004), turn=rng.uniform(0, 3))]
    else:  # a cupboard, a wall, a building
        made = [box((a * 2, b * 0.5, c * 2), turn=rng.uniform(0, 3))]
    start, vs, fs = 0, [], []
    for v, f in made:
        vs.append(v)
        fs.append(f + start)
        start += len(v)
    return np.concatenate(vs), np.concatenate(fs)

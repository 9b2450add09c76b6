"""A small rasteriser: triangles into a depth buffer, then every pixel is lit (sun, sky, what is mirrored in paint and glass)."""

import numpy as np
from numba import njit

FAST = {"cache": True, "fastmath": True}


@njit(**FAST)
def rasterise(screen, faces, w, h, owner, depth, index, bary):
    """`screen`: x, y in pixels and 1/distance of each vertex (0: behind the camera)."""
    for f in range(faces.shape[0]):
        a, b, c = screen[faces[f, 0]], screen[faces[f, 1]], screen[faces[f, 2]]
        if a[2] <= 0 or b[2] <= 0 or c[2] <= 0:
            continue
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-9:
            continue
        x0, x1 = max(0, int(np.ceil(min(a[0], b[0], c[0])))), min(w - 1, int(np.floor(max(a[0], b[0], c[0]))))
        y0, y1 = max(0, int(np.ceil(min(a[1], b[1], c[1])))), min(h - 1, int(np.floor(max(a[1], b[1], c[1]))))
        for y in range(y0, y1 + 1):
            for x in range(x0, x1 + 1):
                u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area
                v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area
                t = 1 - u - v
                if u < -1e-6 or v < -1e-6 or t < -1e-6:
                    continue
                near = u * a[2] + v * b[2] + t * c[2]
                if near > depth[y, x]:
                    depth[y, x] = near
                    index[y, x] = f
                    bary[y, x, 0], bary[y, x, 1], bary[y, x, 2] = u * a[2] / near, v * b[2] / near, t * c[2] / near


@njit(**FAST)
def table(values, s):
    """`values` at the share `s` of their length."""
    p = min(max(s, 0.0), 1.0) * (values.shape[0] - 1)
    i = min(int(p), values.shape[0] - 2)
    return values[i] + (values[i + 1] - values[i]) * (p - i)


@njit(**FAST)
def texel(image, u, v):
    n = image.shape[0]
    return image[int(np.floor(v * n)) % n, int(np.floor(u * n)) % n]


@njit(**FAST)
def car_material(p, n, top, belts, wide, k, look, pattern, out):
    """Colour into `out[:3]`, gloss into `out[3]`: glass, lamps, grille, plates, tyres' arches or paint at `p` of a body."""
    length, half, height, front, rear, radius = k[0], k[1], k[2], k[8], k[9], k[10]
    s = p[0] / length + 0.5
    zt, zb, side = table(top, s), table(belts, s), abs(p[1]) / (table(wide, s) + 1e-6)
    for i in range(3):
        out[i] = look[i]
    out[3] = look[3]
    if look[4] > 0:  # a pattern: world-aligned from above, from the side, from the front
        if abs(n[2]) > 0.75:
            c = texel(pattern, p[0] / look[4], p[1] / look[4])
        elif abs(n[1]) > abs(n[0]):
            c = texel(pattern, p[0] / look[4], -p[2] / look[4])
        else:
            c = texel(pattern, p[1] / look[4], -p[2] / look[4])
        for i in range(3):
            out[i] = c[i]
    elif look[5] > 0:  # two colours: below the belt, a stripe along, or the roof
        kind = int(look[5])
        if (kind == 1 and p[2] < zb * 0.62) or (kind == 2 and abs(abs(p[1]) - 0.22) < 0.14 and n[2] > 0.2) or (kind == 3 and p[2] > zb + 0.1):
            for i in range(3):
                out[i] = look[6 + i]
    black = -1.0
    gloss = 0.2
    # Glass.
    pillar = k[15]
    if p[2] > zb + 0.035 and zt > zb + 0.12:
        is_side = abs(n[1]) > 0.5 and p[2] < zt - 0.09 and p[0] < k[5] - 0.15 and p[0] > k[7] + 0.15
        b_pillar = k[4] + (k[6] - k[4]) * (0.35 + 0.2 * k[16])
        if is_side and abs(p[0] - b_pillar) > pillar * 0.6 and abs(p[0] - (b_pillar + k[6]) / 2 + 0.3) > pillar * 0.4:
            black, gloss = 0.02 + 0.05 * k[17], 0.9
        shield = p[0] > k[4] + 0.06 and p[0] < k[5] - 0.03 and side < 0.86 - 0.1 * k[16] and n[0] > 0.12
        screen = p[0] < k[6] - 0.05 and p[2] < height - 0.12 and side < 0.8 and n[0] < -0.12 and p[2] > zb + 0.06
        if shield or screen:
            black, gloss = 0.02 + 0.05 * k[17], 0.9
    # Arches and sills.
    for axle in (front, rear):
        if side > 0.8 and (p[0] - axle) ** 2 + (p[2] - radius) ** 2 < (radius * 1.13) ** 2:
            black, gloss = 0.01, 0.05
    if p[2] < k[18] + 0.1 * look[9]:
        black, gloss = 0.03, 0.1
    # Gaps of doors and bonnet.
    if side > 0.85 and p[2] < zb and p[2] > k[18] + 0.1 and (abs(p[0] - k[4] - 0.25) < 0.012 or abs(p[0] - (k[4] + k[6]) / 2) < 0.012 or abs(p[0] - k[6]) < 0.012):
        black = 0.04
    if abs(p[0] - k[5] - 0.03) < 0.014 and n[2] > 0.3:
        black = 0.04
    if side > 0.9 and abs(p[2] - zb + 0.1) < 0.018 and (abs(p[0] - (k[4] + k[6]) / 2 - 0.14) < 0.09):
        black, gloss = 0.05, 0.5
    if black >= 0:
        out[0] = out[1] = out[2] = black
        out[3] = gloss
    # The two ends.
    face = 0
    if p[0] > length * 0.5 - 0.28 and n[0] > 0.25:
        face = 1
    elif p[0] < -length * 0.5 + 0.2 and n[0] < -0.25:
        face = -1
    if face != 0:
        edge = k[12] if face > 0 else k[13]
        lamp_z, lamp_y = edge * (0.9 - 0.25 * k[16]), abs(p[1]) / half
        tall = 0.05 + 0.07 * k[17]
        if abs(p[2] - lamp_z) < tall and lamp_y > 0.62 - 0.2 * k[17] and lamp_y < 0.98:
            bright = 0.75 if face > 0 else 0.35
            out[0], out[1], out[2], out[3] = bright, bright * (1.0 if face > 0 else 0.06), bright * (1.0 if face > 0 else 0.06), 0.7
        elif face > 0 and abs(p[2] - edge * 0.62) < 0.05 + 0.12 * k[16] and lamp_y < k[14]:
            c = 0.02 + (0.12 if int(np.floor(p[2] * 40)) % 2 == 0 else 0.0)
            out[0], out[1], out[2], out[3] = c, c, c, 0.3
        elif abs(p[2] - edge * (0.45 if face > 0 else 0.62)) < 0.055 and abs(p[1]) < 0.26:
            c = 0.8 if abs(p[1]) > 0.23 or int(np.floor(p[1] * 30)) % 2 == 0 else 0.25
            out[0], out[1], out[2], out[3] = c, c, c, 0.1


@njit(**FAST)
def wheel_material(p, radius, look, out):
    r = np.sqrt(p[0] * p[0] + p[2] * p[2]) / radius
    c, gloss = 0.025, 0.05
    if r < 0.66:
        spokes = look[10]
        at = np.arctan2(p[2], p[0]) * spokes / (2 * np.pi)
        is_rim = r > 0.58 or r < 0.18 or abs(at - np.floor(at) - 0.5) < look[11]
        c, gloss = (look[12], 0.6) if is_rim else (0.03, 0.1)
    out[0] = out[1] = out[2] = c
    out[3] = gloss


@njit(**FAST)
def mirrored(x, y, z, sky, panels, out):
    """Sky, horizon and ground in the direction (x, y, z); `sky`: colours of zenith, horizon, ground."""
    at = (np.arctan2(y, x) / (2 * np.pi) + 0.5) * panels.shape[0]
    k = panels[int(at) % panels.shape[0]]
    edge = 0.25 * k
    for i in range(3):
        if z > edge:
            t = min(1.0, (z - edge) / 0.6)
            out[i] = sky[1, i] * (1 - t) + sky[0, i] * t
        elif z > -0.02:
            out[i] = sky[2, i] * (0.4 + 0.5 * k)
        else:
            out[i] = sky[2, i] * (1.0 + 0.3 * z)


@njit(**FAST)
def light(index, bary, faces, owner, world, normal, local, rotation, kinds, looks, tops, belts, wides, numbers, patterns, sun, sky, panels, eye, ray, ground, ground_size, shade, shade_at, has_ground, image):
    """Fills `image` (linear light) wherever there is a thing or the ground."""
    h, w = index.shape
    out, seen = np.zeros(4), np.zeros(3)
    p, n, q = np.zeros(3), np.zeros(3), np.zeros(3)
    for y in range(h):
        for x in range(w):
            d = ray[y, x]
            f = index[y, x]
            shadow, glow = 1.0, 1.0
            if f < 0:
                if not has_ground or d[2] > -0.004:
                    continue
                reach = -eye[2] / d[2]
                p[0], p[1], p[2] = eye[0] + d[0] * reach, eye[1] + d[1] * reach, 0.0
                if reach > 400:
                    continue
                n[0], n[1], n[2] = 0.0, 0.0, 1.0
                c = texel(ground, p[0] / ground_size, p[1] / ground_size)
                out[0], out[1], out[2], out[3] = c[0], c[1], c[2], shade_at[3]
                gx, gy = (p[0] - shade_at[0]) / shade_at[2], (p[1] - shade_at[1]) / shade_at[2]
                if gx >= 0 and gy >= 0 and gx < shade.shape[1] - 1 and gy < shade.shape[0] - 1:
                    shadow, glow = 1 - shade[int(gy), int(gx), 0], 1 - shade[int(gy), int(gx), 1]
            else:
                o = owner[f]
                for i in range(3):
                    p[i] = n[i] = q[i] = 0.0
                for j in range(3):
                    b, at = bary[y, x, j], faces[f, j]
                    for i in range(3):
                        p[i] += b * world[at, i]
                        n[i] += b * normal[f, j, i]
                        q[i] += b * local[at, i]
                size = np.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2) + 1e-9
                facing = 1.0 if n[0] * d[0] + n[1] * d[1] + n[2] * d[2] < 0 else -1.0
                for i in range(3):
                    n[i] *= facing / size
                glow = 0.45 + 0.55 * min(1.0, p[2] / shade_at[4]) if n[2] < 0.5 else 1.0
                r = rotation[o]
                m = (n[0] * r[0] + n[1] * r[1], -n[0] * r[1] + n[1] * r[0], n[2])
                if kinds[o] == 1:
                    car_material(q, m, tops[o], belts[o], wides[o], numbers[o], looks[o], patterns[int(looks[o, 13])], out)
                elif kinds[o] == 2:
                    wheel_material(q, numbers[o, 10], looks[o], out)
                else:
                    for i in range(4):
                        out[i] = looks[o, i]
                    if looks[o, 4] > 0:
                        u = q[0] if abs(m[0]) < 0.7 else q[1]
                        v = q[1] if abs(m[2]) > 0.7 else q[2]
                        c = texel(patterns[int(looks[o, 13])], u / looks[o, 4], -v / looks[o, 4])
                        for i in range(3):
                            out[i] = c[i]
            lit = max(0.0, n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2]) * shadow
            up = 0.5 + 0.5 * n[2]
            turn = -(n[0] * d[0] + n[1] * d[1] + n[2] * d[2])
            mx, my, mz = d[0] + 2 * turn * n[0], d[1] + 2 * turn * n[1], d[2] + 2 * turn * n[2]
            mirrored(mx, my, mz, sky, panels, seen)
            fresnel = out[3] * (0.06 + 0.94 * (1 - min(1.0, abs(turn))) ** 5)
            spark = max(0.0, mx * sun[0] + my * sun[1] + mz * sun[2])
            spark = out[3] * shadow * spark ** (8 + 120 * out[3]) * (0.3 + out[3])
            for i in range(3):
                ambient = (sky[0, i] * up + sky[2, i] * (1 - up)) * glow
                image[y, x, i] = out[i] * (lit * sun[3 + i] + ambient) * (1 - fresnel) + seen[i] * fresnel * glow + spark * sun[3 + i] * 0.5


def normals(v, f, is_smooth):
    """A normal for each corner of each face: the face's own, or the mean round the vertex where the faces turn by less than about 50°."""
    own = np.cross(v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]])
    unit = own / (np.linalg.norm(own, axis=1, keepdims=True) + 1e-12)
    corners = np.repeat(unit[:, None], 3, 1)
    if is_smooth:
        mean = np.zeros_like(v)
        for j in range(3):
            np.add.at(mean, f[:, j], own)
        mean = (mean / (np.linalg.norm(mean, axis=1, keepdims=True) + 1e-12))[f]
        is_near = (mean * corners).sum(-1, keepdims=True) > 0.64
        corners = np.where(is_near, mean, corners)
    return corners

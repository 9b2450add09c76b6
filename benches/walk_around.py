"""A filmed walk round the model of captures/skyline: video files, and where the camera truly was in each frame.

    walk_around.py OUT [--mesh MESH.glb] [--scene SCENE.toml] [--paint normal|random] ...

Writes OUT.camera.yaml, OUT.truth.json and, for each bit rate, OUT_10M.mp4 (--mbit 10 40). A rasteriser (OpenGL by EGL, also without a GPU) draws what the path-traced
photos of captures/skyline show. What is simulated, in this order:

- The camera walks round once (`--path round`), looking at the model, with a hand's shake (`Hand`).
- Every row of the image is exposed for `--exposure-ms`, and starts later than the row above it: the last one `--readout-ms` later (rolling shutter). Poses are
  drawn every fifth of the exposure; each row is the mean, in linear light, of those within its exposure. Each is drawn at another place within the pixel, so
  that edges are anti-aliased.
- Noise of the sensor, sRGB, H.264 by ffmpeg.

The truth of a frame is `T_camera_model` (mm) in the middle of the exposure of the image's middle row, and for its first and last row. `blur_px`: how far the middle row's exposure
smears the eight corners of the model's box, root mean square; `shear_px`: how far they move during the read-out.

captures/walk is: walk_around.py normal --size 1280x720 --fps 12 --seconds 10 --from-deg -22.5 --round-deg 360 --steps 8 --pace 0.97 --exposure-ms 8 --readout-ms 10 --shake 0.5
--noise 1 --preset slow --mbit 1.05, and random with --paint random --seed 2.

Needs: pip install moderngl numpy opencv-python-headless trimesh scipy; ffmpeg; a library libEGL.
"""

import argparse
import json
import subprocess
import tomllib
from pathlib import Path

import cv2
import moderngl
import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

ROOT = Path(__file__).resolve().parent.parent
SUBFRAMES = 5  # of one exposure
NEAR_MM, FAR_MM = 20.0, 60_000.0
PAINT = "Material.001"
FLAT, SHEET, TABLE, PATTERN, SKY = range(5)
CELL_MM = 8.0  # of the random pattern
LIGHT = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])

VERTEX = """
#version 330
uniform mat4 camera_model; uniform vec4 k; uniform vec4 lens; uniform vec2 size; uniform vec2 jitter; uniform vec2 depths;
in vec3 place; in vec3 normal; in vec2 uv; in vec3 colour; in float kind;
out vec3 at; out vec2 st; flat out vec3 n; flat out vec3 c; flat out int what;
void main() {
    vec4 p = camera_model * vec4(place, 1.0);
    float r2 = p.z > 1.0 ? min(dot(p.xy, p.xy) / (p.z * p.z), 1.5) : 1.5;
    vec2 px_z = k.xy * p.xy * (1.0 + lens.x * r2 + lens.y * r2 * r2) + (k.zw + jitter + 0.5) * p.z; // (0, 0) is the centre of the top-left pixel
    vec2 ndc_z = 2.0 * px_z / size - p.z;                   // row 0 of the image is row 0 of the buffer
    float depth_z = ((depths.y + depths.x) * p.z - 2.0 * depths.x * depths.y) / (depths.y - depths.x);
    gl_Position = vec4(ndc_z, depth_z, p.z);
    at = place; st = uv; n = normal; c = colour; what = int(kind + 0.5);
}
"""

FRAGMENT = """
#version 330
uniform sampler2D sheets; uniform sampler2D table; uniform sampler2D pattern; uniform sampler2D sky;
uniform vec3 light; uniform vec3 eye; uniform float cell;
in vec3 at; in vec2 st; flat in vec3 n; flat in vec3 c; flat in int what;
out vec4 shown;
vec3 cells(sampler2D image, vec2 at) {                      // nearest texels, their borders as wide as a pixel
    vec2 width = max(fwidth(at), 1e-4), border = floor(at + 0.5);
    vec2 to = border + clamp((at - border) / width, -0.5, 0.5);
    vec3 root = texture(image, to / vec2(textureSize(image, 0))).rgb;
    return root * root;
}
void main() {
    if (what == 4) { vec3 root = texture(sky, st).rgb; shown = vec4(root * root, 1.0); return; }
    vec3 albedo = c;
    if (what == 1) albedo = cells(sheets, st);
    if (what == 2) { vec3 root = texture(table, st).rgb; albedo = root * root; }
    if (what == 3) {
        vec3 a = abs(n);
        vec2 side = a.z >= max(a.x, a.y) ? vec2(-at.y * sign(n.z), at.x) : a.y >= a.x ? vec2(-at.x * sign(n.y), at.z) : vec2(at.y * sign(n.x), at.z);
        albedo = cells(pattern, vec2(side.x, -side.y) / cell);
    }
    vec3 to_eye = normalize(eye - at);
    vec3 facing = dot(n, to_eye) < 0.0 ? -n : n;
    float direct = max(dot(facing, light), 0.0), around = 0.5 + 0.5 * facing.z;
    vec3 lit = albedo * (0.75 * direct + 0.42 * around + 0.1);
    if (what == 0 || what == 3) lit += 0.05 * pow(max(dot(normalize(light + to_eye), facing), 0.0), 30.0) + 0.02 * around;
    if (what == 2) lit = albedo * (0.75 * light.z + 0.52);
    shown = vec4(lit, 1.0);
}
"""

WHOLE = "#version 330\nin vec2 corner; void main() { gl_Position = vec4(corner, 0.0, 1.0); }"

ROWS = """
#version 330
uniform sampler2D drawn; uniform float from; uniform float to; uniform float exposure; uniform float row_time;
out vec4 added;
void main() {
    float start = floor(gl_FragCoord.y) * row_time;
    float share = max(min(to, start + exposure) - max(from, start), 0.0) / exposure;
    added = vec4(texelFetch(drawn, ivec2(gl_FragCoord.xy), 0).rgb * share, share);
}
"""

DEVELOP = """
#version 330
uniform sampler2D light; uniform sampler2D noise; uniform ivec2 offset; uniform float sigma;
out vec4 shown;
void main() {
    vec3 l = clamp(texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb, 0.0, 1.0);
    vec3 s = mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(l, vec3(0.0031308))));
    ivec2 cell = (ivec2(gl_FragCoord.xy) + offset) % textureSize(noise, 0);
    shown = vec4(s + sigma * texelFetch(noise, cell, 0).rgb, 1.0);
}
"""


def linear(srgb):
    """sRGB in 0 to 1 as linear light."""
    srgb = np.asarray(srgb, float)
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


class Hand:
    """What a hand adds to a quiet walk. Rotation about the camera's axes and translation along them, each a sum of 60 sines of random phase from 0.3 to 12 Hz whose power
    falls with the square of the frequency (so the velocity is white): 0.4 degrees and 4 mm root mean square; with it a step of the walk (1.8 Hz: 0.15 degrees of pitch, 3 mm up)."""

    def __init__(self, seed, strength):
        random = np.random.default_rng(seed)
        self.hz = np.geomspace(0.3, 12.0, 60)
        amplitudes = self.hz**-0.5  # power 1/f² over frequencies spaced by their ratio: a share of df/f² = 1/f
        self.amplitudes = amplitudes / np.sqrt((amplitudes**2).sum() / 2)
        self.phases = random.uniform(0, 2 * np.pi, (6, 60))
        self.strength = strength

    def at(self, t):
        """(rotation vector in rad, translation in mm) in the camera's frame."""
        sines = (self.amplitudes * np.sin(2 * np.pi * self.hz * t + self.phases)).sum(axis=1) * self.strength
        step = self.strength * np.sin(2 * np.pi * 1.8 * t)
        turn = np.radians(0.4) * sines[:3] + np.radians([0.15 * step, 0, 0])
        return turn, 4.0 * sines[3:] + [0, 3.0 * step, 0]


class Walk:
    """`T_camera_model` at any time."""

    def __init__(self, args, target_mm):
        self.args, self.target = args, np.asarray(target_mm)
        self.hand = Hand(args.seed, args.shake)

    def quiet(self, t):
        """Azimuth and pitch (degrees) and distance (mm) without the hand. A round takes the whole film and ten degrees more; feet make it faster and slower."""
        share = t / self.args.seconds
        if self.args.path == "top":
            return 20 * np.sin(2 * np.pi * share), 89.0, 850 + 3 * np.sin(2 * np.pi * share)
        pace = self.args.pace * np.sin(2 * np.pi * share * self.args.steps) / (2 * np.pi * self.args.steps)
        azimuth = self.args.from_deg + self.args.round_deg * (share + pace)
        pitch = 15.5 + 1.5 * np.sin(2 * np.pi * 1.3 * share + 1)
        return azimuth, pitch, 850 + 30 * np.sin(2 * np.pi * 0.7 * share + 2)

    def camera_model(self, t):
        azimuth, pitch, distance = self.quiet(t)
        a, p = np.radians([azimuth, pitch])
        centre = self.target + distance * np.array([np.cos(p) * np.cos(a), np.cos(p) * np.sin(a), np.sin(p)])
        forward = (self.target + [0, 0, -10] - centre) / np.linalg.norm(self.target + [0, 0, -10] - centre)
        right = np.cross(forward, [0, 0, 1.0])
        right /= np.linalg.norm(right)
        looking = np.stack([right, np.cross(forward, right), forward])
        turn, shift = self.hand.at(t)
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(turn).as_matrix() @ looking
        pose[:3, 3] = pose[:3, :3] @ -centre + shift
        return pose


def viewpoint(pose, target):
    """Azimuth, pitch (degrees) and distance (mm) as `Viewpoint` of the crate pose has them."""
    d = -pose[:3, :3].T @ pose[:3, 3] - target
    return np.degrees(np.arctan2(d[1], d[0])) % 360, np.degrees(np.arctan2(d[2], np.hypot(d[0], d[1]))), np.linalg.norm(d)


class Surface:
    """Triangles with what the shader needs: place, normal, texture coordinates, colour, kind."""

    def __init__(self):
        self.parts = []

    def triangles(self, corners, uv=None, colour=(0, 0, 0), kind=FLAT, normals=None):
        corners = np.asarray(corners, float).reshape(-1, 3, 3)
        if normals is None:
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        uv = np.zeros((len(corners), 3, 2)) if uv is None else np.asarray(uv, float).reshape(-1, 3, 2)
        each = np.concatenate([corners, np.repeat(normals[:, None], 3, 1), uv, np.broadcast_to(colour, corners.shape), np.full(corners.shape[:2] + (1,), kind)], axis=2)
        self.parts.append(each.reshape(-1, 12))

    def grid(self, origin, along, down, cells, uv, **more):
        """A parallelogram in cells × cells pieces, so that the lens bends it. `uv`: (left, top, right, bottom)."""
        origin, along, down = (np.asarray(v, float) for v in (origin, along, down))
        steps = np.linspace(0, 1, cells + 1)
        x, y = np.meshgrid(steps, steps)
        points = origin + x[..., None] * along + y[..., None] * down
        st = np.stack([uv[0] + x * (uv[2] - uv[0]), uv[1] + y * (uv[3] - uv[1])], axis=-1)

        def split(grid):
            a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
            return np.stack([a, d, c, a, c, b], axis=2).reshape(-1, grid.shape[-1])

        self.triangles(split(points), split(st), **more)

    def bytes(self):
        return np.concatenate(self.parts).astype("f4").tobytes()


def car(surface, path, length_mm, paint):
    """The mesh in the model's frame: glTF has y up and, this car, its front at +z."""
    scene = trimesh.load(path)
    low, high = scene.bounds
    scale = length_mm / (high[2] - low[2])
    middle = (low + high) / 2
    shadow = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        mesh = scene.geometry[name]
        points = (trimesh.transform_points(mesh.vertices, transform) - [middle[0], low[1], middle[2]]) * scale
        points = points[:, [2, 0, 1]]
        points, faces = trimesh.remesh.subdivide_to_size(points, mesh.faces, 60.0)
        corners = points[faces]
        shadow.append(corners)
        if mesh.visual.material.name == PAINT:
            surface.triangles(corners, colour=linear([0.78, 0.17, 0.16]), kind=PATTERN if paint == "random" else FLAT)
        else:
            surface.triangles(corners, colour=linear(np.asarray(mesh.visual.material.baseColorFactor[:3]) / 255) * 0.8 + 0.02)
    return np.concatenate(shadow)


def sheets(tags):
    """One image of all tags, a texel a module, with a white margin of one module; and where each is."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    columns = 8
    image = np.full((12 * -(-len(tags) // columns), 12 * columns), 255, np.uint8)
    places = []
    for i, tag in enumerate(tags):
        x, y = 12 * (i % columns) + 1, 12 * (i // columns) + 1
        image[y + 1 : y + 9, x + 1 : x + 9] = cv2.aruco.generateImageMarker(dictionary, tag["id"], 8)[::-1, ::-1]  # OpenCV draws them turned by 180 degrees
        places.append((x, y, x + 10, y + 10))
    shade = linear(0.16 + (0.9 - 0.16) * image / 255)
    return np.repeat(shade[..., None], 3, 2), places


def cards(surface, tags, places):
    """Each tag on its card, ten modules wide. Returns the cards' corners for the shadow."""
    corners = []
    for tag, uv in zip(tags, places):
        centre, right, up = (np.array(tag[key], float) for key in ("centre_mm", "right", "up"))
        half = tag["size_mm"] * 10 / 8 / 2
        origin = centre + half * (up - right)
        surface.grid(origin, 2 * half * right, -2 * half * up, 10, uv, kind=SHEET)
        a, b, c, d = origin, origin + 2 * half * right, origin + 2 * half * (right - up), origin - 2 * half * up
        corners.append([[a, b, c], [a, c, d]])
    return np.concatenate(corners)


def table(shadow_of, half_mm, px):
    """A worn grey table with the soft shadow of all that stands on it: image, texture coordinates from -half to half."""
    random = np.random.default_rng(3)
    worn = sum(cv2.GaussianBlur(random.standard_normal((px, px)), (0, 0), s) * s * a for s, a in ((1.0, 0.02), (4, 0.05), (25, 0.1)))
    grey = 0.33 * (1 + 0.6 * worn)
    shade = np.zeros((px, px), np.float32)
    for softness, slant, depth in ((5, 1.0, 0.55), (14, 0.0, 0.5)):
        mask = np.zeros((px, px), np.uint8)
        flat = shadow_of - slant * shadow_of[..., 2:] / LIGHT[2] * LIGHT
        for triangle in (flat[..., :2] / half_mm * 0.5 + 0.5) * px:
            cv2.fillConvexPoly(mask, np.rint(triangle * 16).astype(np.int32), 255, shift=4)
        shade = np.maximum(shade, depth * cv2.GaussianBlur(mask, (0, 0), softness) / 255)
    return np.clip(grey * (1 - shade), 0, 1)[..., None] * np.array([0.97, 1.0, 1.03])


def surroundings():
    """A blurred town round the table, as far as a lens that is focused on the model shows it: azimuth across, elevation down from 30 degrees to -90."""
    random = np.random.default_rng(5)
    sky = np.zeros((400, 2048, 3))
    sky[:] = np.linspace([0.62, 0.72, 0.85], [0.75, 0.78, 0.8], 400)[:, None]
    x = 0
    while x < 2048:
        width, top = random.integers(40, 190), random.integers(0, 90)
        tone = random.uniform(0.05, 0.5) * random.uniform(0.9, 1.1, 3)
        sky[top:, x : x + width] = tone
        for window in range(x + 6, min(x + width, 2048) - 10, 18):
            sky[top + 8 : 400 : 22, window : window + 9] = tone * random.uniform(0.5, 1.6)
        x += width
    sky[130:] = [0.28, 0.28, 0.27]
    return cv2.GaussianBlur(np.tile(sky, (1, 3, 1)), (0, 0), 5)[:, 2048:4096]


def sky_ball(surface, radius):
    """The surroundings on a ball, elevation 30 to -90 degrees."""
    def at(column, row):
        a, e = 2 * np.pi * column / 48, np.radians(30 - 120 * row / 24)
        return [radius * np.cos(e) * np.cos(a), radius * np.cos(e) * np.sin(a), radius * np.sin(e)], [column / 48, row / 24]
    for row in range(24):
        corners, uv = [], []
        for column in range(48):
            a, b, c, d = (at(column + i, row + j) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
            for p in (a, b, c, a, c, d):
                corners.append(p[0])
                uv.append(p[1])
        surface.triangles(corners, uv, kind=SKY)


class Studio:
    """The scene in OpenGL, and one frame of the film at a time."""

    def __init__(self, args, camera):
        self.args, self.camera = args, camera
        scene = tomllib.loads(args.scene.read_text())
        surface = Surface()
        images = self.scenery(surface, scene)
        gl = self.gl = moderngl.create_standalone_context(backend="egl")
        self.program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
        for slot, (name, image) in enumerate(images.items()):
            self.texture(image, name in ("table", "sky")).use(slot)
            self.program[name] = slot
        self.program["light"] = tuple(LIGHT)
        self.program["cell"] = CELL_MM
        self.program["size"] = args.size
        self.program["depths"] = (NEAR_MM, FAR_MM)
        self.program["k"] = tuple(camera[key] for key in ("fx", "fy", "cx", "cy"))
        self.program["lens"] = (camera["k1"], camera["k2"], 0, 0)
        names = ("place", "normal", "uv", "colour", "kind")
        self.scene = gl.vertex_array(self.program, [(gl.buffer(surface.bytes()), "3f 3f 2f 3f 1f", *names)])
        whole = gl.buffer(np.array([-1, -1, 3, -1, -1, 3], "f4").tobytes())
        self.drawn = gl.texture(args.size, 4, dtype="f2")
        self.view = gl.framebuffer([self.drawn], gl.depth_renderbuffer(args.size))
        self.light = gl.texture(args.size, 4, dtype="f4")
        self.sum = gl.framebuffer([self.light])
        self.rows = gl.vertex_array(gl.program(vertex_shader=WHOLE, fragment_shader=ROWS), [(whole, "2f", "corner")])
        self.develop = gl.vertex_array(gl.program(vertex_shader=WHOLE, fragment_shader=DEVELOP), [(whole, "2f", "corner")])
        self.shown = gl.framebuffer([gl.texture(args.size, 3)])
        noise = np.random.default_rng(args.seed).standard_normal((512, 512, 3)).astype("f4")
        gl.texture((512, 512), 3, noise.tobytes(), dtype="f4").use(10)
        self.develop.program["noise"] = 10
        self.drawn.use(8)
        self.rows.program["drawn"] = 8
        self.light.use(9)
        self.develop.program["light"] = 9
        self.develop.program["sigma"] = args.noise / 255

    def scenery(self, surface, scene):
        tags = scene["tag"]
        image, places = sheets(tags)
        standing = [cards(surface, tags, places), car(surface, self.args.mesh, scene["model"]["size_mm"][0], self.args.paint)]
        half = 1000.0
        surface.grid([-half, -half, 0], [2 * half, 0, 0], [0, 2 * half, 0], 40, (0, 0, 1, 1), kind=TABLE, normals=np.array([[0, 0, 1.0]]).repeat(3200, 0))
        sky_ball(surface, 20_000.0)
        pattern = cv2.imread(str(self.args.pattern))[..., ::-1] / 255
        return {"sheets": image, "table": table(np.concatenate(standing), half, 2048), "pattern": linear(0.1 + 0.8 * pattern), "sky": surroundings()}

    def texture(self, image, smooth):
        image = np.dstack([np.sqrt(image), np.ones(image.shape[:2])])  # eight bits of linear light were too few for the dark
        texture = self.gl.texture(image.shape[1::-1], 4, np.rint(255 * image).astype(np.uint8).tobytes())
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        if smooth:
            texture.build_mipmaps()
            texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        return texture

    def frame(self, number, start, walk):
        """The image whose first row's exposure begins at `start` (seconds), RGB."""
        exposure, readout = self.args.exposure_ms / 1e3, self.args.readout_ms / 1e3
        (width, height), step = self.args.size, exposure / SUBFRAMES
        row_time = readout / height
        self.sum.clear()
        for i in range(int(np.ceil((exposure + readout) / step - 1e-6))):
            first = max(0, int((i * step - exposure) / row_time) - 1) if row_time else 0
            last = min(height, int((i + 1) * step / row_time) + 2) if row_time else height
            self.draw(walk.camera_model(start + (i + 0.5) * step), number * 7 + i, first, last)
            gl, program = self.gl, self.rows.program
            self.sum.use()
            self.sum.scissor = (0, first, width, last - first)
            gl.disable(moderngl.DEPTH_TEST)
            gl.enable(moderngl.BLEND)
            gl.blend_func = moderngl.ONE, moderngl.ONE
            program["from"], program["to"] = i * step, (i + 1) * step
            program["exposure"], program["row_time"] = exposure, row_time
            self.rows.render()
            gl.disable(moderngl.BLEND)
            self.sum.scissor = None
        self.shown.use()
        self.develop.program["offset"] = tuple(np.random.default_rng(number).integers(0, 512, 2).tolist())
        self.develop.render()
        return np.frombuffer(self.shown.read(components=3, alignment=1), np.uint8).reshape(height, width, 3)

    def draw(self, pose, number, first, last):
        """One instant, the rows from `first` on."""
        self.view.use()
        self.view.scissor = (0, first, self.args.size[0], last - first)
        self.gl.enable(moderngl.DEPTH_TEST)
        self.view.clear(0.5, 0.5, 0.5, depth=1.0)
        self.program["camera_model"] = tuple(pose.T.ravel())
        self.program["eye"] = tuple(-pose[:3, :3].T @ pose[:3, 3])
        # The sequence R2 of M. Roberts ("The unreasonable effectiveness of quasirandom sequences", 2018): any few that follow each other are spread.
        self.program["jitter"] = tuple((number * np.array([0.7548776662, 0.5698402910])) % 1 - 0.5)
        self.scene.render()


def project(camera, pose, points):
    p = points @ pose[:3, :3].T + pose[:3, 3]
    ray = p[:, :2] / p[:, 2:]
    r2 = (ray**2).sum(axis=1, keepdims=True)
    ray = ray * (1 + camera["k1"] * r2 + camera["k2"] * r2**2)
    return ray * [camera["fx"], camera["fy"]] + [camera["cx"], camera["cy"]]


def numbers(pose):
    return np.round(pose, 7).tolist()


def truth(args, camera, walk, number, size_mm):
    """Where the camera was in a frame, and how far the image moved."""
    exposure, readout = args.exposure_ms / 1e3, args.readout_ms / 1e3
    middle = number / args.fps + exposure / 2 + readout / 2
    pose = walk.camera_model(middle)
    box = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)]) * size_mm
    moved = lambda seconds: float(np.sqrt((np.diff([project(camera, walk.camera_model(middle + s), box) for s in (-seconds / 2, seconds / 2)], axis=0) ** 2).sum(-1).mean()))
    azimuth, pitch, distance = viewpoint(pose, walk.target)
    return {
        "frame": number,
        "time_s": round(number / args.fps, 6),
        "azimuth_deg": round(azimuth, 6),
        "pitch_deg": round(pitch, 6),
        "distance_mm": round(distance, 4),
        "blur_px": round(moved(exposure), 3),
        "shear_px": round(moved(readout), 3),
        "T_camera_model_mm": numbers(pose),
        "T_camera_model_first_row_mm": numbers(walk.camera_model(middle - readout / 2)),
        "T_camera_model_last_row_mm": numbers(walk.camera_model(middle + readout / 2)),
    }


def camera_file(camera, size):
    row = ", ".join(str(v) for v in (camera["fx"], 0.0, camera["cx"], 0.0, camera["fy"], camera["cy"], 0.0, 0.0, 1.0))
    matrix = lambda name, rows, columns, data: f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n"
    head = f"%YAML:1.0\n---\nimage_width: {size[0]}\nimage_height: {size[1]}\n"
    return head + matrix("camera_matrix", 3, 3, row) + matrix("distortion_coefficients", 1, 5, f"{camera['k1']}, {camera['k2']}, 0.0, 0.0, 0.0")


def encoders(args):
    """One ffmpeg for each bit rate; H.264 as fast as the chips of telephones have it, a key frame each second."""
    size = f"{args.size[0]}x{args.size[1]}"
    raw = ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", str(args.fps), "-i", "-"]
    bt709 = ["-vf", "scale=out_color_matrix=bt709", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"]
    h264 = [*bt709, "-c:v", "libx264", "-preset", args.preset, "-pix_fmt", "yuv420p", "-g", str(round(args.fps)), "-movflags", "+faststart"]
    for mbit in args.mbit:
        rate = ["-b:v", f"{mbit}M", "-maxrate", f"{1.5 * mbit}M", "-bufsize", f"{2 * mbit}M"]
        yield subprocess.Popen([*raw, *h264, *rate, f"{args.out}_{mbit:g}M.mp4"], stdin=subprocess.PIPE)


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("out", type=Path)
    parse.add_argument("--mesh", type=Path, default=ROOT.parent / "shared/meshes/skyline_r32_lowpoly_ccby4.glb")
    parse.add_argument("--scene", type=Path, default=ROOT / "captures/skyline/scene.toml")
    parse.add_argument("--pattern", type=Path, default=ROOT.parent / "shared/patterns/random16.png")
    parse.add_argument("--paint", choices=("normal", "random"), default="normal")
    parse.add_argument("--size", type=lambda text: tuple(map(int, text.split("x"))), default=(1920, 1080))
    parse.add_argument("--fps", type=float, default=30.0)
    parse.add_argument("--seconds", type=float, default=30.0)
    parse.add_argument("--path", choices=("round", "top"), default="round")
    parse.add_argument("--from-deg", type=float, default=-12.0)
    parse.add_argument("--round-deg", type=float, default=370.0)
    parse.add_argument("--pace", type=float, default=0.7, help="0: even; below 1")
    parse.add_argument("--steps", type=float, default=20.0, help="how often the walk is slow and fast")
    parse.add_argument("--exposure-ms", type=float, default=1000 / 60)
    parse.add_argument("--readout-ms", type=float, default=20.0)
    parse.add_argument("--shake", type=float, default=1.0)
    parse.add_argument("--noise", type=float, default=2.0, help="sigma, levels of 255")
    parse.add_argument("--mbit", type=float, nargs="*", default=[10.0, 40.0])
    parse.add_argument("--preset", default="veryfast")
    parse.add_argument("--stills", type=int, nargs="*", help="write these frames as OUT_NUMBER_0.png instead, sharp (1 ms, no rolling shutter) and at the truth's poses")
    parse.add_argument("--draws", type=int, default=1, help="with --stills: draw each so often, with other noise and other places within the pixel, as OUT_NUMBER_DRAW.png")
    parse.add_argument("--seed", type=int, default=1)
    args = parse.parse_args()
    scale = args.size[0] / 1920
    middle = [(side - 1) / 2 for side in args.size]
    camera = {"fx": 1420 * scale, "fy": 1420 * scale, "cx": middle[0] + 8.4 * scale, "cy": middle[1] - 5.2 * scale, "k1": -0.06, "k2": 0.02}
    size_mm = tomllib.loads(args.scene.read_text())["model"]["size_mm"]
    walk = Walk(args, [0, 0, size_mm[2] / 2])
    frames = [truth(args, camera, walk, n, np.array(size_mm)) for n in range(round(args.seconds * args.fps))]
    if args.stills is not None:
        args.exposure_ms, args.readout_ms = 1e-3, 0.0
        studio = Studio(args, camera)
        for number in args.stills:
            still = type("Still", (), {"camera_model": lambda self, t: np.array(frames[number]["T_camera_model_mm"])})()
            for draw in range(args.draws):
                cv2.imwrite(f"{args.out}_{number:04}_{draw}.png", studio.frame(number + 1000 * draw, 0.0, still)[..., ::-1])
        return
    studio = Studio(args, camera)
    stated = {key: getattr(args, key) for key in ("fps", "seconds", "path", "paint", "exposure_ms", "readout_ms", "shake", "noise", "seed")}
    Path(f"{args.out}.camera.yaml").write_text(camera_file(camera, args.size))
    head = json.dumps({"target_mm": walk.target.tolist(), **stated})
    lines = ",\n".join(json.dumps(frame) for frame in frames)
    Path(f"{args.out}.truth.json").write_text(f'{head[:-1]}, "frames": [\n{lines}\n]}}\n')
    films = list(encoders(args))
    for frame in frames:
        image = studio.frame(frame["frame"], frame["frame"] / args.fps, walk).tobytes()
        for film in films:
            film.stdin.write(image)
        if frame["frame"] % 30 == 0:
            print(f"frame {frame['frame']} of {len(frames)}", flush=True)
    for film in films:
        film.stdin.close()
        if film.wait():
            raise SystemExit("ffmpeg failed")


if __name__ == "__main__":
    main()

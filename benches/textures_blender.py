"""Holds previews and baked meshes against Blender Cycles: the figures in docs/guide/reference/measured.md.

    pip install 'bpy==4.5.*'
    python benches/textures_blender.py PROGRAM SKYLINE CAMOUFLAGE FOLDER

SKYLINE and CAMOUFLAGE: as for textures.sh. A pixel is the mean of the same 3 × 3 points in both images. Two minutes on two cores.
"""

import json
import math
import os
import subprocess
import sys

import bpy
import numpy as np

SIZE, POINTS = (720, 540), 3
VIEWS = [(30, 20), (215, 10), (120, 45)]
# Fitted by the test `the_published_camouflage_looks_as_its_authors_drew_it`: azimuth, pitch, distance in half lengths, focal length, principal point.
AUTHORS = (314.5, 36.25, 3.4, 312.8125, 319.25, 319.0)
# Of what has no image, as in the previews.
GREY = ((96 / 255 + 0.055) / 1.055) ** 2.4


def read(path):
    """Blender's import in the model frame: 1 unit long, front to +x, middle at the origin."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if path.endswith(".glb"):
        bpy.ops.import_scene.gltf(filepath=path)
        turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    else:
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
        turn = np.eye(3)
    things = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    places = [np.array([turn @ (thing.matrix_world @ v.co) for v in thing.data.vertices]) for thing in things]
    # What no face uses is no part of the model.
    used = [p[sorted({i for face in thing.data.polygons for i in face.vertices})] for p, thing in zip(places, things)]
    low, high = np.concatenate(used).min(0), np.concatenate(used).max(0)
    for thing, place in zip(things, places):
        thing.parent, thing.matrix_world = None, np.eye(4).tolist()
        thing.data.vertices.foreach_set("co", ((place - (low + high) / 2) / (high - low)[0]).astype(np.float32).ravel())
        thing.data.update()
    return things


def emit(things, to_lamp, what):
    """Materials that no light falls on: `colour` as the previews are lit, `flat`, `back` where a face is seen from behind, or `paint`."""
    for material in {slot.material for thing in things for slot in thing.material_slots if slot.material}:
        nodes, link = material.node_tree.nodes, material.node_tree.links.new
        image = next((node for node in nodes if node.type == "TEX_IMAGE"), None)
        for node in [node for node in nodes if node != image]:
            nodes.remove(node)
        emission, surface = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeNewGeometry")
        link(emission.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        grey = float(material.name != "rest") if what == "paint" else GREY
        emission.inputs["Color"].default_value = (grey, grey, grey, 1)
        if what == "back":
            link(surface.outputs["Backfacing"], emission.inputs["Color"])
        elif image is not None and what != "paint":
            image.interpolation = "Closest"
            link(image.outputs["Color"], emission.inputs["Color"])
        if what == "colour":
            # 0.4 + 0.6 · max(0, n · l)
            value = surface.outputs["True Normal"]
            for kind, operation, number in (("VectorMath", "DOT_PRODUCT", to_lamp), ("Math", "MAXIMUM", 0.0), ("Math", "MULTIPLY_ADD", 0.6)):
                node = nodes.new("ShaderNode" + kind)
                node.operation, node.inputs[1].default_value = operation, number
                link(value, node.inputs[0])
                value = node.outputs["Value"]
            node.inputs[2].default_value = 0.4
            link(value, emission.inputs["Strength"])


def draw(things, view, size, pinhole, what="colour"):
    """Linear light and coverage at the points of each pixel, from a camera `distance` lengths away that looks at the middle."""
    azimuth, pitch, distance = math.radians(view[0]), math.radians(view[1]), view[2]
    back = np.array([math.cos(azimuth) * math.cos(pitch), math.sin(azimuth) * math.cos(pitch), math.sin(pitch)])
    right = np.array([-math.sin(azimuth), math.cos(azimuth), 0])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = np.stack([right, np.cross(back, right), back], axis=1), distance * back
    # The lamp of the previews stands to the left, above and behind the camera.
    emit(things, pose[:3, :3] @ np.array([-0.4, 0.7, 0.6]) / np.linalg.norm([0.4, 0.7, 0.6]), what)
    scene, camera = bpy.context.scene, bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.matrix_world = pose.T.tolist()
    focal_length_px, cx, cy = pinhole
    camera.sensor_fit, camera.sensor_width, camera.lens = "HORIZONTAL", 36.0, focal_length_px * 36.0 / size[0]
    camera.shift_x, camera.shift_y = ((size[0] - 1) / 2 - cx) / size[0], (cy - (size[1] - 1) / 2) / size[0]
    camera.clip_start = 0.01
    render, scene.view_settings.view_transform = scene.render, "Raw"
    render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width, render.film_transparent = "BOX", 0.01, True
    render.resolution_x, render.resolution_y, render.resolution_percentage = POINTS * size[0], POINTS * size[1], 100
    file = render.image_settings
    file.file_format, file.color_mode, file.color_depth = "OPEN_EXR", "RGBA", "32"
    render.filepath = os.path.join(sys.argv[4], "blender.exr")
    bpy.ops.render.render(write_still=True)
    return load(render.filepath)


def load(path):
    """Rows from the top, the numbers of the file."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    rows = pixels.reshape(image.size[1], image.size[0], -1)[::-1]
    bpy.data.images.remove(image)
    return rows


def in_blocks(rows, side):
    return rows.reshape(rows.shape[0] // side, side, rows.shape[1] // side, side, -1)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def compare(title, things, arguments):
    """Our previews against Blender's of the same views. `one colour`: pixels whose points have one colour, so that borders of texels do not count."""
    for azimuth, pitch in VIEWS:
        path = os.path.join(sys.argv[4], f"{title}-{azimuth}.png")
        run = [sys.argv[1], "--quiet", "texture", "show", *arguments, "--azimuth-deg", str(azimuth), "--pitch-deg", str(pitch)]
        said = json.loads(subprocess.check_output([*run, "--size-px", f"{SIZE[0]}x{SIZE[1]}", "--json", "-o", path]))
        focal_length_px = SIZE[0] / 2 / math.tan(math.radians(said["field_of_view_deg"]) / 2)
        pinhole = (focal_length_px, (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2)
        view = (azimuth, pitch, said["distance_mm"] / 1000)
        lit, flat, back = (in_blocks(draw(things, view, SIZE, pinhole, what), POINTS) for what in ("colour", "flat", "back"))
        theirs, ours, back = lit.mean((1, 3)), 255 * load(path)[..., :3], back.mean((1, 3))[..., 0]
        covered = theirs[..., 3]
        off = np.abs(srgb(theirs[..., :3] + 1 - covered[..., None]) - ours).max(-1)
        inside = covered == 1
        one = inside & (np.ptp(flat, axis=(1, 3)).max(-1) < 1e-3)
        print(
            f"{title}, {azimuth}°, {pitch}°: IoU {overlap(covered > 0, (ours < 254.5).any(-1)):.4f}; {inside.sum()} pixels inside, "
            f"{100 * (off[inside] <= 2).mean():.2f} % within 2 of 255; {one.sum()} of one colour, {100 * (off[one] <= 2).mean():.2f} %; "
            f"{100 * back[inside].mean():.2f} % seen from behind",
            flush=True,
        )


def chroma(rgb):
    linear = np.where(rgb <= 10.31475, rgb / 3294.6, ((rgb / 255 + 0.055) / 1.055) ** 2.4)
    to_xyz = np.array([[0.4124564, 0.2126729, 0.0193339], [0.3575761, 0.7151522, 0.119192], [0.1804375, 0.072175, 0.9503041]])
    f = np.cbrt(linear @ to_xyz / [0.95047, 1, 1.08883])
    return np.hypot(500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2]))


def authors(obj, faces, picture):
    """Blender's drawing of the camouflage against that of its authors' renderer: outline, and the paint's chroma in blocks of 2 × 2 pixels."""
    things = read(obj)
    rest = things[0].data.materials[0].copy()
    rest.name = "rest"
    things[0].data.materials.append(rest)
    with open(faces, encoding="utf-8") as file:
        painted = {int(line) for line in file.read().split()}
    for i, polygon in enumerate(things[0].data.polygons):
        polygon.material_index = int(i not in painted)
    azimuth, pitch, distance, *pinhole = AUTHORS
    paint, ours = (
        in_blocks(draw(things, (azimuth, pitch, distance / 2), (640, 640), pinhole, what), POINTS).mean((1, 3)) for what in ("paint", "flat")
    )
    theirs = 255 * load(picture)[..., :3]
    is_model = theirs.min(-1) < 249.5
    blocks = lambda rows: in_blocks(rows, 2).mean((1, 3)).reshape(320 * 320, -1)
    whole = blocks((paint[..., 0] * is_model)[..., None])[:, 0] == 1
    ranks = [np.argsort(np.argsort(chroma(blocks(rgb)[whole]))) for rgb in (srgb(ours[..., :3]), theirs)]
    print(
        f"Blender against the authors' picture: IoU {overlap(ours[..., 3] > 0.5, is_model):.4f}; "
        f"rank correlation of chroma {np.corrcoef(*ranks)[0, 1]:.3f} in {whole.sum()} blocks of the paint"
    )


def main():
    program, skyline, camouflage, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    obj, faces, picture = (os.path.join(camouflage, name) for name in ("model_save.obj", "exterior_face.txt", "textur_render.png"))
    pattern = os.path.join(os.path.dirname(__file__), "..", "print_templates", "random16.png")
    tile = ["--length-mm", "1000", "--pattern", pattern, "--tile-mm", "500"]
    etron = ["--mesh", obj, "--faces", faces]
    compare("camouflage", read(obj), [*etron, "--length-mm", "1000", "--texture", obj])
    for name, model in (("skyline", ["--mesh", skyline, "--material", "Material.001"]), ("etron", etron)):
        baked = os.path.join(folder, name)
        subprocess.check_call([program, "--quiet", "texture", "bake", *model, *tile, "--size", "4096", "-o", baked + ".png"])
        compare(name, read(baked + ".glb"), [*model, *tile])
    authors(obj, faces, picture)


main()

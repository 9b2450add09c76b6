"""The figures of Blender in docs/guide/reference/measured.md: what this program draws and bakes, drawn by Blender Cycles from the same view.

    pip install 'bpy==4.5.*'
    python benches/textures_blender.py PROGRAM SKYLINE CAMOUFLAGE FOLDER

SKYLINE and CAMOUFLAGE: as for textures.sh. A pixel is the mean of 3 × 3 points in both images. Three minutes on two cores.
"""

import json
import math
import os
import subprocess
import sys

import bpy
import numpy as np

SIZE = (720, 540)
POINTS = 3
VIEWS = [(30, 20), (215, 10), (120, 45)]
# Fitted by the test `the_published_camouflage_looks_as_its_authors_drew_it`: azimuth, pitch, distance in half lengths, focal length and principal point.
AUTHORS = (314.5, 36.25, 3.4, 312.8125, 319.25, 319.0)
# Where paint ends, as `texture show` has it.
GREY = (96 / 255 + 0.055) / 1.055
GREY = GREY**2.4


def read(path, glb):
    """Blender's import in the model frame: 1 unit long, front to +x, middle at the origin."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if glb:
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z")
    things = [o for o in bpy.data.objects if o.type == "MESH"]
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) if glb else np.eye(3)
    places = []
    for thing in things:
        world = np.array(thing.matrix_world)
        local = np.array([v.co for v in thing.data.vertices])
        places.append((local @ world[:3, :3].T + world[:3, 3]) @ turn.T)
    # What no face uses is no part of the model.
    used = [p[sorted({i for face in thing.data.polygons for i in face.vertices})] for p, thing in zip(places, things)]
    low, high = np.concatenate(used).min(0), np.concatenate(used).max(0)
    for thing, place in zip(things, places):
        thing.parent, thing.matrix_world = None, ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
        moved = (place - (low + high) / 2) / (high - low)[0]
        thing.data.vertices.foreach_set("co", moved.astype(np.float32).ravel())
        thing.data.update()
    return things


def emit(things, to_lamp, what):
    """Materials without light of the scene: `colour` as the previews are lit, or `flat`, `back` where a face is seen from behind, or `paint`."""
    for material in {slot.material for thing in things for slot in thing.material_slots if slot.material}:
        nodes, links = material.node_tree.nodes, material.node_tree.links
        image = next((node for node in nodes if node.type == "TEX_IMAGE"), None)
        for node in [node for node in nodes if node != image]:
            nodes.remove(node)
        emission, output = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeOutputMaterial")
        place, dot, lit = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeMath")
        links.new(emission.outputs[0], output.inputs["Surface"])
        grey = float(material.name != "rest") if what == "paint" else GREY
        emission.inputs["Color"].default_value = (grey, grey, grey, 1)
        if what == "back":
            links.new(place.outputs["Backfacing"], emission.inputs["Color"])
        elif image is not None and what != "paint":
            image.interpolation = "Closest"
            links.new(image.outputs["Color"], emission.inputs["Color"])
        if what == "colour":
            # 0.4 + 0.6 · max(0, n · l)
            dot.operation, dot.inputs[1].default_value = "DOT_PRODUCT", to_lamp
            lit.operation, lit.inputs[1].default_value, lit.inputs[2].default_value = "MULTIPLY_ADD", 0.6, 0.4
            positive = nodes.new("ShaderNodeMath")
            positive.operation, positive.inputs[1].default_value = "MAXIMUM", 0.0
            links.new(place.outputs["True Normal"], dot.inputs[0])
            links.new(dot.outputs["Value"], positive.inputs[0])
            links.new(positive.outputs[0], lit.inputs[0])
            links.new(lit.outputs[0], emission.inputs["Strength"])


def draw(things, view, size, pinhole, what="colour"):
    """Linear light and coverage at 3 × 3 points of each pixel, from a camera `distance` lengths away that looks at the middle."""
    azimuth, pitch, distance = math.radians(view[0]), math.radians(view[1]), view[2]
    back = np.array([math.cos(azimuth) * math.cos(pitch), math.sin(azimuth) * math.cos(pitch), math.sin(pitch)])
    right = np.cross([0, 0, 1], back) / np.linalg.norm(np.cross([0, 0, 1], back))
    turn = np.stack([right, np.cross(back, right), back], axis=1)
    scene, data = bpy.context.scene, bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, distance * back
    scene.camera.matrix_world = [list(c) for c in pose.T]
    # The lamp of the previews: to the right, down and along the view.
    emit(things, turn @ np.array([-0.4, 0.7, 0.6]) / np.linalg.norm([0.4, 0.7, 0.6]), what)
    focal_length_px, cx, cy = pinhole
    data.sensor_fit, data.sensor_width, data.lens = "HORIZONTAL", 36.0, focal_length_px * 36.0 / size[0]
    data.shift_x, data.shift_y = ((size[0] - 1) / 2 - cx) / size[0], (cy - (size[1] - 1) / 2) / size[0]
    data.clip_start = 0.01
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    scene.render.film_transparent, scene.view_settings.view_transform = True, "Raw"
    scene.render.resolution_x, scene.render.resolution_y = POINTS * size[0], POINTS * size[1]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_mode = "OPEN_EXR", "RGBA"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = os.path.join(sys.argv[4], "blender.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(POINTS * size[1], POINTS * size[0], 4)[::-1]


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def by_pixel(points):
    return points.reshape(points.shape[0] // POINTS, POINTS, points.shape[1] // POINTS, POINTS, -1).mean((1, 3))


def png(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    return np.rint(255 * pixels.reshape(image.size[1], image.size[0], -1)[::-1, :, :3])


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def compare(title, things, shown):
    """Our previews against Blender's of the same view. `one colour`: pixels whose nine points have one colour in Blender's, so that borders of texels do
    not count."""
    for (azimuth, pitch), (path, distance, focal) in zip(VIEWS, shown):
        pinhole = (focal, (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2)
        lit, flat, back = (draw(things, (azimuth, pitch, distance), SIZE, pinhole, what) for what in ("colour", "flat", "back"))
        theirs, ours, back = by_pixel(lit), png(path), by_pixel(back)[..., 0]
        covered = theirs[..., 3]
        off = np.abs(srgb(theirs[..., :3] + 1 - covered[..., None]) - ours).max(-1)
        inside = covered == 1
        points = flat.reshape(SIZE[1], POINTS, SIZE[0], POINTS, 4)
        one = inside & (np.ptp(points, axis=(1, 3)).max(-1) < 1e-3)
        print(f"{title}, {azimuth}°, {pitch}°: IoU {overlap(covered > 0, (ours < 255).any(-1)):.4f}; inside {inside.sum()} pixels, "
              f"{100 * (off[inside] <= 2).mean():.2f} % within 2 of 255, mean difference {off[inside].mean():.2f}; one colour {one.sum()} pixels, "
              f"{100 * (off[one] <= 2).mean():.2f} % within 2; {100 * back[inside].mean():.2f} % seen from behind", flush=True)


def ranks(values):
    return np.argsort(np.argsort(values))


def chroma(rgb):
    linear = np.where(rgb <= 0.04045 * 255, rgb / 255 / 12.92, ((rgb / 255 + 0.055) / 1.055) ** 2.4)
    xyz = linear @ np.array([[0.4124564, 0.2126729, 0.0193339], [0.3575761, 0.7151522, 0.119192], [0.1804375, 0.072175, 0.9503041]])
    f = np.cbrt(xyz / [0.95047, 1, 1.08883])
    return np.hypot(500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2]))


def main():
    program, skyline, camouflage, folder = sys.argv[1:5]
    os.makedirs(folder, exist_ok=True)
    pattern = os.path.join(os.path.dirname(__file__), "..", "print_templates", "random16.png")
    obj, list_of_faces = (os.path.join(camouflage, name) for name in ("model_save.obj", "exterior_face.txt"))
    etron = ["--mesh", obj, "--faces", list_of_faces, "--length-mm", "1000"]
    tiled = ["--mesh", skyline, "--material", "Material.001", "--length-mm", "1000", "--pattern", pattern, "--tile-mm", "500"]

    def show(name, arguments):
        shown = []
        for azimuth, pitch in VIEWS:
            path = os.path.join(folder, f"{name}-{azimuth}.png")
            run = [program, "--quiet", "texture", "show", *arguments, "--azimuth-deg", str(azimuth), "--pitch-deg", str(pitch), "--json"]
            answer = json.loads(subprocess.check_output([*run, "--size-px", f"{SIZE[0]}x{SIZE[1]}", "-o", path]))
            focal_length_px = SIZE[0] / 2 / math.tan(math.radians(answer["field_of_view_deg"]) / 2)
            shown.append((path, answer["distance_mm"] / 1000, focal_length_px))
        return shown

    compare("camouflage", read(obj, False), show("camouflage", [*etron, "--texture", obj]))
    for name, arguments in (("skyline", tiled), ("etron", [*etron, *tiled[6:]])):
        baked = os.path.join(folder, name + ".png")
        subprocess.check_call([program, "--quiet", "texture", "bake", *arguments, "--size", "4096", "-o", baked])
        shown = show(name, arguments)
        compare(name + ", .glb", read(os.path.join(folder, name + ".glb"), True), shown)

    # The picture by the authors' renderer.
    things = read(obj, False)
    azimuth, pitch, distance, *pinhole = AUTHORS
    faces = {int(line) for line in open(list_of_faces, encoding="utf-8").read().split()}
    rest = things[0].data.materials[0].copy()
    things[0].data.materials.append(rest)
    for i, polygon in enumerate(things[0].data.polygons):
        polygon.material_index = int(i not in faces)
    view = (azimuth, pitch, distance / 2)
    rest.name = "rest"
    theirs = png(os.path.join(camouflage, "textur_render.png"))
    paint = by_pixel(draw(things, view, (640, 640), pinhole, "paint"))[..., 0]
    ours = by_pixel(draw(things, view, (640, 640), pinhole, "flat"))

    def blocks(pixels):
        return pixels[256:400, 240:416].reshape(72, 2, 88, 2, -1).mean((1, 3)).reshape(72 * 88, -1)

    is_paint = (blocks(paint[..., None] * (theirs.min(-1) < 250)[..., None]) == 1)[:, 0]
    chromas = [ranks(chroma(blocks(rgb)[is_paint])) for rgb in (srgb(ours[..., :3]), theirs)]
    print(f"Blender against the authors' picture: IoU {overlap(ours[..., 3] > 0.5, theirs.min(-1) < 250):.4f}; "
          f"rank correlation of chroma {np.corrcoef(*chromas)[0, 1]:.3f} in {is_paint.sum()} blocks of the paint")


main()

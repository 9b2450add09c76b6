"""Renders what a plan asks for, with Blender Cycles through the Python package bpy. Started by `scaleproof attack render`.

    python render_frames.py PLAN.json

The plan names the mesh, the paint's triangles with their texture coordinates (made by scaleproof, so that the pattern lies as
its printed panels do), the lights, views and paints, and every picture that is still missing. Everything decided is decided in
the plan; this script only renders. Pictures go to the plan's `raw` folder as little-endian float32 values, row by row from the
top, and one line of standard output announces each when it is whole:

    geometry VIEW
    frame NAME

A sentence that starts with `refused ` says why the script gave up.
"""

import json
import math
import os
import sys

import bpy
import numpy as np
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree

# Millimetres to Blender's units: a 1:10 model gets as many units as the real car has metres.
UNIT = 0.01
# How far a face of the mesh may be from the paint's triangles and still be one of them, in units: 0.01 mm.
SAME = 1e-4


def refuse(sentence):
    print("refused " + sentence, flush=True)
    sys.exit(1)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        plan = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    settings(scene, plan)
    paint = paint_object(plan)
    others = rest(plan, paint)
    ground()
    camera = scene.camera = camera_object(plan)
    outputs = Outputs(scene, plan["raw"])
    lights = {name: Light(light) for name, light in plan["lights"].items()}
    black = bpy.data.worlds.new("black")
    black.use_nodes = True
    black.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    shapes = [view for view in plan["views"] if view["needs_geometry"]]
    scene.world = black
    for view in shapes:
        camera.matrix_world = blender_pose(view["T_model_camera"])
        geometry(scene, plan, view["name"], outputs, is_last=view is shapes[-1])
    beauty(scene, plan)
    for view in plan["views"]:
        camera.matrix_world = blender_pose(view["T_model_camera"])
        scene.world = lights[view["light"]].world
        for frame in view["frames"]:
            dress(paint, others, plan["paints"][frame["paint"]])
            outputs.render({"Image": frame["name"] + ".rgb"})
            print("frame " + frame["name"], flush=True)


def settings(scene, plan):
    """No clamping, no Russian roulette, and no denoiser unless it is asked for: nothing that is not linear in the light."""
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.render.threads_mode = "FIXED" if plan["threads"] else "AUTO"
    scene.render.threads = max(plan["threads"], 1)
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.seed = plan["seed"]
    cycles.use_animated_seed = False
    cycles.use_adaptive_sampling = False
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "FAST"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    cycles.blur_glossy = 0.0
    cycles.max_bounces = cycles.min_light_bounces = plan["bounces"]
    cycles.diffuse_bounces = cycles.glossy_bounces = plan["bounces"]
    cycles.caustics_reflective = cycles.caustics_refractive = False
    # A pixel is the mean over its square.
    cycles.pixel_filter_type = "BOX"
    scene.view_settings.view_transform = "Raw"


def beauty(scene, plan):
    scene.render.use_persistent_data = True
    scene.cycles.use_denoising = plan["denoise"]
    scene.cycles.samples = plan["samples"]
    scene.cycles.filter_width = 1.0
    resolution(scene, plan["width_px"], plan["height_px"])


def geometry(scene, plan, name, outputs, is_last):
    """Coverage at the size of the frames; position and side at the centres of the pixels of a finer picture.

    What Cycles keeps of the last one goes: its random numbers are made for the samples of the first picture, and frames must not depend on
    whether shapes were still missing before them.
    """
    scene.cycles.use_denoising = False
    scene.cycles.samples = 64
    scene.cycles.filter_width = 1.0
    resolution(scene, plan["width_px"], plan["height_px"])
    outputs.render({"object": name + ".object", "paint": name + ".paint"})
    scene.cycles.samples = 1
    scene.cycles.filter_width = 0.01
    scene.render.use_persistent_data = not is_last
    factor = plan["geometry_factor"]
    resolution(scene, factor * plan["width_px"], factor * plan["height_px"])
    outputs.render({"place": name + ".position", "side": name + ".side"})
    print("geometry " + name, flush=True)


def resolution(scene, width, height):
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100


def camera_object(plan):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "HORIZONTAL"
    data.sensor_width = 36.0
    data.lens = plan["focal_length_px"] * 36.0 / plan["width_px"]
    data.clip_start, data.clip_end = 0.01, 1e5
    camera = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(camera)
    return camera


def blender_pose(rows):
    """OpenCV's camera looks along +z with y down, Blender's along -z with y up."""
    pose = Matrix(rows)
    pose.translation *= UNIT
    return pose @ Matrix.Diagonal((1.0, -1.0, -1.0, 1.0))


def paint_object(plan):
    part = plan["paint_surface"]
    mesh = bpy.data.meshes.new("paint")
    points = [[UNIT * c for c in p] for p in part["points_mm"]]
    mesh.from_pydata(points, [], part["triangles"])
    if len(mesh.polygons) != len(part["triangles"]):
        refuse("Blender left triangles of the paint out")
    mesh.attributes.new("side", "FLOAT", "FACE").data.foreach_set("value", [float(s) for s in part["sides"]])
    # Where Blender starts a face's corners need not be where the plan does.
    where = mesh.uv_layers.new(name="pattern").data
    order = np.empty(len(where), dtype=int)
    for i, (polygon, corners) in enumerate(zip(mesh.polygons, part["triangles"])):
        for loop in polygon.loop_indices:
            order[loop] = 3 * i + corners.index(mesh.loops[loop].vertex_index)
    mesh.materials.append(paint_material(plan["roughness"]))
    return Paint(link("paint", mesh), order, part["uv_mm"], plan["levels"])


class Paint:
    """The paint's surface, and what is on it."""

    def __init__(self, thing, order, uv_mm, levels):
        self.thing, self.order, self.uv_mm = thing, order, uv_mm
        self.levels = np.asarray(levels, dtype=np.float32)
        self.tree = thing.data.materials[0].node_tree
        self.pictures = {}

    def place(self, uv):
        """Texture coordinates of each triangle's corners."""
        flat = np.asarray(uv, dtype=np.float32).reshape(-1, 2)[self.order]
        self.thing.data.uv_layers["pattern"].data.foreach_set("uv", flat.ravel())

    def picture(self, path):
        """Rows of an 8-bit image from the top, linear RGB."""
        if path not in self.pictures:
            image = bpy.data.images.load(path)
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size
            pixels = np.empty(width * height * image.channels, dtype=np.float32)
            image.pixels.foreach_get(pixels)
            bpy.data.images.remove(image)
            rows = pixels.reshape(height, width, -1)[::-1, :, :3]
            self.pictures[path] = self.levels[np.rint(255.0 * rows).astype(np.uint8)]
        return self.pictures[path]


def link(name, mesh):
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def paint_material(roughness):
    """A dielectric coat over a diffuse base: linear in the base's colour, up to light between the paint's own parts."""
    material = bpy.data.materials.new("paint")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = nodes["Principled BSDF"]
    surface.inputs["Roughness"].default_value = roughness
    picture = nodes.new("ShaderNodeTexImage")
    picture.name = "pattern"
    picture.interpolation = "Closest"
    picture.extension = "REPEAT"
    uv = nodes.new("ShaderNodeUVMap")
    uv.uv_map = "pattern"
    repeats = nodes.new("ShaderNodeMapping")
    repeats.name = "repeats"
    links.new(uv.outputs["UV"], repeats.inputs["Vector"])
    links.new(repeats.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], surface.inputs["Base Color"])
    aov(material, "object", 1.0)
    aov(material, "paint", 1.0)
    side = nodes.new("ShaderNodeAttribute")
    side.attribute_name = "side"
    links.new(side.outputs["Fac"], aov(material, "side", None).inputs["Value"])
    place = nodes.new("ShaderNodeNewGeometry")
    links.new(place.outputs["Position"], aov(material, "place", None).inputs["Color"])
    return material


def aov(material, name, value):
    node = material.node_tree.nodes.new("ShaderNodeOutputAOV")
    node.aov_name = name
    if value is not None:
        node.inputs["Value"].default_value = value
    return node


def dress(paint, others, colours):
    """A paint, or without colours the file's own materials everywhere."""
    paint.thing.hide_render = colours is None
    for thing, bare, whole in others:
        thing.data = whole if colours is None else bare
    if colours is not None:
        set_paint(paint, colours)


def set_paint(paint, colours):
    """A texture, or rows of cells from the top, linear RGB, and the size of one repeat. A flat colour is a pattern of one cell."""
    texture, tree = colours["texture"], paint.tree
    if texture is None:
        cells, (across, down) = np.asarray(colours["cells"], dtype=np.float32), colours["tile_mm"]
        paint.place(paint.uv_mm)
    else:
        cells, across, down = paint.picture(texture["file"]), 1.0, 1.0
        paint.place(texture["uv"])
    tree.nodes["repeats"].inputs["Scale"].default_value = (1.0 / across, 1.0 / down, 1.0)
    tree.nodes["pattern"].extension = "REPEAT" if texture is None else texture["extension"]
    height, width, _ = cells.shape
    # A new picture each time; one that goes before its successor is there leaves the old colours in Cycles.
    node = tree.nodes["pattern"]
    old = node.image
    node.image = image = bpy.data.images.new("pattern", width, height, alpha=False, float_buffer=True)
    if old is not None:
        bpy.data.images.remove(old)
    image.colorspace_settings.name = "Linear Rec.709"
    pixels = np.ones((height, width, 4), dtype=np.float32)
    pixels[..., :3] = cells[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    # The kept scene of the last frame would keep its colours, too.
    tree.update_tag()
    data = paint.thing.data
    data.materials[0].update_tag()
    data.update_tag()
    paint.thing.update_tag()


def rest(plan, paint):
    """The model as Blender reads the file, with the file's own materials: objects, each with its mesh without the paint and whole."""
    before = set(bpy.data.objects)
    read_mesh(plan["mesh"])
    objects = [o for o in bpy.data.objects if o not in before]
    meshes = [o for o in objects if o.type == "MESH"]
    turn = Matrix(plan["turn_rows"])
    if plan["mesh"].lower().endswith(".glb"):
        # Blender's importer turns glTF's y up into its own z up.
        turn = turn @ Matrix(((1, 0, 0), (0, 0, 1), (0, -1, 0)))
    clouds = []
    for thing in meshes:
        to_model = turn.to_4x4() @ thing.matrix_world
        thing.data = thing.data.copy()
        thing.data.transform(to_model)
        if to_model.determinant() < 0.0:
            thing.data.flip_normals()
        clouds.append(np.array([thing.data.vertices[i].co for p in thing.data.polygons for i in p.vertices]).reshape(-1, 3))
    cloud = np.concatenate(clouds) if clouds else np.zeros((0, 3))
    if not len(cloud):
        refuse("Blender reads no faces from the mesh")
    low, high = (np.array(p) * UNIT for p in plan["bounds_mm"])
    scale = np.max(high - low) / np.max(np.ptp(cloud, axis=0))
    shift = low - scale * cloud.min(axis=0)
    if np.abs(scale * cloud.max(axis=0) + shift - high).max() > 1e-3 * np.max(high - low):
        refuse("Blender reads the mesh with another shape than scaleproof; export it again")
    place = Matrix.Translation(Vector(shift)) @ Matrix.Scale(scale, 4)
    data = paint.thing.data
    surface = BVHTree.FromPolygons([v.co for v in data.vertices], [p.vertices[:] for p in data.polygons])
    parts = []
    for thing in meshes:
        thing.data.transform(place)
        thing.parent = None
        thing.matrix_world = Matrix.Identity(4)
        for slot in thing.data.materials:
            if slot is not None and slot.use_nodes and "object" not in slot:
                slot["object"] = True
                aov(slot, "object", 1.0)
        if not any(thing.data.materials):
            thing.data.materials.clear()
            thing.data.materials.append(plain_material())
        whole = thing.data.copy()
        remove_paint(thing.data, surface)
        parts.append((thing, thing.data, whole))
    for thing in objects:
        if thing.type != "MESH":
            bpy.data.objects.remove(thing)
    return parts


def read_mesh(path):
    kind = os.path.splitext(path)[1].lower()
    readers = {
        ".glb": lambda: bpy.ops.import_scene.gltf(filepath=path),
        ".obj": lambda: bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z"),
        ".stl": lambda: bpy.ops.wm.stl_import(filepath=path, forward_axis="Y", up_axis="Z"),
        ".ply": lambda: bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z"),
    }
    try:
        readers[kind]()
    except RuntimeError as error:
        refuse("Blender cannot read the mesh: " + " ".join(str(error).split()))


def remove_paint(mesh, surface):
    import bmesh

    work = bmesh.new()
    work.from_mesh(mesh)
    work.normal_update()

    def is_paint(face):
        place, normal, _, distance = surface.find_nearest(face.calc_center_median())
        return place is not None and distance < SAME and abs(normal.dot(face.normal)) > 0.999

    bmesh.ops.delete(work, geom=[face for face in work.faces if is_paint(face)], context="FACES")
    work.to_mesh(mesh)
    work.free()


def plain_material():
    material = bpy.data.materials.get("plain") or bpy.data.materials.new("plain")
    if "object" not in material:
        material["object"] = True
        material.use_nodes = True
        aov(material, "object", 1.0)
    return material


def ground():
    """A grey floor, so that the model stands on something and has a shadow."""
    mesh = bpy.data.meshes.new("ground")
    mesh.from_pydata([(-500, -500, 0), (500, -500, 0), (500, 500, 0), (-500, 500, 0)], [], [(0, 1, 2, 3)])
    material = bpy.data.materials.new("ground")
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (0.2, 0.2, 0.2, 1.0)
    surface.inputs["Roughness"].default_value = 1.0
    surface.inputs["Specular IOR Level"].default_value = 0.0
    mesh.materials.append(material)
    link("ground", mesh)


class Light:
    """A panorama at infinity, turned about the vertical, and as bright as makes a white floor under it 0.8."""

    def __init__(self, light):
        path = light["file"]
        if path is None:
            folder = os.path.join(bpy.utils.system_resource("DATAFILES"), "studiolights", "world")
            path = os.path.join(folder, light["name"] + ".exr")
            if not os.path.exists(path):
                known = sorted(os.path.splitext(f)[0] for f in os.listdir(folder) if f.endswith(".exr"))
                refuse(f"Blender has no light '{light['name']}'; it has {', '.join(known)}, or give an .exr or .hdr file")
        try:
            image = bpy.data.images.load(path)
        except RuntimeError:
            refuse(f"Blender cannot read the light {path}; give an .exr or .hdr panorama")
        if not image.size[0] or not image.has_data and not len(image.pixels):
            refuse(f"Blender cannot read the light {path}; give an .exr or .hdr panorama")
        self.world = world = bpy.data.worlds.new(light["name"])
        world.cycles.sampling_method = "MANUAL"
        world.cycles.sample_map_resolution = 1024
        world.use_nodes = True
        nodes, links = world.node_tree.nodes, world.node_tree.links
        panorama = nodes.new("ShaderNodeTexEnvironment")
        panorama.image = image
        turn = nodes.new("ShaderNodeMapping")
        turn.inputs["Rotation"].default_value[2] = math.radians(light["turn_deg"])
        towards = nodes.new("ShaderNodeTexCoord")
        links.new(towards.outputs["Generated"], turn.inputs["Vector"])
        links.new(turn.outputs["Vector"], panorama.inputs["Vector"])
        links.new(panorama.outputs["Color"], nodes["Background"].inputs["Color"])
        nodes["Background"].inputs["Strength"].default_value = 0.8 / floor_brightness(image)


def floor_brightness(image):
    """Radiance of a white diffuse floor under the panorama: the mean over the upper half, weighted by the cosine."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    # Row 0 is the bottom of the picture: straight down.
    rows = pixels.reshape(height, width, image.channels)[..., :3].astype(float).mean(axis=(1, 2))
    elevation = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2
    weight = np.where(elevation > 0.0, np.sin(elevation) * np.cos(elevation), 0.0)
    brightness = float((rows * weight).sum() / weight.sum())
    if not math.isfinite(brightness) or brightness <= 0.0:
        refuse("the light is black from above, so the model would be, too")
    return brightness


class Outputs:
    """Renders, and takes the passes out as float32 files. Blender's own pictures of passes are only to be had as files."""

    def __init__(self, scene, folder):
        self.folder = folder
        layer = scene.view_layers[0]
        for name, kind in (("object", "VALUE"), ("paint", "VALUE"), ("side", "VALUE"), ("place", "COLOR")):
            entry = layer.aovs.add()
            entry.name, entry.type = name, kind
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        self.layers = tree.nodes.new("CompositorNodeRLayers")
        self.files = tree.nodes.new("CompositorNodeOutputFile")
        self.files.base_path = folder
        self.files.format.file_format = "OPEN_EXR"
        self.files.format.color_depth = "32"
        self.files.format.color_mode = "RGB"
        self.files.format.exr_codec = "NONE"
        self.tree = tree

    def render(self, wanted):
        self.files.file_slots.clear()
        for socket, name in wanted.items():
            self.files.file_slots.new(name + "_")
            self.tree.links.new(self.layers.outputs[socket], self.files.inputs[-1])
        bpy.ops.render.render()
        for name in wanted.values():
            self.take(name)

    def take(self, name):
        exr = os.path.join(self.folder, name + "_0001.exr")
        image = bpy.data.images.load(exr)
        width, height = image.size
        pixels = np.empty(width * height * image.channels, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        planes = pixels.reshape(height, width, image.channels)[::-1, :, :3]
        if name.endswith(".position"):
            planes = planes / np.float32(UNIT)
        if not name.endswith((".rgb", ".position")):
            planes = planes[..., :1]
        bpy.data.images.remove(image)
        os.remove(exr)
        path = os.path.join(self.folder, name + ".f32")
        with open(path + ".partial", "wb") as file:
            file.write(np.ascontiguousarray(planes, dtype="<f4").tobytes())
        os.replace(path + ".partial", path)


if __name__ == "__main__":
    main()

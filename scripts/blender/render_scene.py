# SPDX-License-Identifier: MIT
"""Renders a scene of `glint-bench dataset make ... --write-scene DIR` with Blender's Cycles, into a scene folder.

    blender -b --factory-startup -noaudio --python-exit-code 1 --python scripts/blender/render_scene.py -- \\
        SCENE --out FOLDER [--spp 256] [--views 0000,0008] [--threads 2]

FOLDER gets images/, intri.yml, extri.yml, scene.json and gt/{rgb,depth,normal,glass,behind_depth,behind_normal}, as our
path tracer writes them (docs/reference/datasets.md). A view that is there already is not rendered again. Blender 3.3 and later of
3.x and 4.x; tried with 3.4.1. No add-on and no NumPy is needed.
"""
import argparse
import array
import json
import pathlib
import sys
import tempfile

import bpy
import mathutils

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import materials  # noqa: E402
import scene_files  # noqa: E402

FORMAT, VERSION = "glint exchange scene", 1
BOUNCES = 200
FAR = 1e9  # Cycles has 1e10 m where a ray leaves the scene


def fail(message):
    sys.exit(f"render_scene.py: {message}")


def read_scene(folder):
    path = folder / "exchange.json"
    try:
        scene = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        fail(f"{path}: {error}; write it with glint-bench dataset make ... --write-scene")
    if not isinstance(scene, dict) or (scene.get("format"), scene.get("version")) != (FORMAT, VERSION):
        fail(f"{path}: expected format '{FORMAT}', version {VERSION}; write it again")
    for name in [scene["meshes"]] + [m["texture"] for m in scene["materials"] if "texture" in m]:
        file = (folder / name).resolve()
        if folder.resolve() not in file.parents or not file.is_file():
            fail(f"{path}: '{name}' is no file in {folder}")
    return scene


def chosen_views(scene, names):
    if not names:
        return scene["views"]
    known = {view["name"]: view for view in scene["views"]}
    for name in names.split(","):
        if name not in known:
            fail(f"--views: no view is called {name}; there are {', '.join(known)}")
    return [known[name] for name in names.split(",")]


def load_meshes(file):
    bpy.ops.wm.obj_import(filepath=str(file), forward_axis="Y", up_axis="Z", validate_meshes=False)
    for item in bpy.data.objects:
        # Blender moves the start of shadow rays off coarse smooth meshes; our path tracer does not.
        for owner in (item, item.cycles):
            if hasattr(owner, "shadow_terminator_geometry_offset"):
                owner.shadow_terminator_geometry_offset = 0


def glass_objects(scene):
    ids = {m["id"] for m in scene["materials"] if m["kind"] == "thin dielectric"}
    return [item for item in bpy.data.objects if item.type == "MESH" and item.data.materials[0].name in ids]


def set_world(radiance):
    world = bpy.context.scene.world = bpy.data.worlds.new("environment")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*radiance, 1)
    background.inputs["Strength"].default_value = 1


def set_camera(view):
    """The camera looks along its -z, with y up; a principal point off the middle is a shift in widths."""
    if abs(view["fx"] - view["fy"]) > 1e-6 * view["fx"]:
        fail(f"view {view['name']}: fx {view['fx']} and fy {view['fy']} differ; pixels must be squares")
    scene = bpy.context.scene
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(scene.camera)
    width, height, lens = view["width"], view["height"], scene.camera.data
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    lens.sensor_fit = "HORIZONTAL"
    lens.lens = view["fx"] * lens.sensor_width / width
    lens.shift_x, lens.shift_y = (0.5 * width - view["cx"]) / width, (view["cy"] - 0.5 * height) / width
    lens.clip_start, lens.clip_end = 1e-3, 1e4
    world_from_cam = mathutils.Matrix(view["rotation_cam_from_world"]).transposed()
    center = world_from_cam @ -mathutils.Vector(view["translation_cam_from_world"])
    pose = (world_from_cam @ mathutils.Matrix.Diagonal((1, -1, -1))).to_4x4()
    pose.translation = center
    scene.camera.matrix_world = pose


def set_cycles(threads):
    """An unbiased picture: every path up to BOUNCES, nothing clamped, smoothed, skipped or mapped to other tones."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    for name in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, f"{name}_bounces", BOUNCES)
    cycles.transparent_max_bounces = 1024
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    for name in ("sample_clamp_direct", "sample_clamp_indirect", "blur_glossy", "light_sampling_threshold"):
        setattr(cycles, name, 0)
    scene.view_settings.view_transform = "Standard"
    scene.render.use_persistent_data = True
    if threads:
        scene.render.threads_mode, scene.render.threads = "FIXED", threads
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_normal = layer.use_pass_material_index = True
    layer.pass_alpha_threshold = 0  # panes are surfaces


def connect_outputs(folder):
    """Every render leaves its passes as folder/PASS0001.exr, float32."""
    scene = bpy.context.scene
    scene.use_nodes = True
    scene.frame_current = 1
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    nodes.clear()
    layers, output = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeOutputFile")
    output.base_path = str(folder)
    output.format.file_format = "OPEN_EXR"
    output.format.color_mode, output.format.color_depth = "RGB", "32"
    output.file_slots.clear()
    for name, source in (("rgb", "Image"), ("depth", "Depth"), ("normal", "Normal"), ("index", "IndexMA")):
        output.file_slots.new(name)
        links.new(layers.outputs[source], output.inputs[name])


def read_pass(file, channels):
    """Values in rows from the top, `channels` of each pixel."""
    image = bpy.data.images.load(str(file))
    image.colorspace_settings.name = "Non-Color"
    width, height, stored = *image.size, image.channels
    values = array.array("f", bytes(4 * width * height * stored))
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    planes = [values[c::stored] for c in range(channels)]
    rows = array.array("f")
    for y in reversed(range(height)):
        row = array.array("f", bytes(4 * width * channels))
        for c, plane in enumerate(planes):
            row[c::channels] = plane[y * width:(y + 1) * width]
        rows.extend(row)
    return rows


def render(folder, spp, seed, centred=False):
    """`centred`: rays through the pixels' centres, for depth and normals; otherwise over the whole pixels, evenly."""
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed = spp, seed
    scene.cycles.pixel_filter_type = "GAUSSIAN" if centred else "BOX"
    scene.cycles.filter_width = 0.01
    bpy.ops.render.render()
    return {name: read_pass(folder / f"{name}0001.exr", channels)
            for name, channels in (("rgb", 3), ("depth", 1), ("normal", 3), ("index", 1))}


def geometry(passes, view):
    """Planar depth, 0: nothing; unit normals in camera space, OpenCV axes."""
    depth = array.array("f", (z if z < FAR else 0 for z in passes["depth"]))
    rotation, normals = mathutils.Matrix(view["rotation_cam_from_world"]), array.array("f")
    world = passes["normal"]
    for i in range(0, len(world), 3):
        normal = rotation @ mathutils.Vector(world[i:i + 3])
        normals.extend(normal.normalized() if depth[i // 3] > 0 else (0, 0, 0))
    return depth, normals


def render_view(view, out, work, options, exposure, panes):
    set_camera(view)
    name, size = view["name"], (view["width"], view["height"])
    seed = int(name) if name.isdigit() else 0
    for layer, shown in (("behind_", False), ("", True)):
        for pane in panes:
            pane.visible_camera = shown
        passes = render(work, 1, seed, centred=True)
        depth, normal = geometry(passes, view)
        scene_files.write_exr(out / "gt" / f"{layer}depth" / f"{name}.exr", size, "Z", depth)
        scene_files.write_exr(out / "gt" / f"{layer}normal" / f"{name}.exr", size, "XYZ", normal)
    glass = bytes(255 if index > 0.5 else 0 for index in passes["index"])
    scene_files.write_png(out / "gt" / "glass" / f"{name}.png", size, 1, glass)
    radiance = array.array("f", (exposure * value for value in render(work, options.spp, seed)["rgb"]))
    scene_files.write_exr(out / "gt" / "rgb" / f"{name}.exr", size, "RGB", radiance)
    picture = bytes(map(scene_files.srgb_byte, radiance))
    scene_files.write_png(out / "images" / name / "000000.png", size, 3, picture)


def begin_folder(out, scene, views, spp):
    """cameras and scene.json; a folder that another call began goes on where that ended."""
    description = {
        "name": scene["name"],
        "dataset": "exchange-cycles",
        "origin": scene["origin"],
        "exposure": scene["exposure"],
        "image_encoding": "sRGB(clamp(gt/rgb)); gt radiance = scene radiance * exposure",
        "renderer": f"Blender {bpy.app.version_string}, Cycles, {spp} samples a pixel, {BOUNCES} bounces",
        "views": [view["name"] for view in views],
        "test_views": [view["name"] for view in views if view["test"]],
    }
    path = out / "scene.json"
    if path.is_file():
        if json.loads(path.read_text()) != description:
            fail(f"{out}: holds another rendering; choose another folder")
    elif out.exists() and any(out.iterdir()):
        fail(f"{out}: is there already and is no rendering of this script; choose another folder")
    scene_files.write_cameras(out, views)
    scene_files.write_file(path, (json.dumps(description, indent=1) + "\n").encode())


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="render_scene.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", type=pathlib.Path, help="folder with exchange.json")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="scene folder that is written")
    parser.add_argument("--spp", type=int, default=256, help="samples a pixel")
    parser.add_argument("--views", default="", help="names, with commas between; all")
    parser.add_argument("--threads", type=int, default=0, help="0: all cores")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else ["--help"])


def main():
    options = parse_arguments()
    scene = read_scene(options.scene)
    views = chosen_views(scene, options.views)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    load_meshes(options.scene / scene["meshes"])
    for material in scene["materials"]:
        materials.build(material, options.scene)
    set_world(scene["environment"])
    set_cycles(options.threads)
    begin_folder(options.out, scene, views, options.spp)
    with tempfile.TemporaryDirectory(prefix="glint_cycles") as work:
        connect_outputs(work)
        for view in views:
            if (options.out / "images" / view["name"] / "000000.png").is_file():
                continue
            render_view(view, options.out, pathlib.Path(work), options, scene["exposure"], glass_objects(scene))
            print(f"{options.out}: view {view['name']} rendered", flush=True)


if __name__ == "__main__":
    main()

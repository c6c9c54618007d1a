# Runs inside Blender (tests/bench/cycles starts it): SHOT BUILD WORK. Gives Cycles the mesh, albedo, lamps, surroundings and camera of a shot, renders
# at rising sample counts, and holds each picture's error and time beside those of relamp.
import json
import os
import resource
import shutil
import subprocess
import sys
import time

import bpy
import numpy as np
from mathutils import Matrix

shot, build, work = sys.argv[sys.argv.index("--") + 1:]
WIDTH, HEIGHT = 320, 240
REFERENCE_SAMPLES = 1024


def read_ply(path):
    """Header bytes, vertex array and triangles of a binary PLY as relamp writes it."""
    kinds = {"float": "<f4", "int": "<i4", "uchar": "u1"}
    with open(path, "rb") as f:
        header, fields, counts = b"", [], {}
        while not header.endswith(b"end_header\n"):
            line = f.readline()
            header += line
            word = line.decode().split()
            if word[0] == "element":
                counts[word[1]] = int(word[2])
            if word[0] == "property" and word[1] != "list":
                fields.append((word[2], kinds[word[1]]))
        vertices = np.frombuffer(f.read(counts["vertex"] * np.dtype(fields).itemsize), np.dtype(fields)).copy()
        faces = np.frombuffer(f.read(), np.dtype([("n", "u1"), ("v", "<u4", 3)]))["v"]
    return header, vertices, faces


def read_exr(path):
    """Rows from the top, as floats."""
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Raw"
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(image.size[1], image.size[0], 4)[::-1].astype(np.float64)
    bpy.data.images.remove(image)
    return pixels


def seconds_of(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


# The shot with its glossy lobes taken away, so that both see the same matte surfaces.
matte = os.path.join(work, "matte.relamp")
shutil.copytree(shot, matte)
header, vertices, faces = read_ply(os.path.join(matte, "reflectance.ply"))
for name in vertices.dtype.names:
    if name.startswith("weight_") and not name.startswith("weight_0_"):
        vertices[name] = 0
with open(os.path.join(matte, "reflectance.ply"), "rb") as f:
    tail = f.read()[len(header) + vertices.nbytes:]
with open(os.path.join(matte, "reflectance.ply"), "wb") as f:
    f.write(header + vertices.tobytes() + tail)
document = json.load(open(os.path.join(matte, "shot.json")))
capture = document["capture"] if isinstance(document["capture"], str) else document["capture"]["folder"]
capture = os.path.normpath(os.path.join(shot, capture))
document["capture"] = capture if isinstance(document["capture"], str) else {**document["capture"], "folder": capture}
json.dump(document, open(os.path.join(matte, "shot.json"), "w"))
poses = json.load(open(os.path.join(capture, "transforms.json")))

# The scene.
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
mesh = bpy.data.meshes.new("capture")
positions = np.stack([vertices[k] for k in "xyz"], 1)
mesh.from_pydata(positions.tolist(), [], faces.tolist())
albedo = mesh.attributes.new("albedo", "FLOAT_COLOR", "POINT")
rgb = np.stack([vertices["albedo_" + k] for k in "rgb"] + [np.ones(len(vertices), np.float32)], 1)
albedo.data.foreach_set("color", rgb.astype(np.float32).ravel())
mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
mesh.use_auto_smooth = True
mesh.normals_split_custom_set_from_vertices(np.stack([vertices["n" + k] for k in "xyz"], 1).tolist())


def material(name):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    m.node_tree.nodes.clear()
    mesh.materials.append(m)
    nodes = m.node_tree.nodes
    return nodes, m.node_tree.links, nodes.new("ShaderNodeOutputMaterial")


nodes, links, output = material("matte")
diffuse, attribute = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeAttribute")
attribute.attribute_name = "albedo"
links.new(attribute.outputs["Color"], diffuse.inputs["Color"])
links.new(diffuse.outputs[0], output.inputs[0])
lamps = json.loads(subprocess.run([f"{build}/relamp", "info", matte, "--json"], check=True, capture_output=True).stdout)["emitters"]
for lamp in lamps:
    nodes, links, output = material(lamp["id"])
    shine = nodes.new("ShaderNodeEmission")
    shine.inputs["Color"].default_value = [*lamp["radiance"], 1]
    links.new(shine.outputs[0], output.inputs[0])
emitter = vertices["emitter"][faces]
own = np.where((emitter[:, 0] == emitter[:, 1]) & (emitter[:, 0] == emitter[:, 2]), emitter[:, 0], -1)
mesh.polygons.foreach_set("material_index", (own + 1).astype(np.int32))
mesh.update()
scene.collection.objects.link(bpy.data.objects.new("capture", mesh))

world = scene.world = bpy.data.worlds.new("surroundings")
world.use_nodes = True
sky = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
sky.image = bpy.data.images.load(os.path.join(matte, "environment.exr"))
sky.image.colorspace_settings.name = "Raw"
world.node_tree.links.new(sky.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])

lens = bpy.data.cameras.new("view 0")
lens.sensor_width = 36
lens.lens = 36 * poses["fl_x"] / poses["w"]
lens.clip_start = 1e-3
eye = bpy.data.objects.new("view 0", lens)
eye.matrix_world = Matrix(poses["frames"][0]["transform_matrix"])
scene.collection.objects.link(eye)
scene.camera = eye

scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
scene.cycles.max_bounces = scene.cycles.diffuse_bounces = scene.cycles.glossy_bounces = scene.cycles.transmission_bounces = 0
scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
scene.cycles.sample_clamp_direct = 0
scene.cycles.light_sampling_threshold = 0
scene.cycles.pixel_filter_type = "BOX"
scene.cycles.filter_width = 1
scene.render.film_transparent = True
scene.render.use_persistent_data = True  # geometry stays loaded: what is timed is light
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.image_settings.color_mode = "RGBA"
scene.view_settings.view_transform = "Standard"


def cycles(samples, seed):
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.render.filepath = os.path.join(work, f"cycles-{samples}.exr")
    start, before = time.monotonic(), seconds_of(resource.RUSAGE_SELF)
    bpy.ops.render.render(write_still=True)
    wall, processor = time.monotonic() - start, seconds_of(resource.RUSAGE_SELF) - before
    return read_exr(scene.render.filepath), wall, processor / os.cpu_count()


def relamp(samples, seed, size=(WIDTH, HEIGHT)):
    out = os.path.join(work, f"relamp-{samples}.exr")
    start, before = time.monotonic(), seconds_of(resource.RUSAGE_CHILDREN)
    subprocess.run([f"{build}/relamp", "--quiet", "render", matte, "-o", out, "--size", f"{size[0]}x{size[1]}", "--samples", str(samples), "--seed", str(seed)], check=True)
    wall, processor = time.monotonic() - start, seconds_of(resource.RUSAGE_CHILDREN) - before
    return read_exr(out), wall, processor / os.cpu_count()


cycles(1, 0)  # loads the scene
reference, wall, _ = cycles(REFERENCE_SAMPLES, 1)
# Surfaces a display can show: the lamps and the shade right beside them, hundreds of times brighter, would be all there is to the error.
inside = (reference[..., 3] > 0.999) & (reference[..., :3].max(-1) < 1)


def error(picture, truth):
    difference = (picture - truth)[..., :3][inside]
    return 100 * float(np.sqrt((difference**2).mean() / (truth[..., :3][inside] ** 2).mean()))


def told(name, picture, wall, processor):
    """A row of the table, with the processor seconds a core in which Cycles comes to the same noise: between its sample counts, and beyond the last
    as the square of the noise."""
    noise = np.log(error(picture, own_reference))
    last_noise, last_time = steps[-1]
    log_time = last_time + 2 * (last_noise - noise) if noise < last_noise else np.interp(-noise, [-e for e, _ in steps], [t for _, t in steps])
    same = float(np.exp(log_time))
    print(f"| {name} | {error(picture, own_reference):.2f} | {error(picture, reference):.2f} | {wall:.3f} | {processor:.3f} | {same:.2f}, {same / processor:.0f} times |")


own_reference, _, _ = relamp(256, 7)
print(f"| {WIDTH} x {HEIGHT}, {inside.sum()} pixels of matte surface | noise, % | against the other's reference, % | seconds | processor, seconds a core | Cycles to the same noise |")
print("| --- | --- | --- | --- | --- | --- |")
print(f"| Cycles, {REFERENCE_SAMPLES} samples: its reference | | {error(reference, own_reference):.2f} | {wall:.1f} | | |")
steps = []
for samples in [1, 2, 4, 8, 16, 32, 64, 128]:
    picture, wall, processor = cycles(samples, 100 + samples)
    steps.append((np.log(error(picture, reference)), np.log(processor)))
    print(f"| Cycles, {samples} samples | {error(picture, reference):.2f} | {error(picture, own_reference):.2f} | {wall:.2f} | {processor:.2f} | |")
_, idle, idle_processor = relamp(1, 1, (8, 6))
print(f"| relamp render, opening the shot alone | | | {idle:.2f} | {idle_processor:.2f} | |")
for samples in [1, 2, 4, 8]:
    picture, wall, processor = relamp(samples, 1)
    told(f"relamp render, {samples} samples a pixel, without opening", picture, wall - idle, processor - idle_processor)
live = subprocess.run([f"{build}/tests/bench/live_bench", matte, os.path.join(work, "live.exr")], check=True, capture_output=True, text=True).stdout
for name, line, file in [("live view, first picture of a drag", "drag, first image", "live.exr"), ("live view at rest, what follows", "refined at rest", "live-refined.exr")]:
    words = [found for found in live.splitlines() if found.startswith(line)][0].split()
    told(name, read_exr(os.path.join(work, file)), float(words[words.index("ms") - 1]) / 1e3, float(words[words.index("processor") - 2]) / 1e3)

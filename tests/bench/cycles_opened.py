#!/usr/bin/env python3
"""A shot's exported scene in Blender's Cycles: cycles_opened.py SHOT BUILD [--camera N] [--width 320] [--only NAME]

`relamp export` writes the scene. Blender opens its glTF as any program would: the add-on reads surfaces, texture and
lights, and the environment is given to the world. Or it runs scene.py, which has lobes and texture as floats. `relamp
render` and Cycles make the same picture, in direct light, each twice with half the samples and another seed. Where
surfaces are seen and no lamps: the light over Cycles', and the root mean square of how far blocks of 4 x 4 pixels are
off over their mean; beside it the part that is the noise of both, from the two halves, and what is left without it.
Surfaces are made matte but for the row "as it is". Needs blender, python3-numpy and python3-openimageio.
"""
import argparse
import json
import os
import shutil
import tempfile

import numpy as np
import OpenImageIO as oiio

from cycles_shaped import matte_copy, run

OPENED = """import bpy, json, numpy, os
from mathutils import Matrix
bpy.ops.wm.read_factory_settings(use_empty=True)
numpy.bool = bool  # the add-on of Blender 3.4 needs it, which NumPy 1.24 has no longer
bpy.ops.import_scene.gltf(filepath=os.path.join(folder, "lights.gltf"))
scene = bpy.context.scene
poses = json.load(open(os.path.join(folder, "transforms.json")))
frame = {**poses, **poses["frames"][camera]}
lens = bpy.data.cameras.new("view")
lens.sensor_fit, lens.sensor_width, lens.lens, lens.clip_start = "HORIZONTAL", 36, 36 * frame["fl_x"] / frame["w"], 1e-3
lens.shift_x, lens.shift_y = 0.5 - frame["cx"] / frame["w"], (frame["cy"] - frame["h"] / 2) / frame["w"]
scene.camera = bpy.data.objects.new("view", lens)
scene.camera.matrix_world = Matrix(frame["transform_matrix"])
scene.collection.objects.link(scene.camera)
scene.world = bpy.data.worlds.new("surroundings")
scene.world.use_nodes = True
sky = scene.world.node_tree.nodes.new("ShaderNodeTexEnvironment")
sky.image = bpy.data.images.load(os.path.join(folder, "environment.exr"))
sky.image.colorspace_settings.name = "Raw"
scene.world.node_tree.links.new(sky.outputs["Color"], scene.world.node_tree.nodes["Background"].inputs["Color"])
"""

REBUILT = """import bpy, os, runpy
sys.argv[sys.argv.index("--") + 1:] = []
runpy.run_path(os.path.join(folder, "scene.py"))
scene = bpy.context.scene
scene.camera = [o for o in scene.objects if o.type == "CAMERA"][camera]
"""

BEGIN = """import sys
folder, camera, width, height, samples, out = sys.argv[-6:]
camera = int(camera)
"""

RENDERED = """scene.render.engine = "CYCLES"
cycles, render = scene.cycles, scene.render
cycles.samples = int(samples)
cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 0
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.sample_clamp_direct = cycles.light_sampling_threshold = 0
cycles.pixel_filter_type = "BOX"
render.resolution_x, render.resolution_y, render.resolution_percentage = int(width), int(height), 100
render.film_transparent = True
render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
render.image_settings.color_mode = "RGBA"
scene.view_settings.view_transform = "Standard"
for seed in (1, 2):
    cycles.seed, render.filepath = seed, out + str(seed) + ".exr"
    bpy.ops.render.render(write_still=True)
"""


def read(file):
    return oiio.ImageBuf(file).get_pixels(oiio.FLOAT).astype(np.float64)


def row(name, ours, theirs):
    """Each a pair of pictures with noise of their own."""
    alpha, picture = theirs[0][..., 3], sum(theirs)[..., :3] / 2
    lit = (alpha > 0.999) & (picture.min(-1) > 0)
    lit &= picture.max(-1) < 4 * np.quantile(picture[lit].max(-1), 0.99)

    def block(a):
        h, w = a.shape[0] // 4 * 4, a.shape[1] // 4 * 4
        return a[:h, :w].reshape(h // 4, 4, w // 4, 4, -1).mean((1, 3))

    whole = block(lit[..., None].astype(float))[..., 0] == 1
    a, b = [[block(p[..., :3])[whole] for p in pair] for pair in (ours, theirs)]
    mean = sum(b).mean() / 2
    off = np.sqrt(((sum(a) - sum(b)) ** 2).mean()) / 2 / mean
    noise = [np.sqrt(((p[0] - p[1]) ** 2).mean()) / 2 / mean for p in (a, b)]
    left = np.sqrt(max(0, off ** 2 - noise[0] ** 2 - noise[1] ** 2))
    light = sum(a).sum(0) / sum(b).sum(0)
    print("| %s | %.4f %.4f %.4f | %.2f %% | %.2f, %.2f %% | %.2f %% |" % (
        (name,) + tuple(light) + (100 * off, 100 * noise[0], 100 * noise[1], 100 * left)), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shot")
    parser.add_argument("build")
    parser.add_argument("--camera", type=int, default=0)
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--samples", type=int, default=64, help="of relamp; Cycles takes 16 times as many")
    parser.add_argument("--only", action="append")
    given = parser.parse_args()
    relamp = given.build + "/relamp" if os.path.isdir(given.build) else given.build
    work = tempfile.mkdtemp()
    matte = work + "/matte.relamp"
    matte_copy(given.shot, matte)
    print("| scene | light over Cycles' | blocks | noise of ours, theirs | without |\n|---|---|---|---|---|")
    for name, shot, script in [("as it is, glTF", given.shot, OPENED), ("matte, glTF", matte, OPENED),
                               ("matte, scene.py", matte, REBUILT)]:
        if given.only and name not in given.only:
            continue
        scene = tempfile.mkdtemp(dir=work) + "/scene"
        run(relamp, "--quiet", "export", shot, "-o", scene)
        poses = json.load(open(scene + "/transforms.json"))
        frame = {**poses, **poses["frames"][given.camera]}
        size = str(given.width), str(round(given.width * frame["h"] / frame["w"]))
        for seed in ("1", "2"):
            run(relamp, "--quiet", "render", shot, "-o", work + "/ours%s.exr" % seed, "--camera", str(given.camera),
                "--samples", str(given.samples // 2), "--denoise", "off", "--size", "x".join(size), "--seed", seed)
        with open(work + "/script.py", "w") as file:
            file.write(BEGIN + script + RENDERED)
        run("blender", "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python",
            work + "/script.py", "--", scene, str(given.camera), *size, str(8 * given.samples), work + "/theirs")
        row(name, *[[read(work + "/%s%s.exr" % (who, seed)) for seed in (1, 2)] for who in ("ours", "theirs")])
    shutil.rmtree(work)


if __name__ == "__main__":
    main()

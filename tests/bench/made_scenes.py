"""Renders a capture with truth, as the shared scenes are, of a scene that nothing was tuned to. Inside Blender:

    blender -b -P tests/bench/made_scenes.py -- DATA OUT still-life|kitchen|loft|table:SEED|room:SEED

The last two are drawn at random (made_at_random.py). DATA holds hdri/*.hdr and meshes/*. Cycles renders each light alone and adds them up. 5 to 25 minutes on two cores.
"""
import json
import math
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import made_at_random  # noqa: E402
import made_shapes as shapes  # noqa: E402
from made_render import Renderer, camera_at, write_ply  # noqa: E402


class Made:
    """Objects, cameras and edits of one scene."""

    def __init__(self, data, seed):
        self.data, self.rng = data, np.random.default_rng(seed)
        self.objects, self.edits, self.cameras = [], [], []

    def add(self, name, mesh, albedo, roughness=1.0, radiance=None):
        """A roughness below 1: glazed. `radiance`: an emitter."""
        v = np.asarray(mesh[0], float)
        a = albedo(v) if callable(albedo) else np.broadcast_to(np.asarray(albedo, float), v.shape).copy()
        self.objects.append({"name": name, "vertices": v, "triangles": np.asarray(mesh[1], int), "albedo": a,
                             "roughness": roughness, "radiance": radiance})

    def light(self, name, mesh, radiance):
        self.add(name, mesh, (0, 0, 0), radiance=radiance)

    def read(self, file, height, at, turn=0):
        return shapes.read(f"{self.data}/meshes/{file}", height, at, turn)

    def spots(self, a, b, size):
        return shapes.spots(a, b, size, self.rng)

    def arc(self, target, count, middle, spread, distance, height, shake):
        """Cameras on an arc about a target; distance and height are (mean, half range)."""
        for i in range(count):
            a = math.radians(middle + (i / (count - 1) - 0.5) * spread)
            r = distance[0] + distance[1] * self.rng.uniform(-1, 1)
            z = height[0] + height[1] * self.rng.uniform(-1, 1)
            eye = np.array((target[0] + r * math.cos(a), target[1] + r * math.sin(a), z))
            self.cameras.append((eye, np.asarray(target) + self.rng.normal(size=3) * shake))

    def edit(self, name, light, move=None, power=(1, 1, 1)):
        self.edits.append((name, light, move, power))


def still_life(data):
    s = Made(data, 6)
    s.bounces, s.environment, s.others, s.fov = 0, ("polyhaven_studio.hdr", 0.45), ("polyhaven_city.hdr", 0.3), 50
    top = shapes.lathe([(max(r, 1e-3), 0) for r in np.linspace(0.66, 0, 60)], 260)
    edge = shapes.lathe([(0.66, -0.0001 - 0.05 * t) for t in np.linspace(1, 0, 6)], 260)
    s.add("table", shapes.join([top, edge]), s.spots((0.55, 0.42, 0.3), (0.44, 0.33, 0.24), 0.08))
    s.add("figure", s.read("fertility.off", 0.34, (-0.12, 0.12, 0.001), 30), (0.62, 0.6, 0.58))
    s.add("bust", s.read("max-planck-decimated.obj", 0.3, (0.25, 0.18, 0.001), -20), (0.3, 0.42, 0.62), 0.35)
    ball = shapes.sphere((0.08, -0.22, 0.09), 0.088, 90)
    s.add("ball", ball, s.spots((0.75, 0.2, 0.15), (0.8, 0.75, 0.7), 0.06))
    s.add("block", shapes.box((-0.42, -0.28, 0.001), (-0.22, -0.1, 0.12), 0.008), (0.2, 0.5, 0.28))
    s.add("stick", shapes.cylinder(0.012, 0.001, 0.178, 20, 16, (0.42, -0.2, 0)), (0.75, 0.72, 0.6))
    v, f = shapes.box((-0.02, -0.2, 0), (0.02, 0.2, 0.3), 0.02)
    s.light("softbox", (shapes.turned(v, 25) + np.array((-0.62, -0.28, 0.15)), f), (9, 8.2, 7))
    s.light("candle", shapes.sphere((0.42, -0.2, 0.2), 0.022, 24), (110, 52, 14))
    s.arc((0, 0, 0.12), 10, -90, 230, (1.25, 0.2), (0.67, 0.3), 0.02)
    s.main, s.novel = 4, (np.array((0.5, -1.2, 0.65)), np.array((0, 0, 0.12)))
    s.edit("softbox-off", "softbox", power=(0, 0, 0))
    s.edit("candle-off", "candle", power=(0, 0, 0))
    s.edit("candle-moved", "candle", move=(-0.5, -0.12, 0.12))
    s.edit("softbox-recoloured", "softbox", power=(0.3, 0.8, 1.6))
    return s


def kitchen(data):
    s = Made(data, 7)
    s.bounces, s.environment, s.others, s.fov = 4, ("polyhaven_city.hdr", 0.12), ("polyhaven_studio.hdr", 0.5), 58
    counter = shapes.box((-1.2, -0.05, 0), (1.2, 0.6, 0.12), 0.022)
    s.add("counter", counter, shapes.bands((0.62, 0.55, 0.45), (0.55, 0.48, 0.39), 0, 0.2))
    tiles = shapes.checks((0.78, 0.78, 0.74), (0.45, 0.6, 0.68), (0, 2), 0.15)
    s.add("tiles", shapes.grid((-1.2, 0.6, 0.12), (2.4, 0, 0), (0, 0, 1), 110, 50), tiles)
    s.add("cupboard", shapes.box((-1.2, 0.28, 0.72), (0.1, 0.6, 1.1), 0.025), (0.35, 0.38, 0.3))
    s.add("teapot", s.read("teapot.obj", 0.2, (-0.75, 0.25, 0.121), 20), (0.55, 0.25, 0.12), 0.25)
    cow = s.read("spot.obj", 0.26, (0.55, 0.2, 0.121), 200)
    s.add("cow", cow, s.spots((0.2, 0.18, 0.16), (0.8, 0.78, 0.75), 0.05))
    s.add("bunny", s.read("stanford-bunny.obj", 0.22, (-0.2, 0.18, 0.121)), (0.72, 0.68, 0.62))
    bottle = [(0.055, 0.002), (0.055, 0.1), (0.05, 0.15), (0.02, 0.2), (0.02, 0.278), (0.001, 0.28)]
    s.add("bottle", shapes.lathe(bottle, 60, (0.2, 0.38, 0.121)), (0.15, 0.4, 0.2))
    foot = [(0.06, 0.1205), (0.06, 0.125), (0.02, 0.14), (0.02, 0.25), (0.001, 0.25)]
    s.add("foot", shapes.lathe(foot, 40, (0.9, 0.36, 0)), (0.2, 0.2, 0.22))
    s.light("strip", shapes.box((-1, 0.4, 0.7), (-0.2, 0.44, 0.712), 0.02), (13, 12, 10.5))
    s.light("globe", shapes.sphere((0.9, 0.36, 0.34), 0.09, 48), (6, 3.6, 1.6))
    s.arc((0, 0.25, 0.3), 11, -90, 110, (1.75, 0.3), (0.75, 0.35), 0.05)
    s.main, s.novel = 5, (np.array((-0.6, -1.5, 0.8)), np.array((0, 0.25, 0.3)))
    s.edit("strip-off", "strip", power=(0, 0, 0))
    s.edit("strip-warm", "strip", power=(1.3, 0.9, 0.4))
    s.edit("globe-moved", "globe", move=(-0.85, -0.32, -0.1))
    s.edit("globe-off", "globe", power=(0, 0, 0))
    return s


def loft(data):
    s = Made(data, 5)
    s.bounces, s.environment, s.others, s.fov = 4, ("polyhaven_lobby.hdr", 0.35), ("polyhaven_sunrise.hdr", 0.25), 62
    floor = shapes.grid((-1.8, -1.5, 0), (3.6, 0, 0), (0, 3, 0), 120, 100)
    s.add("floor", floor, shapes.checks((0.42, 0.3, 0.2), (0.36, 0.25, 0.16), (0, 1), 0.3))
    s.add("back", shapes.grid((-1.8, 1.5, 0), (3.6, 0, 0), (0, 0, 2.3), 110, 70), (0.55, 0.62, 0.6))
    right = shapes.grid((1.8, 1.5, 0), (0, -3, 0), (0, 0, 2.3), 100, 70)
    s.add("right", right, shapes.bands((0.75, 0.7, 0.58), (0.68, 0.62, 0.5), 1, 0.25))
    frame = [shapes.box((-1.6, -0.1, 0.15), (-0.2, 1.4, 0.38), 0.035),
             shapes.box((-1.6, 1.4, 0.1), (-0.2, 1.47, 0.85), 0.035)]
    s.add("bed", shapes.join(frame), (0.3, 0.2, 0.14))
    cover = shapes.box((-1.58, -0.12, 0.38), (-0.22, 0.95, 0.47), 0.03)
    s.add("cover", cover, s.spots((0.15, 0.22, 0.5), (0.7, 0.7, 0.72), 0.2))
    s.add("pillow", shapes.box((-1.3, 1.02, 0.39), (-0.55, 1.35, 0.52), 0.025), (0.85, 0.84, 0.8))
    s.add("chest", shapes.box((0.9, 0.95, 0), (1.7, 1.45, 0.75), 0.03), (0.65, 0.12, 0.1), 0.3)
    s.add("bust", s.read("max-planck-decimated.obj", 0.42, (1.3, 1.18, 0.75), -40), (0.78, 0.74, 0.68))
    s.add("stool", shapes.box((0.2, -0.25, 0), (0.6, 0.15, 0.42), 0.025), (0.25, 0.45, 0.25))
    s.add("armadillo", s.read("armadillo.obj", 0.36, (0.4, -0.05, 0.42), 160), (0.7, 0.55, 0.25))
    t = np.linspace(0, 1, 14)
    outside = list(zip(0.19 - 0.1 * t, 1.36 + 0.26 * t))
    shade = outside + [(r - 0.004, z) for r, z in outside[::-1]] + outside[:1]
    s.add("shade", shapes.lathe(shade, 64, (0.55, 1.2, 0)), (0.8, 0.72, 0.55))
    base = shapes.lathe([(0.13, 0.001), (0.13, 0.025), (0.001, 0.03)], 40, (0.55, 1.2, 0))
    pole = shapes.cylinder(0.012, 0.02, 1.36, 60, 12, (0.55, 1.2, 0))
    s.add("stand", shapes.join([base, pole]), (0.1, 0.1, 0.1))
    s.light("bulb", shapes.sphere((0.55, 1.2, 1.47), 0.045), (95, 62, 32))
    s.light("panel", shapes.box((-0.9, 0, 1.95), (-0.3, 0.6, 1.975), 0.05), (5, 5.4, 6))
    ends = [(0.0005, -0.45)] + [(0.014, z) for z in np.linspace(-0.45, 0.45, 60)] + [(0.0005, 0.45)]
    v, f = shapes.lathe(ends, 20)
    s.light("neon", (np.stack([v[:, 2], v[:, 1], -v[:, 0]], 1) + np.array((-0.9, 1.44, 1.35)), f), (16, 3, 11))
    s.arc((0, 0.5, 0.55), 12, -112, 95, (2.9, 0.5), (1.55, 0.55), 0.12)
    s.main, s.novel = 5, (np.array((-0.9, -2.7, 1.35)), np.array((0, 0.5, 0.55)))
    s.edit("bulb-off", "bulb", power=(0, 0, 0))
    s.edit("bulb-moved", "bulb", move=(-0.55, -1.4, -0.75))
    s.edit("panel-recoloured", "panel", power=(0.3, 1, 2.2))
    s.edit("neon-moved", "neon", move=(0.6, -0.5, -1))
    return s


def write_mesh(out, scene, normals):
    objects = scene.objects
    lights = [o["name"] for o in objects if o["radiance"]]
    v, f = shapes.join([(o["vertices"], o["triangles"]) for o in objects])
    albedo = np.concatenate([o["albedo"] for o in objects])

    def each(value):
        return np.concatenate([np.full(len(o["vertices"]), value(o)) for o in objects])
    place = [("xyz"[k], v[:, k], "<f4") for k in range(3)]
    write_ply(f"{out}/mesh.ply", place + [("n" + "xyz"[k], normals[:, k], "<f4") for k in range(3)], f)
    kind = each(lambda o: 3 if o["radiance"] else 2 if o["roughness"] < 1 else 0)
    rgb = list(enumerate("rgb"))
    write_ply(f"{out}/truth/vertices.ply", place
              + [("albedo_" + c, albedo[:, k], "<f4") for k, c in rgb]
              + [("specular_" + c, np.where(kind == 2, 0.04, 0), "<f4") for _, c in rgb]
              + [("roughness", each(lambda o: o["roughness"]), "<f4")]
              + [("emission_" + c, each(lambda o: o["radiance"][k] if o["radiance"] else 0), "<f4") for k, c in rgb]
              + [("emitter_id", each(lambda o: lights.index(o["name"]) if o["radiance"] else -1), "<i4"),
                 ("material_id", kind, "<i4"),
                 ("object_id", np.repeat(np.arange(len(objects)), [len(o["vertices"]) for o in objects]), "<i4")], f)


def main():
    data, out, name = sys.argv[sys.argv.index("--") + 1:][:3]
    kind, _, seed = name.partition(":")
    if seed:
        scene = made_at_random.draw(Made(data, int(seed)), int(seed), kind == "room")
    else:
        scene = {"still-life": still_life, "kitchen": kitchen, "loft": loft}[kind](data)
    for folder in ("images", "truth/relit", "truth/masks"):
        os.makedirs(f"{out}/{folder}", exist_ok=True)
    renderer = Renderer(scene.objects, scene.bounces, scene.fov)
    write_mesh(out, scene, renderer.normals())
    own = renderer.panorama(f"{data}/hdri/{scene.environment[0]}", scene.environment[1], f"{out}/truth/env.exr")
    other = renderer.panorama(f"{data}/hdri/{scene.others[0]}", scene.others[1], f"{out}/truth/env-other.exr")
    white = renderer.even(0.5, f"{out}/truth/env-white.exr")
    cameras = [camera_at(*c) for c in scene.cameras]
    intrinsics = renderer.intrinsics()
    frames = [{"file_path": f"images/{i:04}.exr", "transform_matrix": m.tolist()} for i, m in enumerate(cameras)]
    with open(f"{out}/transforms.json", "w") as f:
        json.dump({**intrinsics, "mesh_path": "mesh.ply", "frames": frames}, f, indent=1)
    renderer.light_from(own)
    for i, m in enumerate(cameras):
        renderer.render(m, f"{out}/images/{i:04}.exr", 40, i + 1)
    lights = [o["name"] for o in scene.objects if o["radiance"]]
    entries = []

    def entry(name, edits=(), environment=None, matrix=None):
        renderer.light_from(environment or own)
        for light, move, power in edits:
            renderer.change(light, move, power)
        m = cameras[scene.main] if matrix is None else matrix
        renderer.render(m, f"{out}/truth/relit/{name}.exr", 80, 99)
        renderer.mask(m, f"{out}/truth/masks/{name}.png")
        for light, _, _ in edits:
            renderer.change(light)
        told = []
        for light, move, power in edits:
            moved = np.eye(4)
            moved[:3, 3] = move or 0
            told.append({"emitter_id": lights.index(light), "matrix": moved.tolist(), "power_scale": list(power)})
        camera = scene.main if matrix is None else {**intrinsics, "transform_matrix": matrix.tolist()}
        entries.append({"name": name, "about": name, "camera": camera, "image": f"relit/{name}.exr", "edits": told,
                        "env": os.path.basename(environment) if environment else "unchanged"})
        with open(f"{out}/truth/relight.json", "w") as f:
            json.dump(entries, f, indent=1)
    off = [(light, None, (0, 0, 0)) for light in lights]
    entry("reconstruction")
    for name, *edit in scene.edits:
        entry(name, [edit])
    entry("only-world", off)
    entry("other-environment", environment=other)
    entry("white", off, white)
    entry("novel-view", matrix=camera_at(*scene.novel))


if __name__ == "__main__":
    main()

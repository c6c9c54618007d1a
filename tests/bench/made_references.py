"""Renders a capture with a grey ball and a chart of 24 patches in it, and no lamp or sky in any photograph. Inside
Blender:

    blender -b -P tests/bench/made_references.py -- DATA OUT [HDRI [R,G,B]]

DATA holds hdri/*.hdr and meshes/*. The environment alone lights a floor, three objects, the ball (albedo 0.18) and the
chart. Its colour is multiplied by R,G,B (1.2,1,0.75), which is what a wrong white balance does to all photographs.
truth/references.json holds the options that mark ball and chart. A minute on two cores.
"""
import json
import os
import sys

import numpy as np

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import made_shapes as shapes  # noqa: E402
from made_render import HEIGHT, WIDTH, Renderer, camera_at, read_pixels, write_pixels  # noqa: E402
from made_scenes import Made, write_mesh  # noqa: E402
from mathutils import Vector  # noqa: E402
import bpy  # noqa: E402

# Published sRGB codes of the chart's patches under D65, row by row from dark skin.
CODES = """115 82 68 194 150 130 98 122 157 87 108 67 133 128 177 103 189 170 214 126 44 80 91 166 193 90 99 94 60 108
157 188 64 224 163 46 56 61 150 70 148 73 175 54 60 231 199 31 187 86 149 8 133 161 243 243 242 200 200 200
160 160 160 122 122 121 85 85 85 52 52 52"""
SPACING, PATCH, CHART = 0.05, 0.044, np.array((-0.34, -0.12, 0.01))  # metres; the middle of dark skin
BALL, RADIUS = np.array((0.2, -0.22, 0.0705)), 0.07


def middle(k):
    return CHART + SPACING * np.array((k % 6, -(k // 6), 0))


def chart():
    s = np.array(CODES.split(), float).reshape(24, 3) / 255
    linear = np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)
    half = np.array((PATCH / 2, PATCH / 2, 0))
    sheets = [shapes.grid(middle(k) - half, (PATCH, 0, 0), (0, PATCH, 0), 6, 6) for k in range(24)]
    return shapes.join(sheets), np.repeat(linear, [len(v) for v, _ in sheets], 0)


def scene_of(data):
    s = Made(data, 8)
    s.bounces, s.fov = 0, 50
    s.add("floor", shapes.grid((-1.3, -1.3, 0), (2.6, 0, 0), (0, 2.6, 0), 170, 170),
          s.spots((0.5, 0.42, 0.34), (0.36, 0.3, 0.26), 0.1))
    s.add("figure", s.read("fertility.off", 0.26, (-0.1, 0.2, 0.001), 30), (0.62, 0.6, 0.58))
    s.add("bust", s.read("max-planck-decimated.obj", 0.22, (0.24, 0.14, 0.001), -20), (0.3, 0.42, 0.62), 0.35)
    s.add("block", shapes.box((-0.42, 0.05, 0.001), (-0.26, 0.2, 0.12), 0.008), (0.2, 0.5, 0.28))
    s.add("ball", shapes.sphere(BALL, RADIUS, 90), (0.18, 0.18, 0.18))
    low, high = middle(18) - SPACING * 0.8, middle(5) + SPACING * 0.8
    low[2], high[2] = 0.001, 0.009
    s.add("frame", shapes.box(low, high, 0.01), (0.04, 0.04, 0.04))
    s.add("chart", *chart())
    s.arc((0, 0, 0), 5, -152.5, 125, (0.95, 0.05), (1.05, 0.1), 0.02)
    return s


def main():
    data, out, *more = sys.argv[sys.argv.index("--") + 1:]
    scene = scene_of(data)
    for folder in ("images", "truth"):
        os.makedirs(f"{out}/{folder}", exist_ok=True)
    renderer = Renderer(scene.objects, scene.bounces, scene.fov)
    write_mesh(out, scene, renderer.normals())
    sky = renderer.panorama(f"{data}/hdri/{more[0] if more else 'polyhaven_studio.hdr'}", 0.6, f"{out}/truth/env.exr")
    tint = np.array([float(x) for x in (more[1] if len(more) > 1 else "1.2,1,0.75").split(",")])
    renderer.light_from(write_pixels(read_pixels(sky) * tint, sky))
    cameras = [camera_at(*c) for c in scene.cameras]
    frames = [{"file_path": f"images/{i:04}.exr", "transform_matrix": m.tolist()} for i, m in enumerate(cameras)]
    with open(f"{out}/transforms.json", "w") as f:
        json.dump({**renderer.intrinsics(), "mesh_path": "mesh.ply", "frames": frames}, f, indent=1)
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()

    def pixel(m, at):
        p = m[:3, :3].T @ (at - m[:3, 3])
        return WIDTH / 2 - renderer.focal * p[0] / p[2], HEIGHT / 2 + renderer.focal * p[1] / p[2]

    def shows(m, at, name):
        away = at - m[:3, 3]
        hit = renderer.scene.ray_cast(graph, Vector(m[:3, 3]), Vector(away / np.linalg.norm(away)))
        return hit[0] and hit[4].name == name

    balls, charts = [], []
    for i, m in enumerate(cameras):
        x, y = pixel(m, BALL)
        radius = 0.75 * renderer.focal * RADIUS / np.linalg.norm(BALL - m[:3, 3])
        if shows(m, BALL, "ball"):
            balls.append(f"{i}:{x:.1f},{y:.1f},{radius:.1f}=0.18")
        if all(shows(m, middle(k), "chart") for k in range(24)):
            corners = [pixel(m, middle(k)) for k in (0, 5, 23, 18)]
            charts.append(f"{i}:" + ",".join(f"{c:.1f}" for corner in corners for c in corner))
    with open(f"{out}/truth/references.json", "w") as f:
        json.dump({"grey": balls, "chart": charts, "objects": [4, 5, 6]}, f, indent=1)
    for i, m in enumerate(cameras):
        if not os.path.exists(f"{out}/images/{i:04}.exr"):
            renderer.render(m, f"{out}/images/{i:04}.exr", 40, i + 1)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""What a light reference is worth where no lamp is seen: one table row a solve.

    light_references.py SCENE OUT [--relamp build/relamp] [--quality draft] [--seen] [--proxy-light X,Y,Z]

SCENE has truth/vertices.ply (albedo, emission, emitter_id) and truth/env.exr. Its lamps are hidden (hide_lamp.py;
--seen leaves them), and --proxy-light says where one stands. The probe is the true environment, turned by 73.4 degrees,
times 0.37 0.40 0.33, with 3 % of noise a texel. With truth/references.json (made_references.py) it is solved without any
reference, with the probe, with the ball in three views, with the chart in the view that shows it largest, and with
probe and ball. Else the grey patch is a disc of the true albedo: the largest of one paint that a view shows. Scale:
found over true albedo, median of the matte vertices that are seen but for the references' own, red green blue; then
the deviation of that ratio over the scene. Environment: relative L2 at 64 x 32 after one scale. Needs python3-numpy
and python3-openimageio.
"""
import argparse, json, pathlib, shutil, subprocess, sys
import numpy as np
import OpenImageIO as oiio

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from hide_lamp import read_ply  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("scene", type=pathlib.Path)
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--relamp", default="build/relamp")
parser.add_argument("--quality", default="draft")
parser.add_argument("--seen", action="store_true")
parser.add_argument("--proxy-light", action="append", default=[])
parser.add_argument("--only", action="append", help="rows to make, by name")
arguments = parser.parse_args()
scene, out = arguments.scene, arguments.out
capture = scene
if not arguments.seen:
    capture = out / "capture"
    if not capture.exists():
        hide = pathlib.Path(__file__).parent / "hide_lamp.py"
        subprocess.run([sys.executable, hide, scene, capture], check=True, stdout=subprocess.DEVNULL)
out.mkdir(parents=True, exist_ok=True)


def picture(path):
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT), np.float64)[..., :3]


def shrink(x, h):
    H, W = x.shape[:2]
    weight = np.cos((np.arange(H) + .5) / H * np.pi - np.pi / 2)[:, None, None]
    block = lambda v: v.reshape(h, H // h, 2 * h, W // (2 * h), -1).sum((1, 3))
    return block(x * weight) / block(weight * np.ones((H, W, 1)))


env = picture(scene / "truth/env.exr")
random = np.random.default_rng(7)
probe = np.roll(env, round(73.4 / 360 * env.shape[1]), axis=1) * [0.37, 0.40, 0.33]
probe *= 1 + 0.03 * random.standard_normal(env.shape)
buffer = oiio.ImageBuf(oiio.ImageSpec(env.shape[1], env.shape[0], 3, oiio.FLOAT))
buffer.set_pixels(oiio.ROI(0, env.shape[1], 0, env.shape[0]), np.maximum(probe, 0).astype(np.float32))
buffer.write(str(out / "probe.exr"))

document = json.loads((scene / "transforms.json").read_text())
vertices, _ = read_ply(scene / document.get("mesh_path", "mesh.ply"))
truth, _ = read_ply(scene / "truth/vertices.ply")
place = np.stack([vertices[c] for c in "xyz"], 1).astype(float)
albedo = np.stack([truth["albedo_" + c] for c in "rgb"], 1).astype(float)
matte = (albedo.min(1) > 0.02) & (truth["emitter_id"] < 0)
marked = scene / "truth/references.json"
marked = json.loads(marked.read_text()) if marked.exists() else None
if marked:
    matte &= (truth["specular_r"] == 0) & ~np.isin(truth["object_id"], marked["objects"])


def grey_patch():
    """View, pixel and radius of a disc whose vertices have one albedo, the widest there is, and that albedo."""
    best = (0, None)
    for k, frame in enumerate(document["frames"]):
        value = {**document, **frame}
        pose = np.linalg.inv(np.array(frame["transform_matrix"]))
        camera = place @ pose[:3, :3].T + pose[:3, 3]
        focal = value.get("fl_x") or 0.5 * value["w"] / np.tan(0.5 * value["camera_angle_x"])
        depth = -camera[:, 2]
        ahead = depth > 1e-6
        far = np.where(ahead, depth, 1)
        pixel = np.stack([value.get("cx", value["w"] / 2) + focal * camera[:, 0] / far,
                          value.get("cy", value["h"] / 2) - value.get("fl_y", focal) * camera[:, 1] / far], 1)
        inside = ahead & (pixel > 4).all(1) & (pixel[:, 0] < value["w"] - 4) & (pixel[:, 1] < value["h"] - 4)
        nearest = np.full((value["h"] // 8 + 1, value["w"] // 8 + 1), 1e30)
        cell = (pixel[inside] / 8).astype(int)
        np.minimum.at(nearest, (cell[:, 1], cell[:, 0]), depth[inside])
        # A cell without a vertex is no surface for sure.
        rows, columns = np.nonzero(nearest > 1e29)
        empty = 8 * np.stack([columns, rows], 1) + 4
        for at in random.choice(np.flatnonzero(inside & matte), 300):
            x, y = pixel[at]
            if depth[at] > 1.03 * nearest[int(y / 8), int(x / 8)]:
                continue
            away = np.hypot(*(pixel[inside] - pixel[at]).T)
            off = np.abs(albedo[inside] - albedo[at]).max(1) > 0.02 * albedo[at].max()
            gap = np.hypot(*(empty - pixel[at]).T).min(initial=1e9) - 6
            radius = min(away[off].min(initial=1e9), gap, x, y, value["w"] - x, value["h"] - y) - 2
            if radius > best[0]:
                best = (radius, (k, x, y, min(radius, 25), albedo[at]))
    return best[1]


def solve(name, options):
    shot = out / (name + ".relamp")
    shutil.rmtree(shot, ignore_errors=True)
    command = [arguments.relamp, "solve", capture, "-o", shot, "--quality", arguments.quality, "--accept-poor",
               "--quiet", "--texture", "off", *options]
    for light in arguments.proxy_light:
        command.append("--proxy-light=" + light)
    run = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if run.returncode:
        print(f"| {name} | exit {run.returncode}: {run.stderr.strip().splitlines()[-1]} | | | |")
        return
    info = json.loads((shot / "shot.json").read_text())
    found, _ = read_ply(shot / "reflectance.ply")
    found = found[:len(albedo)]
    seen = matte & (found["observed"] > 0)
    ratios = np.stack([found["albedo_" + c] for c in "rgb"], 1)[seen] / albedo[seen]
    ratio = np.median(ratios, 0)
    spread = 1.4826 * np.median(np.abs(ratios / ratio - 1))
    wanted, got = shrink(env, 32), shrink(picture(shot / "environment.exr"), 32)
    weight = np.cos((np.arange(32) + .5) / 32 * np.pi - np.pi / 2)[:, None, None]
    gain = (weight * wanted * got).sum() / max((weight * got * got).sum(), 1e-30)
    off = np.sqrt((weight * (gain * got - wanted) ** 2).sum() / (weight * wanted ** 2).sum())
    print(f"| {name} | {len(info['emitters'])} | {' '.join(f'{v:.3f}' for v in ratio)} | {100 * spread:.1f} % | "
          f"{off:.3f} | {info['reproduction']['psnr']:.1f} dB | {info['gauge']['kind']} |", flush=True)


def area(chart):
    x, y = np.array([float(v) for v in chart.split(":")[1].split(",")]).reshape(4, 2).T
    return abs(x @ np.roll(y, 1) - y @ np.roll(x, 1))


print("| reference | lights | scale | its deviation | environment | reproduction | scale by |")
print("|---|---|---|---|---|---|---|")
probe = ["--light-probe", out / "probe.exr"]
runs = {"none": [], "probe": probe}
if marked:
    balls = marked["grey"]
    ball = ["--grey=" + balls[k * (len(balls) - 1) // 2] for k in range(3)]
    runs |= {"ball": ball, "chart": ["--chart=" + max(marked["chart"], key=area)], "probe and ball": probe + ball}
elif patch := grey_patch():
    k, x, y, radius, true = patch
    grey = ["--grey", f"{k}:{x:.0f},{y:.0f},{radius:.0f}=" + ",".join(f"{v:.4f}" for v in true)]
    runs |= {"grey": grey, "probe and grey": probe + grey}
for name, options in runs.items():
    if not arguments.only or name in arguments.only:
        solve(name.replace(" ", "-"), options)

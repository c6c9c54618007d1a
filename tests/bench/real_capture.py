#!/usr/bin/env python3
"""Photographed data sets with a calibration of their own, as captures.

    real_capture.py SOURCE OUT [--up AXIS] [--balance] [--mask-dark SHARE]

SOURCE: *_par.txt (Middlebury: name, K, R, t a line) with visual_hull.ply, or cameras.json (OpenCV's K, R, t) with mesh.ply; pixel centres lie at whole
numbers. --balance: photographs with automatic exposure and white balance are brought to the first one's by the median ratio, channel by
channel, over the mesh's vertices that two photographs see (a chain over all pairs, least squares in logarithms); photographs are
written as EXR. --mask-dark: pixels below that share of full scale that the mesh does not cover are black cloth, not surroundings: masked. Needs numpy, OpenImageIO."""
import argparse
import glob
import json
import os
import sys

import numpy as np
import OpenImageIO as oiio

from graycode import linear, picture, project, read_mesh


def views_of(source):
    par = glob.glob(f"{source}/*_par.txt")
    if par:
        views = []
        for line in open(par[0]).read().splitlines()[1:]:
            words = line.split()
            if len(words) < 22:
                continue
            n = [float(w) for w in words[1:]]
            views.append({"image": words[0], "K": np.reshape(n[:9], (3, 3)).tolist(), "R": np.reshape(n[9:18], (3, 3)).tolist(), "t": n[18:21]})
        return views, glob.glob(f"{source}/*.ply")[0]
    return json.load(open(f"{source}/cameras.json"))["views"], f"{source}/mesh.ply"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("source")
    arguments.add_argument("out")
    arguments.add_argument("--up", default="z")
    arguments.add_argument("--balance", action="store_true")
    arguments.add_argument("--mask-dark", type=float, default=0)
    a = arguments.parse_args()
    views, mesh = views_of(a.source)
    vertices, faces = read_mesh(mesh)
    os.makedirs(f"{a.out}/images", exist_ok=True)
    os.makedirs(f"{a.out}/masks", exist_ok=True)
    with open(mesh, "rb") as file, open(f"{a.out}/mesh.ply", "wb") as copy:
        copy.write(file.read())
    images, pixels, clear = [], [], []
    for view in views:
        codes = picture(f"{a.source}/{view['image']}")
        view["height"], view["width"] = codes.shape[:2]
        view.setdefault("distortion_k1k2p1p2k3", [0] * 5)
        at, depth = project(view, vertices)
        cell = np.floor(at / 4).astype(int)
        inside = (cell >= 0).all(1) & (cell[:, 0] < view["width"] // 4) & (cell[:, 1] < view["height"] // 4)
        nearest = np.full((view["height"] // 4, view["width"] // 4), 1e9)
        np.minimum.at(nearest, (cell[inside, 1], cell[inside, 0]), depth[inside])
        size = np.linalg.norm(vertices.max(0) - vertices.min(0))
        good = inside.copy()
        good[inside] = depth[inside] < nearest[cell[inside, 1], cell[inside, 0]] + 0.01 * size
        images.append(linear(codes))
        whole = np.round(at).astype(int).clip(0, [view["width"] - 1, view["height"] - 1])
        pixels.append(whole)
        clear.append(good & (codes[whole[:, 1], whole[:, 0]].max(1) < 0.97) & (codes[whole[:, 1], whole[:, 0]].min(1) > 0.05))
    gains = np.ones((len(views), 3))
    if a.balance:
        rows, right = [], []
        for i in range(len(views)):
            for j in range(i):
                both = clear[i] & clear[j]
                if both.sum() < 200:
                    continue
                ratio = np.median(np.log(images[j][pixels[j][both, 1], pixels[j][both, 0]] / images[i][pixels[i][both, 1], pixels[i][both, 0]]), axis=0)
                row = np.zeros(len(views))
                row[i], row[j] = 1, -1
                rows.append(row)
                right.append(ratio)
        rows.append(np.eye(len(views))[0])
        right.append(np.zeros(3))
        gains = np.exp(np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0])
        left = np.array(rows) @ np.log(gains) - np.array(right)
        print(f"gains {gains.min(0).round(2)} to {gains.max(0).round(2)}; pairs disagree by {np.median(np.abs(left)):.3f} (median, logarithm)", file=sys.stderr)
    frames = []
    for view, image, gain in zip(views, images, gains):
        name = os.path.splitext(os.path.basename(view["image"]))[0]
        # A clipped pixel stays a clipped one: it is not a number that may be scaled.
        clipped = image.max(2) > 0.96
        scaled = image * gain
        out = oiio.ImageBuf(oiio.ImageSpec(view["width"], view["height"], 3, oiio.HALF))
        out.set_pixels(oiio.ROI(0, view["width"], 0, view["height"]), np.ascontiguousarray(scaled, dtype=np.float32))
        out.write(f"{a.out}/images/{name}.exr")
        mask = np.ones((view["height"], view["width"]), np.float32)
        if a.balance:
            mask[clipped] = 0
        if a.mask_dark > 0:
            mask[image.max(2) < linear(np.array(a.mask_dark))] = 0
        if mask.min() == 0:
            out = oiio.ImageBuf(oiio.ImageSpec(view["width"], view["height"], 1, oiio.UINT8))
            out.set_pixels(oiio.ROI(0, view["width"], 0, view["height"]), mask[:, :, None])
            out.write(f"{a.out}/masks/{name}.exr.png")
        r, t = np.array(view["R"]), np.array(view["t"])
        pose = np.eye(4)
        pose[:3, :3] = r.T * [1, -1, -1]
        pose[:3, 3] = -r.T @ t
        k = view["K"]
        frames.append({"file_path": f"images/{name}.exr", "w": view["width"], "h": view["height"], "fl_x": k[0][0], "fl_y": k[1][1], "cx": k[0][2] + 0.5, "cy": k[1][2] + 0.5,
                       "transform_matrix": pose.tolist()})
    json.dump({"up": a.up, "mesh_path": "mesh.ply", "frames": frames}, open(f"{a.out}/transforms.json", "w"), indent=1)


if __name__ == "__main__":
    main()

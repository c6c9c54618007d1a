#!/usr/bin/env python3
"""How well a shot's standard deviations tell its true errors.

    uncertainty.py SCENE=SHOT [SCENE=SHOT...]

Needs python3-numpy, python3-openimageio. SCENE holds truth/vertices.ply (albedo_r, albedo_g, albedo_b, emitter_id) and truth/env.exr
(lat-long). For each: rank correlation (Spearman) of deviation and true relative error, over vertices with an albedo (their common scale
left in: it is part of the error) and over cells of the environment; the median of |error| / deviation, 0.67 when calibrated; the share
of errors within two deviations, .95 when calibrated; the scale's error against its deviation per channel.
"""
import sys, json, pathlib
import numpy as np
import OpenImageIO as oiio


def picture(path):
    buf = oiio.ImageBuf(str(path))
    return np.asarray(buf.get_pixels(oiio.FLOAT), np.float64)[..., :3]


def vertices(path):
    kinds = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + 11
    props, count, inside = [], 0, False
    for line in data[:end].decode().splitlines():
        w = line.split()
        if w[0] == "element":
            inside = w[1] == "vertex"
            count = int(w[2]) if inside else count
        elif w[0] == "property" and inside:
            props.append((w[2], kinds[w[1]]))
    return np.frombuffer(data, dtype=props, count=count, offset=end)


def rank(a, b):
    order = lambda x: np.argsort(np.argsort(x)).astype(float)
    return np.corrcoef(order(a), order(b))[0, 1]


def tell(name, error, sigma, few=""):
    z = error / np.maximum(sigma, 1e-9)
    print(f"{name:32s} {few} rank {rank(sigma, error):5.2f}   median error {np.median(error):6.3f}  deviation {np.median(sigma):6.3f}  |z| {np.median(z):5.2f}  within 2: {np.mean(z < 2):4.2f}")


def shrink(x, h):
    H, W = x.shape[:2]
    weight = np.cos((np.arange(H) + .5) / H * np.pi - np.pi / 2)[:, None, None]
    block = lambda v: v.reshape(h, H // h, 2 * h, W // (2 * h), -1).sum((1, 3))
    return block(x * weight) / block(weight * np.ones((H, W, 1)))


for pair in sys.argv[1:]:
    scene, shot = map(pathlib.Path, pair.split("="))
    t, r = vertices(scene / "truth/vertices.ply"), vertices(shot / "reflectance.ply")
    if "albedo_sigma" not in r.dtype.names:
        print(f"{scene.name}: not assessed")
        continue
    truth = np.stack([t["albedo_" + c] for c in "rgb"], 1)
    found = np.stack([r["albedo_" + c] for c in "rgb"], 1)
    good = (truth.min(1) > 0.02) & (t["emitter_id"] < 0)
    error = np.abs(found / np.maximum(truth, 1e-6) - 1).mean(1)
    seen = good & (r["observed"] > 0)
    print(scene.name)
    tell("  albedo, all vertices", error[good], r["albedo_sigma"][good])
    tell("  albedo, seen vertices", error[seen], r["albedo_sigma"][seen])
    gauge = json.load(open(shot / "shot.json"))["gauge"]
    scale = np.median(found[seen] / truth[seen], 0) - 1
    print("    scale off by", " ".join(f"{100 * v:.1f}" for v in scale), "%, deviation", " ".join(f"{100 * v:.1f}" for v in gauge.get("sigma", [])), "%", gauge["kind"])
    env, got, sigma = (shrink(picture(p), 32) for p in (scene / "truth/env.exr", shot / "environment.exr", shot / "environment_sigma.exr"))
    mean = env.mean()
    if mean > 0:
        e, s = np.abs(got - env).mean(2).ravel() / mean, sigma.mean(2).ravel() / mean
        tell("  environment, cells of 64 x 32", e, s)

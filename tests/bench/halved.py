#!/usr/bin/env python3
"""Where the error of frames lies, against a scene's truth: halved.py SCENE FOLDER [--map OUT]

FOLDER holds NAME.exr for each entry of SCENE/truth/relight.json. A row of the table: dB of display values inside the
mask, as in full; with the truth's hues; with its brightness; the part of the squared error in the worst 1 % of the
pixels. Then both images are halved, so that prints as fine as a pixel count little and light counts all the more: dB;
after one scale per image, and per channel; the mean of ours over the truth's, in the darker and in the brighter half of
the truth. --map writes NAME.png into OUT: ours over the truth's, 0.5 to 1.5, red where ours is brighter.
"""
import argparse
import json
import os

import numpy as np
import OpenImageIO as oiio

LUMA = np.array([0.2126, 0.7152, 0.0722])


def read(file):
    return oiio.ImageBuf(file).get_pixels(oiio.FLOAT)[..., :3].astype(np.float64)


def halved(a):
    h, w = a.shape[0] // 2 * 2, a.shape[1] // 2 * 2
    return a[:h, :w].reshape(h // 2, 2, w // 2, 2, -1).mean((1, 3))


def display(a):
    a = np.clip(a, 0, 1)
    return np.where(a <= 0.0031308, 12.92 * a, 1.055 * np.maximum(a, 1e-12) ** (1 / 2.4) - 0.055)


def errors(ours, truth, mask):
    """Squared error of display values at each pixel inside the mask."""
    scale = 1 / np.percentile((truth @ LUMA)[mask], 99.5)
    return ((display(ours[mask] * scale) - display(truth[mask] * scale)) ** 2).mean(-1)


def psnr(ours, truth, mask):
    return -10 * np.log10(errors(ours, truth, mask).mean())


def worst(ours, truth, mask, part=0.01):
    """The part of the squared error that the worst pixels have."""
    each = np.sort(errors(ours, truth, mask))[::-1]
    return each[: max(1, int(part * len(each)))].sum() / max(each.sum(), 1e-30)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("folder")
    parser.add_argument("--map")
    args = parser.parse_args()
    truth_folder = os.path.join(args.scene, "truth")
    entries = json.load(open(os.path.join(truth_folder, "relight.json")))
    entries = entries["entries"] if isinstance(entries, dict) else entries
    print("| | dB | true hues | true brightness | worst 1 % | halved | one scale | three | ours over truth, darker and "
          "brighter half |\n|---|---|---|---|---|---|---|---|---|")
    for entry in entries:
        name = entry["name"]
        if not os.path.exists(os.path.join(args.folder, name + ".exr")):
            continue
        ours, truth = read(os.path.join(args.folder, name + ".exr")), read(os.path.join(truth_folder, entry["image"]))
        mask = read(os.path.join(truth_folder, "masks", name + ".png"))[..., 0] > 0.5 if os.path.exists(
            os.path.join(truth_folder, "masks", name + ".png")) else np.ones(truth.shape[:2], bool)
        full = psnr(ours, truth, mask)
        level, true_level = (np.maximum(x @ LUMA, 1e-6)[..., None] for x in (ours, truth))
        hues, brightness = (psnr(x, truth, mask) for x in (truth / true_level * level, ours / level * true_level))
        a, b, m = halved(ours), halved(truth), halved(mask[..., None].astype(float))[..., 0] == 1
        one = np.sum(a[m] * b[m]) / np.sum(a[m] ** 2)
        three = np.sum(a[m] * b[m], 0) / np.sum(a[m] ** 2, 0)
        bright = (b @ LUMA) > np.median((b @ LUMA)[m])
        print("| %s | %.1f | %.1f | %.1f | %.0f %% | %.1f | %.1f | %.1f | %.3f %.3f |" % (
            name, full, hues, brightness, 100 * worst(ours, truth, mask), psnr(a, b, m), psnr(a * one, b, m),
            psnr(a * three, b, m),
            a[m & ~bright].sum() / b[m & ~bright].sum(), a[m & bright].sum() / b[m & bright].sum()))
        if args.map:
            ratio = (a @ LUMA) / np.maximum(b @ LUMA, 1e-6)
            level = np.clip(ratio - 0.5, 0, 1)
            picture = np.stack([level, 0.5 - np.abs(level - 0.5), 1 - level], -1) * m[..., None]
            out = oiio.ImageOutput.create(os.path.join(args.map, name + ".png"))
            out.open(os.path.join(args.map, name + ".png"), oiio.ImageSpec(a.shape[1], a.shape[0], 3, "uint8"))
            out.write_image(np.ascontiguousarray(picture, np.float32))
            out.close()


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""A shot in Blender and in Nuke's script, against relamp's own frame of the same view.

    exports.py SHOT OUT [--relamp build/relamp] [--view 0] [--samples 256]

Blender: `scene.py` of `relamp export` renders the view in Cycles. Where the frame's albedo is not 0: the light of the image over relamp's,
the median of what pixels are off, and the root mean square over blocks of 4 x 4 pixels. Nuke: the layers that relight.nk adds up, as they
stand in the frame's file (half floats), against its beauty. Shots of `--basis lambert` are matte all over. Needs blender, python3-numpy and
python3-openimageio.
"""
import argparse, pathlib, re, shutil, subprocess
import numpy as np
import OpenImageIO as oiio

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("shot", type=pathlib.Path)
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--relamp", default="build/relamp")
parser.add_argument("--view", type=int, default=0)
parser.add_argument("--samples", type=int, default=256)
arguments = parser.parse_args()
out = arguments.out
shutil.rmtree(out, ignore_errors=True)
out.mkdir(parents=True)


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


run(arguments.relamp, "export", arguments.shot, "-o", out / "scene")
frame = out / "frame.exr"
run(arguments.relamp, "render", arguments.shot, "-o", frame, "--camera", arguments.view, "--samples", 32, "--layers", "groups,albedo", "--denoise", "off")
run("blender", "-b", "--python", out / "scene/scene.py", "--", "--view", arguments.view, "--samples", arguments.samples, "--render", out / "blender.exr")


def channels(path):
    buffer = oiio.ImageBuf(str(path))
    pixels = np.asarray(buffer.get_pixels(oiio.FLOAT), np.float64)
    return {name: pixels[..., i] for i, name in enumerate(buffer.spec().channelnames)}


def layer(names, prefix):
    return np.stack([names[prefix + c] for c in "RGB"], -1)


ours, cycles = channels(frame), channels(out / "blender.exr")
beauty, theirs = layer(ours, ""), layer(cycles, "")
albedo = [k[:-1] for k in ours if re.search(r"albedo\.R$", k, re.I)][0]
surface = (layer(ours, albedo).min(2) > 1e-3) & (ours["A"] > 0.999)
light = theirs[surface].sum(0) / beauty[surface].sum(0)
off = np.abs(theirs[surface] / np.maximum(beauty[surface], 1e-9) - 1).mean(1)


def blocks(image):
    h, w = image.shape[0] // 4 * 4, image.shape[1] // 4 * 4
    return image[:h, :w].reshape(h // 4, 4, w // 4, 4, -1).mean((1, 3))


whole = blocks(surface[..., None].astype(float))[..., 0] > 0.999
difference = blocks(theirs)[whole] / blocks(beauty)[whole] - 1
print(f"Blender: {surface.sum()} pixels, light {' '.join(f'{v:.4f}' for v in light)} of relamp's, median {100 * np.median(off):.2f} %, "
      f"blocks {100 * np.sqrt(np.mean(difference ** 2)):.2f} %, their median {100 * np.median(np.abs(difference)):.2f} %")

script = (out / "scene/relight.nk").read_text()
groups = re.findall(r"add_layer \{(\S+) ", script)
total = sum(layer(ours, name + ".") for name in groups)
error = np.abs(total - beauty) / np.maximum(beauty, 1e-3 * beauty.max())
print(f"Nuke: {len(groups)} layers, sum off by {100 * error.max():.3f} % of the beauty at most, {100 * np.median(error):.4f} % in the median")

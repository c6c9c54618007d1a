#!/usr/bin/env python3
"""Shaped lights against Blender's Cycles: cycles_shaped.py SHOT BUILD [KIND...]

Each kind of shaped light is added to the shot alone, its surfaces made matte, without environment. `relamp render` and
Cycles, on what `relamp export` writes (scene.py), make the same view of it. A row of the table: the light of the whole
image over Cycles', and how far pixels are off, of those with at least a hundredth of the brightest light that 99 % of
the pixels do not reach: the median, and the root mean square over the mean of blocks of 4 x 4 pixels.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 320, 240
KINDS = {
    "even rectangle": {"shape": "rectangle", "size": [0.2, 0.1]},
    "spot, hard cone": {"shape": "spot", "size": [0.03], "shaping": {"cone_degrees": 20}},
    "spot, soft cone, focus": {"shape": "spot", "size": [0.03],
                               "shaping": {"cone_degrees": 30, "cone_softness": 0.6, "focus": 4}},
    "IES profile on a sphere": {"shape": "sphere", "size": [0.04], "shaping": {"ies_file": "batwing.ies"}},
    "gobo": {"shape": "spot", "size": [0.01], "shaping": {"cone_degrees": 28, "gobo_file": "gobo.exr"}},
    "image on a rectangle": {"shape": "rectangle", "size": [0.3, 0.2], "shaping": {"surface_file": "softbox.exr"}},
    "barn doors": {"shape": "rectangle", "size": [0.2, 0.1],
                   "shaping": {"left_door_degrees": 30, "right_door_degrees": 60, "top_door_degrees": -10}},
    "sun": {"shape": "sun", "size": [2]},
}


def read(file):
    return oiio.ImageBuf(file).get_pixels(oiio.FLOAT)[..., :3].astype(np.float64)


def write(file, pixels):
    out = oiio.ImageOutput.create(file)
    out.open(file, oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float" if file.endswith("exr") else "uint8"))
    out.write_image(np.ascontiguousarray(pixels, np.float32))
    out.close()


def make_files(folder):
    """A luminaire brighter aside than down and to one side than to the other, leaves, a softbox with a hot spot."""
    vertical, horizontal = np.arange(0, 181, 10), np.arange(0, 361, 30)
    rows = [[1000 * (0.4 + np.sin(np.radians(v)) ** 2) * (1 + 0.5 * np.cos(np.radians(h))) for v in vertical]
            for h in horizontal]
    with open(folder + "/batwing.ies", "w") as file:
        file.write("IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 %d %d 1 2 0 0 0\n1 1 100\n" % (len(vertical), len(horizontal)))
        for row in [vertical, horizontal] + rows:
            file.write(" ".join("%.3f" % x for x in row) + "\n")
    y, x = np.mgrid[0:256, 0:256] / 256.0
    leaves = ((np.sin(19 * x + 3 * np.sin(11 * y)) * np.sin(17 * y + 2 * np.sin(7 * x))) > 0).astype(float)
    write(folder + "/gobo.exr", np.stack([leaves, 0.3 + 0.7 * leaves, leaves * x], -1))
    y, x = np.mgrid[0:96, 0:144] / 96.0
    hot = 0.2 + 3 * np.exp(-((x - 0.5) ** 2 + (y - 0.35) ** 2) * 18)
    write(folder + "/softbox.exr", np.stack([hot, 0.8 * hot, 0.3 + 0.5 * y * hot], -1))


def matte_copy(shot, to):
    """Lobes beside the matte part are taken away, in place."""
    shutil.copytree(shot, to)
    kinds = {"float": "<f4", "int": "<i4", "uchar": "u1"}
    with open(to + "/reflectance.ply", "rb") as file:
        header, fields, vertices = b"", [], 0
        while not header.endswith(b"end_header\n"):
            line = file.readline()
            header += line
            word = line.decode().split()
            if word[0] == "element" and word[1] == "vertex":
                vertices = int(word[2])
            if word[0] == "property" and word[1] != "list":
                fields.append((word[2], kinds[word[1]]))
        table = np.frombuffer(file.read(vertices * np.dtype(fields).itemsize), np.dtype(fields)).copy()
        tail = file.read()
    for name in table.dtype.names:
        if name.startswith("weight_") and not name.startswith("weight_0_"):
            table[name] = 0
    with open(to + "/reflectance.ply", "wb") as file:
        file.write(header + table.tobytes() + tail)
    document = json.load(open(to + "/shot.json"))
    capture = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(shot)), os.path.basename(shot),
                                            document["capture"]))
    if os.path.exists(capture):
        document["capture"] = capture
    document["look"] = {"version": 1}
    document["interreflection"] = {"kept": False}
    json.dump(document, open(to + "/shot.json", "w"))
    return document


def place_of(work):
    """Beside the second camera, aimed along it: a matrix in the world."""
    frames = json.load(open(work + "/even/transforms.json"))["frames"]
    matrix = np.array(frames[min(2, len(frames) - 1)]["transform_matrix"], float)
    matrix[:3, 3] -= 0.35 * np.linalg.norm(matrix[:3, 3]) * matrix[:3, 2]
    return matrix.tolist()


SMALL = """import bpy, runpy, sys
script, out = sys.argv[-2:]
sys.argv[sys.argv.index("--") + 1:] = ["--samples", "1024"]
runpy.run_path(script)
render = bpy.context.scene.render
render.resolution_x, render.resolution_y, render.filepath, render.film_transparent = %d, %d, out, True
bpy.ops.render.render(write_still=True)
""" % (WIDTH, HEIGHT)


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(" ".join(command) + "\n" + done.stdout[-2000:] + done.stderr[-2000:])


def main():
    shot, build, chosen = sys.argv[1], sys.argv[2], sys.argv[3:]
    relamp = build + "/relamp" if os.path.isdir(build) else build
    work = tempfile.mkdtemp()
    make_files(work)
    with open(work + "/small.py", "w") as file:
        file.write(SMALL)
    matte = work + "/matte.relamp"
    document = matte_copy(shot, matte)
    off = [{"id": e["id"], "enabled": False} for e in document["emitters"]]
    run(relamp, "--quiet", "export", matte, "-o", work + "/even")
    place = place_of(work)
    print("| light | light over Cycles' | median | RMS of blocks |\n|---|---|---|---|")
    for kind, light in KINDS.items():
        if chosen and kind not in chosen:
            continue
        radiance = [2, 1.8, 1.6] if light["shape"] == "sun" else [400, 360, 320]
        edits = {"version": 1, "environment": {"source": "none"}, "emitters": off,
                 "added_emitters": [{"id": "light", "matrix": place, "radiance": radiance, **light}]}
        json.dump(edits, open(work + "/edits.json", "w"))
        run(relamp, "--quiet", "render", matte, "-o", work + "/ours.exr", "--edits", work + "/edits.json", "--samples",
            "64", "--denoise", "off", "--size", "%dx%d" % (WIDTH, HEIGHT))
        scene = work + "/" + kind.replace(" ", "-").replace(",", "")
        run(relamp, "--quiet", "export", matte, "-o", scene, "--edits", work + "/edits.json")
        run("blender", "-b", "-noaudio", "--factory-startup", "--python-exit-code", "1", "--python", work + "/small.py",
            "--", scene + "/scene.py", work + "/theirs.exr")
        ours, theirs = read(work + "/ours.exr"), read(work + "/theirs.exr")
        top = np.quantile(theirs.max(-1), 0.99)
        lit = (theirs.max(-1) > 0.01 * top) & (theirs.max(-1) < 4 * top)
        off_by = np.abs(ours - theirs)[lit] / np.maximum(theirs[lit], 0.01 * top)
        block = lambda a: a.reshape(HEIGHT // 4, 4, WIDTH // 4, 4, 3).mean((1, 3))
        whole = block(np.repeat(lit[..., None], 3, -1).astype(float)).min(-1) == 1
        a, b = block(ours)[whole], block(theirs)[whole]
        print("| %s | %.4f %.4f %.4f | %.2f %% | %.2f %% |" % (
            (kind,) + tuple(ours[lit].sum(0) / theirs[lit].sum(0)) +
            (100 * np.median(off_by), 100 * np.sqrt(((a - b) ** 2).mean()) / b.mean())), flush=True)
    shutil.rmtree(work)


if __name__ == "__main__":
    main()

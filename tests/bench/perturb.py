#!/usr/bin/env python3
"""A capture made worse, to see how figures degrade.

    perturb.py CAPTURE OUT KIND[:AMOUNT] [--seed N]

Needs python3-numpy, python3-openimageio. Reads transforms.json with EXR photographs and a binary or ascii PLY as the built-in demo
has them, links what it does not change, keeps a folder `truth` when there is one. KIND:

    views:N       only N views, spread evenly over the list
    camera:PX     each camera turned about its own centre, so that its picture shifts by PX pixels in a random direction
    edges:SHARE   each vertex moved in a random direction, SHARE of the mean length of its edges (Gaussian)
    waves:SHARE   smooth waves through the mesh, SHARE of the diagonal of its box (root mean square)
    outliers:S    a share S of the pixels replaced by 0 to 30 times the picture's median, blocks of 1 to 3 pixels
    noise:SIGMA   relative Gaussian noise in every sample
    clip:LEVEL    samples end at LEVEL times the picture's 99th percentile, as a sensor's would
    gain:SIGMA    each view's exposure off by a factor exp(SIGMA N(0, 1))
"""
import argparse, json, os, pathlib, shutil
import numpy as np
import OpenImageIO as oiio


def image_files(capture):
    frames = json.load(open(capture / "transforms.json"))["frames"]
    return [f["file_path"] for f in frames]


def change_images(source, out, change):
    for k, name in enumerate(image_files(source)):
        buf = oiio.ImageBuf(str(source / name))
        pixels = np.array(buf.get_pixels(oiio.FLOAT))
        pixels[..., :3] = change(pixels[..., :3].copy(), k)
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        changed = oiio.ImageBuf(buf.spec())
        changed.set_pixels(oiio.ROI(), np.ascontiguousarray(pixels))
        if not changed.write(str(out / name)):
            raise SystemExit(f"{out / name}: {changed.geterror()}")


def change_mesh(source, out, change):
    """Rewrites the positions of a binary little-endian PLY in place; normals are dropped when there are any, they would be wrong."""
    name = json.load(open(source / "transforms.json")).get("mesh_path", "mesh.ply")
    kinds = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8",
             "float32": "<f4", "uint8": "u1", "int32": "<i4", "uint32": "<u4"}
    data = (source / name).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    vertices, faces, props, list_kinds, element = 0, 0, [], None, None
    for line in data[:end].decode().splitlines():
        w = line.split()
        if w[0] == "format" and w[1] != "binary_little_endian":
            raise SystemExit("only binary little-endian PLY")
        if w[0] == "element":
            element = w[1]
            vertices, faces = (int(w[2]), faces) if element == "vertex" else (vertices, int(w[2]))
        if w[0] == "property" and element == "vertex":
            props.append((w[2], kinds[w[1]]))
        if w[0] == "property" and element == "face" and w[1] == "list":
            list_kinds = (kinds[w[2]], kinds[w[3]])
    table = np.frombuffer(data, dtype=props, count=vertices, offset=end)
    at = end + table.nbytes
    face = np.frombuffer(data, dtype=[("n", list_kinds[0]), ("v", list_kinds[1], 3)], count=faces, offset=at)
    p = np.stack([table["x"], table["y"], table["z"]], 1).astype(np.float64)
    p = change(p, face["v"].astype(np.int64)).astype("<f4")
    with open(out / name, "wb") as f:
        f.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n"
                f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        f.write(p.tobytes())
        packed = np.empty(faces, dtype=[("n", "u1"), ("v", "<i4", 3)])
        packed["n"], packed["v"] = 3, face["v"]
        f.write(packed.tobytes())


def turned(matrix, axis, angle):
    """The camera's axes turned by `angle` radians about an axis of its own picture plane."""
    x, y = axis
    k = np.array([[0, 0, y], [0, 0, -x], [-y, x, 0]])
    rotation = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    m = np.array(matrix, float)
    m[:3, :3] = m[:3, :3] @ rotation
    return m.tolist()


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("capture", type=pathlib.Path)
    a.add_argument("out", type=pathlib.Path)
    a.add_argument("kind")
    a.add_argument("--seed", type=int, default=1)
    args = a.parse_args()
    source, out = args.capture.resolve(), args.out
    kind, _, amount = args.kind.partition(":")
    amount = float(amount or 0)
    random = np.random.default_rng(args.seed)
    if out.exists():
        shutil.rmtree(out)
    out.mkdir(parents=True)
    for entry in source.iterdir():
        os.symlink(entry, out / entry.name)

    def own(name):
        (out / name).unlink()

    description = json.load(open(source / "transforms.json"))
    if kind in ("views", "camera"):
        own("transforms.json")
        if kind == "views":
            n = len(description["frames"])
            keep = sorted({round(i * n / amount) % n for i in range(int(amount))})
            description["frames"] = [description["frames"][i] for i in keep]
        else:
            for frame in description["frames"]:
                focal = frame.get("fl_x", description.get("fl_x"))
                way = random.uniform(0, 2 * np.pi)
                frame["transform_matrix"] = turned(frame["transform_matrix"], (np.cos(way), np.sin(way)), amount / focal)
        json.dump(description, open(out / "transforms.json", "w"), indent=1)
    elif kind in ("edges", "waves"):
        own(description.get("mesh_path", "mesh.ply"))
        def move(p, f):
            if kind == "edges":
                length = np.zeros(len(p)); count = np.zeros(len(p))
                for i, j in ((0, 1), (1, 2), (2, 0)):
                    d = np.linalg.norm(p[f[:, i]] - p[f[:, j]], axis=1)
                    for k in (i, j):
                        np.add.at(length, f[:, k], d); np.add.at(count, f[:, k], 1)
                return p + random.normal(size=p.shape) * (amount * length / np.maximum(count, 1))[:, None]
            diagonal = np.linalg.norm(p.max(0) - p.min(0))
            shift = np.zeros_like(p)
            for _ in range(24):
                k = random.normal(size=3)
                k *= 2 * np.pi * random.uniform(2, 8) / (diagonal * np.linalg.norm(k))
                shift += random.normal(size=3) * np.sin(p @ k + random.uniform(0, 2 * np.pi))[:, None]
            return p + shift * (amount * diagonal / np.sqrt((shift ** 2).sum(1).mean()))
        change_mesh(source, out, move)
    elif kind in ("outliers", "noise", "clip", "gain"):
        folder = pathlib.Path(image_files(source)[0]).parts[0]
        own(folder)
        def change(pixels, _):
            if kind == "noise":
                return np.maximum(0, pixels * (1 + amount * random.normal(size=pixels.shape)))
            if kind == "gain":
                return pixels * np.exp(amount * random.normal())
            if kind == "clip":
                return np.minimum(pixels, amount * np.percentile(pixels, 99))
            h, w, _c = pixels.shape
            median = np.median(pixels)
            for _i in range(int(amount * h * w / 4)):
                y, x, s = random.integers(h), random.integers(w), random.integers(1, 4)
                pixels[y:y + s, x:x + s] = median * random.uniform(0, 30) * random.uniform(0, 1, size=3)
            return pixels
        change_images(source, out, change)
    else:
        raise SystemExit(f"{kind}: unknown")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""A capture with a mesh as photogrammetry leaves it: every triangle cut into 4^N, some faces flipped, doubled or missing, noise.

    big_mesh.py CAPTURE OUT [--times N] [--flipped 0.2] [--doubled 0.02] [--missing 0.01] [--noise 0.02] [--seed N]

Needs python3-numpy. Reads transforms.json and a binary little-endian PLY as the rendered scenes have it (x y z nx ny nz of floats first, faces of three); links the
photographs; truth/vertices.ply is cut up the same way, values between. --noise: standard deviation of the vertices, share of the mean edge of the cut mesh.
"""
import argparse, json, os, pathlib
import numpy as np

KINDS = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8"}


def read(path):
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    vertices = faces = 0
    props, element, list_kinds = [], None, ("u1", "<i4")
    for line in data[:end].decode().splitlines():
        w = line.split()
        if w[0] == "element":
            element = w[1]
            vertices, faces = (int(w[2]), faces) if element == "vertex" else (vertices, int(w[2]))
        if w[0] == "property" and element == "vertex":
            props.append((w[2], KINDS[w[1]]))
        if w[0] == "property" and element == "face":
            list_kinds = (KINDS[w[2]], KINDS[w[3]])
    table = np.frombuffer(data, props, vertices, end)
    rows = np.frombuffer(data, [("n", list_kinds[0]), ("v", list_kinds[1], 3)], faces, end + table.nbytes)
    return table, rows["v"].astype(np.int64)


def write(path, table, faces):
    names = {"<f4": "float", "<i4": "int", "|u1": "uchar", "<f8": "double"}
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(table)}\n"
    head += "".join(f"property {names.get(np.dtype(table.dtype[n]).str, 'float')} {n}\n" for n in table.dtype.names)
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = np.empty(len(faces), [("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, faces
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(head.encode() + table.tobytes() + rows.tobytes())


def cut(table, faces):
    """Each triangle into four; a new vertex lies between two, whole numbers are those of the first where both agree, else of the smaller."""
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), 1)
    pairs, index = np.unique(edges, axis=0, return_inverse=True)
    fresh = np.empty(len(pairs), table.dtype)
    for name in table.dtype.names:
        a, b = table[name][pairs[:, 0]], table[name][pairs[:, 1]]
        fresh[name] = (a + b) / 2 if table.dtype[name].kind == "f" else np.minimum(a, b)
    middle = index.reshape(-1, 3) + len(table)
    a, b, c = faces.T
    ab, bc, ca = middle.T
    return np.concatenate([table, fresh]), np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("capture", type=pathlib.Path)
parser.add_argument("out", type=pathlib.Path)
parser.add_argument("--times", type=int, default=2)
for name, value in (("flipped", .2), ("doubled", .02), ("missing", .01), ("noise", .02)):
    parser.add_argument("--" + name, type=float, default=value)
parser.add_argument("--seed", type=int, default=1)
o = parser.parse_args()
rng = np.random.default_rng(o.seed)
name = json.load(open(o.capture / "transforms.json")).get("mesh_path", "mesh.ply")
table, faces = read(o.capture / name)
truth = read(o.capture / "truth/vertices.ply")[0] if (o.capture / "truth/vertices.ply").exists() else None
whole = faces
for _ in range(o.times):
    table, next_faces = cut(table, faces)
    if truth is not None:
        truth, _ = cut(truth, faces)
    faces = next_faces
table = table.copy()
p = np.stack([table[k] for k in "xyz"], 1)
edge = np.linalg.norm(p[faces[:, 0]] - p[faces[:, 1]], axis=1).mean()
p = p + rng.normal(0, o.noise * edge, p.shape)
for i, k in enumerate("xyz"):
    table[k] = p[:, i]
if "nx" in table.dtype.names:
    n = np.stack([table["n" + k] for k in "xyz"], 1)
    n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-9)
    for i, k in enumerate("xyz"):
        table["n" + k] = n[:, i]
faces = faces[rng.random(len(faces)) >= o.missing]
flip = rng.random(len(faces)) < o.flipped
faces[flip] = faces[flip][:, ::-1]
faces = np.concatenate([faces, faces[rng.random(len(faces)) < o.doubled]])
o.out.mkdir(parents=True, exist_ok=True)
for entry in o.capture.iterdir():
    if entry.name not in (name, "truth") and not (o.out / entry.name).exists():
        os.symlink(entry.resolve(), o.out / entry.name)
write(o.out / name, table, faces)
if truth is not None:
    for entry in (o.capture / "truth").iterdir():
        (o.out / "truth").mkdir(exist_ok=True)
        if entry.name != "vertices.ply" and not (o.out / "truth" / entry.name).exists():
            os.symlink(entry.resolve(), o.out / "truth" / entry.name)
    write(o.out / "truth/vertices.ply", truth, faces)
print(f"{len(table)} vertices, {len(faces)} triangles")

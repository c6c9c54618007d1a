#!/usr/bin/env python3
"""A capture lit by a projector that no photograph shows, from a structured-light data set, and where the projector truly stands.

    graycode.py SOURCE OUT [--views left,right]

SOURCE: left/ and right/ NNNN.jpg (0000 lit, 0001 dark, then ten bits along each axis of the projector, each with its inverse), cameras.json
(OpenCV's K, R, t, distortion), mesh_lit_surfaces.ply in millimetres. OUT: a capture in metres. Printed: the projector's centre in relamp's
world (metres, Z up), by resection from the codes: points of the mesh and the projector's pixels that lit them, RANSAC and a linear fit.
Views are brought to the first one's white balance, by the median over vertices that both see. Needs numpy and OpenImageIO."""
import argparse
import json
import os
import sys

import numpy as np
import OpenImageIO as oiio


def picture(path):
    pixels = oiio.ImageBuf(path).get_pixels(oiio.FLOAT)
    return pixels[:, :, :3] if pixels.shape[2] > 2 else np.repeat(pixels[:, :, :1], 3, 2)


def linear(codes):
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def read_mesh(path):
    raw = open(path, "rb").read()
    at = raw.index(b"end_header\n") + 11
    count = {line.split()[1]: int(line.split()[2]) for line in raw[:at].decode().splitlines() if line.startswith("element")}
    vertices = np.frombuffer(raw, "<f4", count["vertex"] * 3, at).reshape(-1, 3).astype(float)
    faces = np.frombuffer(raw, np.dtype([("n", "u1"), ("i", "<i4", 3)]), count["face"], at + count["vertex"] * 12)["i"]
    return vertices, faces


def pieces(count, faces):
    """Connected piece of each vertex, by handing on the smallest number."""
    label = np.arange(count)
    while True:
        least = label[faces].min(1)
        before = label.copy()
        for k in range(3):
            np.minimum.at(label, faces[:, k], least)
        label = label[label]
        if (label == before).all():
            return label


def complete_wall(vertices, faces, step=5.0):
    """The wall behind the bust was measured only where the projector lights it: a plane through it, cut into squares, takes its place, so
    that its shadow lies on something."""
    label = pieces(len(vertices), faces)
    names, count = np.unique(label, return_counts=True)
    wall = label == names[np.argmax(count)]
    points = vertices[wall]
    for _ in range(5):
        centre = points.mean(0)
        axes = np.linalg.svd(points - centre, full_matrices=False)[2]
        off = (vertices[wall] - centre) @ axes[2]
        points = vertices[wall][np.abs(off) < 3 * max(1.48 * np.median(np.abs(off)), 0.5)]
    print(f"wall: {wall.sum()} vertices, median {np.median(np.abs(off)):.2f} mm off its plane", file=sys.stderr)
    flat = (points - centre) @ axes[:2].T
    low, high = np.percentile(flat, 0.5, axis=0), np.percentile(flat, 99.5, axis=0)
    steps = np.ceil((high - low) / step).astype(int)
    u, v = np.meshgrid(np.linspace(low[0], high[0], steps[0] + 1), np.linspace(low[1], high[1], steps[1] + 1), indexing="ij")
    sheet = centre + u.reshape(-1, 1) * axes[0] + v.reshape(-1, 1) * axes[1]
    corner = (np.arange(steps[0])[:, None] * (steps[1] + 1) + np.arange(steps[1])).reshape(-1)
    squares = np.stack([corner, corner + steps[1] + 1, corner + steps[1] + 2, corner + 1], 1)
    if np.cross(axes[0], axes[1])[2] > 0:  # towards the cameras
        squares = squares[:, ::-1]
    kept = np.where(~wall)[0]
    renumber = np.full(len(vertices), -1)
    renumber[kept] = np.arange(len(kept))
    rest = renumber[faces[~wall[faces].any(1)]]
    more = np.vstack([squares[:, [0, 1, 2]], squares[:, [0, 2, 3]]]) + len(kept)
    return np.vstack([vertices[kept], sheet]), np.vstack([rest, more])


def project(view, points):
    camera = points @ np.array(view["R"]).T + np.array(view["t"])
    x, y = (camera[:, :2] / camera[:, 2:]).T
    k1, k2, p1, p2, k3 = view["distortion_k1k2p1p2k3"]
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    bent = np.stack([x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y], 1)
    k = np.array(view["K"])
    return bent @ k[:2, :2].T + k[:2, 2], camera[:, 2]


def seen(view, vertices):
    """Pixels of the vertices that no other hides (splats four pixels wide), and which they are."""
    pixels, depth = project(view, vertices)
    cell = np.floor(pixels / 4).astype(int)
    height, width = view["height"] // 4, view["width"] // 4
    inside = (cell >= 0).all(1) & (cell[:, 0] < width) & (cell[:, 1] < height)
    nearest = np.full((height, width), 1e9)
    np.minimum.at(nearest, (cell[inside, 1], cell[inside, 0]), depth[inside])
    visible = inside.copy()
    visible[inside] = depth[inside] < nearest[cell[inside, 1], cell[inside, 0]] + 15
    return np.where(visible)[0], np.round(pixels[visible]).astype(int).clip(0, [view["width"] - 1, view["height"] - 1])


def resection(points, pixels):
    """Linear camera from pairs: its centre, and the pixels' errors at `all_points`."""
    centre, size, middle, spread = points.mean(0), points.std(), pixels.mean(0), pixels.std()
    q, r = np.hstack([(points - centre) / size, np.ones((len(points), 1))]), (pixels - middle) / spread
    zero = np.zeros((len(q), 4))
    system = np.vstack([np.hstack([q, zero, -r[:, :1] * q]), np.hstack([zero, q, -r[:, 1:] * q])])
    m = np.linalg.svd(system, full_matrices=False)[2][-1].reshape(3, 4)

    def errors(p, u):
        e = np.hstack([(p - centre) / size, np.ones((len(p), 1))]) @ m.T
        return np.linalg.norm(e[:, :2] / e[:, 2:] * spread + middle - u, axis=1)

    return -np.linalg.solve(m[:, :3], m[:, 3]) * size + centre, errors


def projector_centre(source, view, vertices):
    index, at = seen(view, vertices)

    def code(first):
        value, bit, least = 0, False, 1.0
        for b in range(10):
            on, off = (picture(f"{source}/{view['name']}/{first + 2 * b + k:04d}.jpg").mean(2)[at[:, 1], at[:, 0]] for k in (0, 1))
            bit = bit ^ (on > off)
            value = 2 * value + bit
            if b < 8:
                least = np.minimum(least, np.abs(on - off))
        return value, least

    (u, sure_u), (v, sure_v) = code(2), code(22)
    good = np.minimum(sure_u, sure_v) > 0.03
    points, pixels = vertices[index[good]], np.stack([u[good] + 0.5, v[good] + 0.5], 1)
    random = np.random.default_rng(1)
    best = np.zeros(len(points), bool)
    for _ in range(600):
        some = random.choice(len(points), 12, replace=False)
        fits = resection(points[some], pixels[some])[1](points, pixels) < 8
        if fits.sum() > best.sum():
            best = fits
    for _ in range(4):
        centre, errors = resection(points[best], pixels[best])
        off = errors(points, pixels)
        best = off < 3
    inside = np.where(best)[0]
    spread = np.std([resection(points[s], pixels[s])[0] for s in (random.choice(inside, 2000) for _ in range(30))], axis=0)
    return centre, spread, np.median(off[best]), len(inside)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("source")
    arguments.add_argument("out")
    arguments.add_argument("--views", default="left,right")
    a = arguments.parse_args()
    views = {v["name"]: v for v in json.load(open(f"{a.source}/cameras.json"))["views"]}
    vertices, faces = read_mesh(f"{a.source}/mesh_lit_surfaces.ply")
    os.makedirs(f"{a.out}/images", exist_ok=True)
    measured = vertices
    vertices, faces = complete_wall(vertices, faces)
    metres = vertices / 1000
    with open(f"{a.out}/mesh.ply", "wb") as mesh:
        mesh.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(metres)}\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        mesh.write(metres.astype("<f4").tobytes())
        rows = np.zeros(len(faces), np.dtype([("n", "u1"), ("i", "<i4", 3)]))
        rows["n"], rows["i"] = 3, faces
        mesh.write(rows.tobytes())
    frames, reference = [], None
    for name in a.views.split(","):
        view = views[name]
        image = linear(picture(f"{a.source}/{name}/0000.jpg"))
        index, at = seen(view, vertices)
        colour = np.full((len(vertices), 3), np.nan)
        colour[index] = image[at[:, 1], at[:, 0]]
        if reference is None:
            reference = colour
        else:
            both = np.isfinite(reference).all(1) & np.isfinite(colour).all(1) & (reference.min(1) > 0.01) & (colour.min(1) > 0.01)
            gain = np.median(reference[both] / colour[both], axis=0)
            print(f"{name}: brought to the first view by {gain.round(3)}", file=sys.stderr)
            image = image * gain
        out = oiio.ImageBuf(oiio.ImageSpec(image.shape[1], image.shape[0], 3, oiio.HALF))
        out.set_pixels(oiio.ROI(0, image.shape[1], 0, image.shape[0]), np.ascontiguousarray(image, dtype=np.float32))
        out.write(f"{a.out}/images/{name}.exr")
        # What lies beside the mesh is the unmeasured rest of the room, no surroundings at a distance.
        covered = np.zeros((view["height"] // 4, view["width"] // 4), bool)
        cell = np.floor(project(view, np.vstack([vertices, vertices[faces].mean(1)]))[0] / 4).astype(int)
        cell = cell[(cell >= 0).all(1) & (cell[:, 0] < covered.shape[1]) & (cell[:, 1] < covered.shape[0])]
        covered[cell[:, 1], cell[:, 0]] = True
        for _ in range(2):
            grown = np.pad(covered, 1)
            covered = grown[1:-1, 1:-1] | grown[:-2, 1:-1] | grown[2:, 1:-1] | grown[1:-1, :-2] | grown[1:-1, 2:]
        mask = np.kron(covered, np.ones((4, 4)))[:, :, None].astype(np.float32)
        out = oiio.ImageBuf(oiio.ImageSpec(mask.shape[1], mask.shape[0], 1, oiio.UINT8))
        out.set_pixels(oiio.ROI(0, mask.shape[1], 0, mask.shape[0]), np.ascontiguousarray(mask))
        os.makedirs(f"{a.out}/masks", exist_ok=True)
        out.write(f"{a.out}/masks/{name}.exr.png")
        r, t = np.array(view["R"]), np.array(view["t"])
        pose = np.eye(4)
        pose[:3, :3] = r.T * [1, -1, -1]
        pose[:3, 3] = -r.T @ t / 1000
        k, (k1, k2, p1, p2, k3) = view["K"], view["distortion_k1k2p1p2k3"]
        frames.append({"file_path": f"images/{name}.exr", "camera_model": "FULL_OPENCV", "w": view["width"], "h": view["height"], "fl_x": k[0][0], "fl_y": k[1][1],
                       "cx": k[0][2] + 0.5, "cy": k[1][2] + 0.5, "k1": k1, "k2": k2, "p1": p1, "p2": p2, "k3": k3, "transform_matrix": pose.tolist()})
    json.dump({"up": "y", "mesh_path": "mesh.ply", "frames": frames}, open(f"{a.out}/transforms.json", "w"), indent=1)
    centre, spread, error, count = projector_centre(a.source, views["left"], measured)
    turned = np.array([centre[0], -centre[2], centre[1]]) / 1000
    print(f"projector at {turned.round(4).tolist()} m, +- {(spread[[0, 2, 1]] / 1000).round(4).tolist()} ({count} points, median error {error:.2f} projector pixels)")


if __name__ == "__main__":
    main()

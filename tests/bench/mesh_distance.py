#!/usr/bin/env python3
"""How far two meshes lie from each other: points of each against the surface of the other.

    mesh_distance.py OWN.ply REFERENCE.ply [--own-scale 1000] [--samples 4000]

Binary PLY files with x, y, z and triangles. Printed in the reference's units: median and 95 % of the distances of OWN's vertices that lie within
4 units of REFERENCE, how many do, and how much of REFERENCE lies within 1 and 2 units of OWN. Random vertices, one seed. Needs numpy."""
import argparse

import numpy as np

CELL = 4.0


def read(path, scale):
    raw = open(path, "rb").read()
    at = raw.index(b"end_header\n") + 11
    head = [line.split() for line in raw[:at].decode().splitlines()]
    count = {line[1]: int(line[2]) for line in head if line[0] == "element"}
    kinds = {"float": "<f4", "double": "<f8", "int": "<i4", "uchar": "u1"}
    row = np.dtype([(line[2], kinds[line[1]]) for line in head if line[0] == "property" and line[1] != "list"])
    vertices = np.frombuffer(raw, row, count["vertex"], at)
    faces = np.frombuffer(raw, np.dtype([("n", "u1"), ("i", "<i4", 3)]), count["face"], at + count["vertex"] * row.itemsize)["i"]
    return np.stack([vertices[axis] for axis in "xyz"], 1).astype(float) * scale, faces


def to_triangles(point, corners):
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, ac, ap = b - a, c - a, point - a
    normal = np.cross(ab, ac)
    square = (normal * normal).sum(1) + 1e-30
    w2, w1 = (np.cross(ab, ap) * normal).sum(1) / square, (np.cross(ap, ac) * normal).sum(1) / square
    inside = (w1 >= 0) & (w2 >= 0) & (w1 + w2 <= 1)
    distance = np.where(inside, np.abs((ap * normal).sum(1)) / np.sqrt(square), np.inf)
    for start, edge in ((a, ab), (a, ac), (b, c - b)):
        t = np.clip(((point - start) * edge).sum(1) / ((edge * edge).sum(1) + 1e-30), 0, 1)
        distance = np.minimum(distance, np.linalg.norm(point - start - t[:, None] * edge, axis=1))
    return distance.min()


class Surface:
    def __init__(self, vertices, faces):
        self.corners, self.cells = vertices[faces], {}
        low, high = np.floor(self.corners.min(1) / CELL).astype(int), np.floor(self.corners.max(1) / CELL).astype(int)
        for index, (a, b) in enumerate(zip(low, high)):
            for cell in np.ndindex(*(np.minimum(b - a, 8) + 1)):
                self.cells.setdefault(tuple(a + cell), []).append(index)

    def distance(self, point):
        middle = np.floor(point / CELL).astype(int)
        near = {t for step in np.ndindex(3, 3, 3) for t in self.cells.get(tuple(middle + step - 1), ())}
        return to_triangles(point, self.corners[sorted(near)]) if near else np.inf


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("own")
    arguments.add_argument("reference")
    arguments.add_argument("--own-scale", type=float, default=1000)
    arguments.add_argument("--samples", type=int, default=4000)
    a = arguments.parse_args()
    own, reference = read(a.own, a.own_scale), read(a.reference, 1)
    random = np.random.default_rng(1)

    def distances(mesh, surface):
        used = np.unique(mesh[1])
        some = random.choice(used, min(a.samples, len(used)), replace=False)
        return np.array([surface.distance(mesh[0][v]) for v in some])

    there, back = distances(own, Surface(*reference)), distances(reference, Surface(*own))
    near = there[there < CELL]
    print(f"vertices to the reference: median {np.median(near):.3f}, 95 % {np.percentile(near, 95):.3f}; {100 * len(near) / len(there):.1f} % within {CELL:g}")
    print(f"the reference is covered within 1: {100 * (back < 1).mean():.1f} %, within 2: {100 * (back < 2).mean():.1f} %")


if __name__ == "__main__":
    main()

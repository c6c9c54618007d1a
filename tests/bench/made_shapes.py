"""Meshes of the scenes that made_scenes.py renders: (vertices, triangles) as arrays, metres, Z up, faces outwards."""
import math

import numpy as np


def join(parts):
    vertices, triangles, count = [], [], 0
    for v, f in parts:
        vertices.append(v)
        triangles.append(np.asarray(f) + count)
        count += len(v)
    return np.concatenate(vertices), np.concatenate(triangles)


def grid(corner, u, v, nu, nv):
    """A sheet of nu x nv squares, towards u x v."""
    corner, u, v = (np.asarray(a, float) for a in (corner, u, v))
    s, t = np.meshgrid(np.linspace(0, 1, nu + 1), np.linspace(0, 1, nv + 1), indexing="ij")
    i = (np.arange(nu)[:, None] * (nv + 1) + np.arange(nv)[None]).ravel()
    triangles = np.concatenate([np.stack([i, i + nv + 1, i + nv + 2], 1), np.stack([i, i + nv + 2, i + 1], 1)])
    return (corner + s[..., None] * u + t[..., None] * v).reshape(-1, 3), triangles


def box(low, high, step):
    """Faces share no vertices, so that edges stay sharp."""
    low, high = np.array(low, float), np.array(high, float)
    ex, ey, ez = np.diag(high - low)
    nx, ny, nz = (max(1, int(round(side / step))) for side in high - low)
    return join([grid(low, ey, ex, ny, nx), grid(low + ez, ex, ey, nx, ny), grid(low, ex, ez, nx, nz),
                 grid(low + ey, ez, ex, nz, nx), grid(low, ez, ey, nz, ny), grid(low + ex, ey, ez, ny, nz)])


def lathe(profile, around, centre=(0, 0, 0)):
    """A profile of (radius, height), upwards, turned about Z."""
    p, angle = np.asarray(profile, float), np.arange(around) * 2 * np.pi / around
    z = np.broadcast_to(p[:, None, 1], (len(p), around))
    v = np.stack([p[:, None, 0] * np.cos(angle), p[:, None, 0] * np.sin(angle), z], -1).reshape(-1, 3)
    triangles = []
    for i in range(len(p) - 1):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            triangles += [[a, b, b + around], [a, b + around, a + around]]
    return v + np.asarray(centre), np.array(triangles)


def sphere(centre, radius, around=40):
    t = np.linspace(-np.pi / 2 + 1e-3, np.pi / 2 - 1e-3, around // 2 + 1)
    return lathe(np.stack([radius * np.cos(t), radius * np.sin(t)], 1), around, centre)


def cylinder(radius, low, high, rings, around, centre=(0, 0, 0)):
    return lathe([(radius, z) for z in np.linspace(low, high, rings)], around, centre)


def read(path, height, at, turn=0):
    """An OBJ or OFF file with Y up, set down at a place, turned by degrees."""
    vertices, triangles = [], []
    if path.endswith(".off"):
        words = open(path).read().split()
        nv, nf = int(words[1]), int(words[2])
        vertices = np.array(words[4:4 + 3 * nv], float).reshape(-1, 3)
        triangles = np.array(words[4 + 3 * nv:4 + 3 * nv + 4 * nf], int).reshape(-1, 4)[:, 1:]
    else:
        for line in open(path):
            if line.startswith("v "):
                vertices.append([float(x) for x in line.split()[1:4]])
            elif line.startswith("f "):
                corners = [int(x.split("/")[0]) - 1 for x in line.split()[1:]]
                triangles += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
        vertices, triangles = np.array(vertices), np.array(triangles)
    v = np.stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]], 1)
    v -= (v.min(0) + v.max(0)) / 2
    v *= height / np.ptp(v[:, 2])
    v[:, 2] -= v[:, 2].min()
    return turned(v, turn) + np.asarray(at), triangles


def turned(v, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return v @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


# Albedo by place.
def bands(a, b, axis, period):
    return lambda v: np.where((np.floor(v[:, axis] / period) % 2 == 0)[:, None], np.array(a), np.array(b))


def checks(a, b, axes, period):
    i, j = axes
    even = lambda v: (np.floor(v[:, i] / period) + np.floor(v[:, j] / period)) % 2 == 0
    return lambda v: np.where(even(v)[:, None], np.array(a), np.array(b))


def spots(a, b, size, rng):
    waves, phases = rng.normal(size=(12, 3)) / size, rng.uniform(0, 6.28, 12)
    return lambda v: np.where((np.sin(v @ waves.T + phases).sum(1) > 0.8)[:, None], np.array(a), np.array(b))

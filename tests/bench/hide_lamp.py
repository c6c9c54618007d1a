#!/usr/bin/env python3
"""A capture with known truth, from which the lamps have been taken: their faces are gone from the mesh, their pixels masked.

    hide_lamp.py CAPTURE OUT

CAPTURE: with truth/vertices.ply (emission, emitter_id per vertex) and pinhole cameras. Printed: the lamps' true centres, metres.
Needs numpy and OpenImageIO."""
import json
import os
import shutil
import sys

import numpy as np
import OpenImageIO as oiio

TYPES = {"float": "<f4", "double": "<f8", "int": "<i4", "uint": "<u4", "uchar": "u1"}


def read_ply(path):
    raw = open(path, "rb").read()
    at = raw.index(b"end_header\n") + 11
    count, fields, element, faces = {}, {}, None, None
    for line in raw[:at].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            element = words[1]
            count[element], fields[element] = int(words[2]), []
        elif words[0] == "property":
            fields[element].append((words[-1], TYPES[words[-2]]) if words[1] != "list" else (words[-1], words[2], words[3]))
    kind = np.dtype(fields["vertex"])
    vertices = np.frombuffer(raw, kind, count["vertex"], at)
    if "face" in count:
        faces = np.frombuffer(raw, np.dtype([("n", "u1"), ("i", "<i4", 3)]), count["face"], at + kind.itemsize * count["vertex"])["i"]
    return vertices, faces


def main():
    source, out = sys.argv[1:3]
    document = json.load(open(f"{source}/transforms.json"))
    mesh_name = document.get("mesh_path", "mesh.ply")
    vertices, faces = read_ply(f"{source}/{mesh_name}")
    truth, _ = read_ply(f"{source}/truth/vertices.ply")
    place = np.stack([vertices[c] for c in "xyz"], 1).astype(float)
    shines = np.maximum.reduce([truth["emission_r"], truth["emission_g"], truth["emission_b"]]) > 0
    lamps = shines[faces].all(1)
    for lamp in np.unique(truth["emitter_id"][shines]):
        mine = faces[lamps & (truth["emitter_id"][faces[:, 0]] == lamp)]
        area = np.linalg.norm(np.cross(place[mine[:, 1]] - place[mine[:, 0]], place[mine[:, 2]] - place[mine[:, 0]]), axis=1)
        print(f"lamp {lamp} at {((place[mine].mean(1) * area[:, None]).sum(0) / area.sum()).round(4).tolist()} m")
    # Corners stay, so that their numbers stay; a corner of no face is no surface.
    os.makedirs(f"{out}/masks", exist_ok=True)
    with open(f"{out}/{mesh_name}", "wb") as file:
        kept = faces[~lamps]
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(place)}\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face {len(kept)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        file.write(place.astype("<f4").tobytes())
        rows = np.zeros(len(kept), np.dtype([("n", "u1"), ("i", "<i4", 3)]))
        rows["n"], rows["i"] = 3, kept
        file.write(rows.tobytes())
    random = np.random.default_rng(1)
    share = random.random((400, 1, 2))
    share = np.where(share.sum(2, keepdims=True) > 1, 1 - share, share)
    corners = place[faces[lamps]]
    points = (corners[:, 0] + share[..., :1] * (corners[:, 1] - corners[:, 0]) + share[..., 1:] * (corners[:, 2] - corners[:, 0])).reshape(-1, 3)
    for frame in document["frames"]:
        value = {**document, **frame}
        pose = np.linalg.inv(np.array(frame["transform_matrix"]))
        camera = points @ pose[:3, :3].T + pose[:3, 3]
        camera = camera[camera[:, 2] < -1e-6]
        focal_x = value.get("fl_x") or 0.5 * value["w"] / np.tan(0.5 * value["camera_angle_x"])
        pixel = np.floor(np.stack([value.get("cx", value["w"] / 2) - focal_x * camera[:, 0] / camera[:, 2],
                                   value.get("cy", value["h"] / 2) + value.get("fl_y", focal_x) * camera[:, 1] / camera[:, 2]], 1)).astype(int)
        mask = np.ones((value["h"], value["w"]), np.float32)
        for dx in range(-2, 3):
            for dy in range(-2, 3):
                p = pixel + [dx, dy]
                p = p[(p >= 0).all(1) & (p[:, 0] < value["w"]) & (p[:, 1] < value["h"])]
                mask[p[:, 1], p[:, 0]] = 0
        name = frame["file_path"]
        os.makedirs(os.path.dirname(f"{out}/{name}"), exist_ok=True)
        shutil.copyfile(f"{source}/{name}", f"{out}/{name}")
        picture = oiio.ImageBuf(oiio.ImageSpec(value["w"], value["h"], 1, oiio.UINT8))
        picture.set_pixels(oiio.ROI(0, value["w"], 0, value["h"]), mask[:, :, None])
        picture.write(f"{out}/masks/{os.path.basename(name)}.png")
    shutil.copyfile(f"{source}/transforms.json", f"{out}/transforms.json")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Reprojection error of COLMAP models: relamp beside COLMAP's own.

    compare_colmap.py --relamp build/relamp

Needs `colmap` (Debian: colmap) and python3-numpy. For each lens model a small world of points is written, seen by cameras on a ring through
a lens of that kind with half a pixel of noise; `colmap bundle_adjuster` fits it, in binary and as text; `colmap model_analyzer` states the
error, `relamp check` works it out. Exits 1 where they differ by more than what model_analyzer prints.
"""
import argparse, json, math, os, pathlib, re, subprocess, sys, tempfile
import numpy as np

os.environ["QT_QPA_PLATFORM"] = "offscreen"
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--relamp", default="build/relamp")
relamp = os.path.abspath(parser.parse_args().relamp)

# Parameters to start the fit from: focal lengths, centre, distortion.
lenses = {
    "SIMPLE_PINHOLE": [400, 160, 120], "PINHOLE": [400, 405, 160, 120], "SIMPLE_RADIAL": [400, 160, 120, -0.05], "RADIAL": [400, 160, 120, -0.05, 0.02],
    "OPENCV": [400, 405, 160, 120, -0.05, 0.02, 0.001, -0.001], "OPENCV_FISHEYE": [400, 405, 160, 120, 0.01, 0.005, 0, 0],
    "FULL_OPENCV": [400, 405, 160, 120, -0.05, 0.02, 0.001, -0.001, 0, 0.01, 0, 0], "FOV": [400, 405, 160, 120, 0.4],
    "SIMPLE_RADIAL_FISHEYE": [400, 160, 120, 0.01], "RADIAL_FISHEYE": [400, 160, 120, 0.01, 0.005],
    "THIN_PRISM_FISHEYE": [400, 405, 160, 120, 0.01, 0.005, 0.001, -0.001, 0, 0, 0.001, 0.001],
}


def quaternion(R):
    w = math.sqrt(max(0, 1 + R[0, 0] + R[1, 1] + R[2, 2])) / 2
    return [w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)]


def world(lens, parameters, folder):
    """A model as text: 8 cameras on an arc (a full ring would need quaternions with w = 0), 300 points in a cube."""
    random = np.random.default_rng(7)
    points = random.uniform(-0.6, 0.6, (300, 3))
    one = lens in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE")
    fx = parameters[0]
    fy = fx if one else parameters[1]
    cx, cy = parameters[1 if one else 2:][:2]
    folder.mkdir(parents=True)
    (folder / "cameras.txt").write_text(f"# a comment\r\n9 {lens} 320 240 " + " ".join(map(repr, map(float, parameters))) + "\r\n")
    tracks, images = {}, []
    for i in range(8):
        a = -1.2 + 0.34 * i
        position = np.array([3 * math.sin(a), -0.4, -3 * math.cos(a)])
        ahead = -position / np.linalg.norm(position)
        right = np.cross([0, 1, 0], ahead)
        right /= np.linalg.norm(right)
        R = np.array([right, np.cross(ahead, right), ahead])
        t = -R @ position
        seen = []
        for p, point in enumerate(points):
            x, y, z = R @ point + t
            if "FISHEYE" in lens:
                r = math.hypot(x, y)
                u, v = np.array([x, y]) / r * math.atan2(r, z)
            else:
                u, v = x / z, y / z
            pixel = np.array([fx * u + cx, fy * v + cy]) + random.normal(0, 0.5, 2)
            tracks.setdefault(p + 11, []).append((30 - 3 * i, len(seen)))
            seen.append(f"{pixel[0]!r} {pixel[1]!r} {p + 11}")
        # Ids fall and have gaps; every second image has an observation without a point.
        images.append(f"{30 - 3 * i} " + " ".join(repr(float(v)) for v in [*quaternion(R), *t]) + f" 9 view {i}.png".replace("view ", "view") + "\r\n" + " ".join(seen) + (" 5 5 -1" if i % 2 else "") + "\r\n")
    (folder / "images.txt").write_text("".join(images))
    (folder / "points3D.txt").write_text("".join(f"{k} " + " ".join(repr(float(v)) for v in points[k - 11]) + " 1 2 3 0 " + " ".join(f"{i} {n}" for i, n in tracks[k]) + "\r\n" for k in tracks))


failed = False
print(f"{'lens':24} COLMAP      relamp bin    relamp txt    difference")
for lens, parameters in lenses.items():
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        world(lens, parameters, work / "start")
        for name in ("fitted", "binary", "text", "images"):
            (work / name).mkdir()
        subprocess.run(["colmap", "bundle_adjuster", "--input_path", work / "start", "--output_path", work / "fitted"], check=True, stdout=subprocess.DEVNULL)
        # The adjuster of 3.8 leaves the errors in the points as they were; the filter works them out.
        subprocess.run(["colmap", "point_filtering", "--input_path", work / "fitted", "--output_path", work / "binary", "--max_reproj_error", "20"], check=True, stdout=subprocess.DEVNULL)
        subprocess.run(["colmap", "model_converter", "--input_path", work / "binary", "--output_path", work / "text", "--output_type", "TXT"], check=True, stdout=subprocess.DEVNULL)
        stated = subprocess.run(["colmap", "model_analyzer", "--path", work / "binary"], check=True, capture_output=True, text=True)
        stated = float(re.search(r"Mean reprojection error: ([0-9.]+)px", stated.stdout + stated.stderr).group(1))
        (work / "mesh.obj").write_text("v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n")
        grey = b"P5 320 240 255\n" + b"\x80" * (320 * 240)
        for i in range(8):
            (work / "images" / f"view{i}.png").write_bytes(grey)  # read by content
        found = []
        for kind in ("binary", "text"):
            out = subprocess.run([relamp, "--quiet", "check", work, "--colmap", kind, "--json"], check=True, capture_output=True, text=True)
            found.append(json.loads(out.stdout)["reconstruction"]["reprojection_error"])
        difference = max(abs(f - stated) for f in found)
        failed |= not difference < 1e-6
        print(f"{lens:24} {stated:.6f}    {found[0]:.9f}   {found[1]:.9f}   {difference:.1e}")
sys.exit(failed)

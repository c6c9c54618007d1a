#!/usr/bin/env python3
"""A capture through every door: its cameras written in the files of other programs and read again.

    doors.py CAPTURE --doors build/tests/bench/doors [--lens]

CAPTURE has a transforms.json with pinholes; --lens gives them two radial coefficients, and leaves out what has no lens. COLMAP (Debian: colmap) writes its binary model, Bundler's and VisualSFM's files from the same
cameras; the other files are written here by their published formulas. `doors` projects the mesh's vertices through both and states how many
pixels they lie apart. Needs python3-numpy.
"""
import argparse, json, math, os, pathlib, shutil, subprocess, sys, tempfile
import numpy as np

os.environ["QT_QPA_PLATFORM"] = "offscreen"
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("capture", type=pathlib.Path)
parser.add_argument("--doors", default="build/tests/bench/doors")
parser.add_argument("--lens", action="store_true")
arguments = parser.parse_args()
source = arguments.capture.resolve()
file = json.loads((source / "transforms.json").read_text())
lens = [-0.08, 0.02] if arguments.lens else []
if lens:
    # A capture of its own: the same with a lens.
    bent = pathlib.Path(tempfile.mkdtemp()) / "bent"
    bent.mkdir()
    for entry in source.iterdir():
        if entry.name != "transforms.json":
            (bent / entry.name).symlink_to(entry)
    file.update(camera_model="RADIAL", k1=lens[0], k2=lens[1])
    (bent / "transforms.json").write_text(json.dumps(file))
    source = bent


class Shot:
    """Camera axes in the world (image axes: right, down, ahead), and its lens."""

    def __init__(self, frame):
        get = lambda key, otherwise=None: frame.get(key, file.get(key, otherwise))
        m = np.array(frame["transform_matrix"], float)
        self.R = np.stack([m[:3, 0], -m[:3, 1], -m[:3, 2]])  # rows
        self.p = m[:3, 3]
        self.w, self.h, self.fx = int(get("w")), int(get("h")), float(get("fl_x"))
        self.fy, self.cx, self.cy = float(get("fl_y", self.fx)), float(get("cx", self.w / 2)), float(get("cy", self.h / 2))
        self.path = frame["file_path"]
        self.name = pathlib.Path(self.path).name
        self.stem = pathlib.Path(self.path).stem

    def quaternion(self):
        R, q = self.R, np.zeros(4)
        k = np.argmax([np.trace(R), R[0, 0], R[1, 1], R[2, 2]])
        if k == 0:
            q[:] = 1 + np.trace(R), R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
        else:
            i = k - 1
            j, l = (i + 1) % 3, (i + 2) % 3
            q[0], q[1 + i] = R[l, j] - R[j, l], 1 + R[i, i] - R[j, j] - R[l, l]
            q[1 + j], q[1 + l] = R[i, j] + R[j, i], R[i, l] + R[l, i]
        return q / np.linalg.norm(q)


shots = [Shot(frame) for frame in file["frames"]]
first = shots[0]
print(f"{len(shots)} views of {first.w} x {first.h}, focal length {first.fx:g} {first.fy:g}, centre {first.cx:g} {first.cy:g}")
work = pathlib.Path(tempfile.mkdtemp())
numbers = lambda values: " ".join(f"{v:.17g}" for v in np.ravel(values))


def room(name):
    """A capture folder with photographs and mesh, and no cameras yet."""
    folder = work / name
    (folder / "images").mkdir(parents=True)
    for shot in shots:
        (folder / "images" / shot.name).symlink_to(source / shot.path)
    mesh = source / file.get("mesh_path", "mesh.ply")
    (folder / ("mesh" + mesh.suffix)).symlink_to(mesh)
    return folder


def colmap(folder, model="PINHOLE"):
    sparse = folder / "sparse/0"
    sparse.mkdir(parents=True)
    focal = [first.fx, first.fy] if model == "PINHOLE" else [first.fx]
    more = lens
    (sparse / "cameras.txt").write_text(f"1 {model} {first.w} {first.h} {numbers(focal + [first.cx, first.cy] + more)}\n")
    (sparse / "images.txt").write_text("".join(f"{i + 1} {numbers(s.quaternion())} {numbers(-s.R @ s.p)} 1 {s.name}\n\n" for i, s in enumerate(shots)))
    (sparse / "points3D.txt").write_text("")
    return sparse


def converted(name, kind, output, model):
    """What COLMAP's model_converter makes of the text model."""
    plain, folder = room(name + "-text"), room(name)
    model = colmap(plain, model)
    (folder / output).parent.mkdir(parents=True, exist_ok=True)
    if kind == "BIN":
        (folder / output).mkdir()
    run = subprocess.run(["colmap", "model_converter", "--input_path", model, "--output_path", folder / output, "--output_type", kind], capture_output=True, text=True)
    if run.returncode:
        sys.exit(run.stdout + run.stderr)
    return folder


def metashape():
    folder = room("metashape")
    cameras = "".join(f'<camera id="{i}" sensor_id="0" label="{s.stem}"><transform>{numbers(np.vstack([np.column_stack([s.R.T, s.p]), [0, 0, 0, 1]]))}</transform></camera>\n'
                      for i, s in enumerate(shots))
    (folder / "cameras.xml").write_text(
        f'<?xml version="1.0" encoding="UTF-8"?>\n<document version="2.0.0"><chunk label="1" enabled="true"><sensors><sensor id="0" type="frame">'
        f'<calibration type="frame" class="adjusted"><resolution width="{first.w}" height="{first.h}"/><f>{first.fy:.17g}</f><cx>{first.cx - first.w / 2:.17g}</cx>'
        f'<cy>{first.cy - first.h / 2:.17g}</cy><b1>{first.fx - first.fy:.17g}</b1>{"".join(f"<k{i + 1}>{k}</k{i + 1}>" for i, k in enumerate(lens))}</calibration></sensor></sensors><cameras>{cameras}</cameras></chunk></document>\n')
    return folder


def meshroom():
    folder = room("meshroom")
    ids = [str(1000 + i) for i in range(len(shots))]
    text = lambda values: [f"{v:.17g}" for v in np.ravel(values)]
    (folder / "cameras.sfm").write_text(json.dumps({
        "version": ["1", "0", "0"],
        "views": [{"viewId": k, "poseId": k, "intrinsicId": "1", "path": "/elsewhere/" + s.name} for k, s in zip(ids, shots)],
        "intrinsics": [{"intrinsicId": "1", "width": str(first.w), "height": str(first.h), "type": "radial3" if lens else "pinhole", "pxFocalLength": f"{first.fx:.17g}",
                        "principalPoint": text([first.cx - 0.5, first.cy - 0.5]), "distortionParams": text(lens + [0]) if lens else ""}],
        "poses": [{"poseId": k, "pose": {"transform": {"rotation": text(s.R.T), "center": text(s.p)}}} for k, s in zip(ids, shots)]}))
    return folder


def reality_capture():
    folder = room("reality-capture")
    rows = ["#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2"]
    long = max(first.w, first.h)
    for s in shots:
        right, up, back = s.R[0], -s.R[1], -s.R[2]
        angles = [math.degrees(a) for a in (math.atan2(up[0], up[1]), math.asin(up[2]), math.atan2(-right[2], back[2]))]
        rows.append(",".join([s.name] + [f"{v:.17g}" for v in [*s.p, *angles, s.fx * 36 / long, (s.cx - s.w / 2) / long, (s.cy - s.h / 2) / long] + (lens + [0] * 6)[:6]]))
    (folder / "cameras.csv").write_text("\n".join(rows) + "\n")
    return folder


def open_mvg():
    folder = room("open-mvg")
    (folder / "sfm_data.json").write_text(json.dumps({
        "sfm_data_version": "0.3", "root_path": "/elsewhere",
        "views": [{"key": i, "value": {"ptr_wrapper": {"id": i, "data": {"filename": s.name, "width": s.w, "height": s.h, "id_view": i, "id_intrinsic": 0, "id_pose": i}}}}
                  for i, s in enumerate(shots)],
        "intrinsics": [{"key": 0, "value": {"polymorphic_name": "pinhole_radial_k3" if lens else "pinhole", "ptr_wrapper": {"id": 1, "data": {
            "width": first.w, "height": first.h, "focal_length": first.fx, "principal_point": [first.cx - 0.5, first.cy - 0.5]} | ({"disto_k3": lens + [0]} if lens else {})}}}],
        "extrinsics": [{"key": i, "value": {"rotation": s.R.tolist(), "center": s.p.tolist()}} for i, s in enumerate(shots)]}))
    return folder


def llff():
    folder = room("llff")
    rows = [np.concatenate([np.column_stack([s.R[1], s.R[0], -s.R[2], s.p, [s.h, s.w, s.fx]]).ravel(), [0.1, 10]]) for s in sorted(shots, key=lambda s: s.name)]
    np.save(folder / "poses_bounds.npy", np.array(rows))
    return folder


def mesh_with_y_up(folder):
    """The capture's mesh turned from Z up to Y up, as phones keep it, in text that loses no bit."""
    bytes_ = (source / file.get("mesh_path", "mesh.ply")).read_bytes()
    head, body = bytes_.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    if "format binary_little_endian 1.0" not in lines:
        sys.exit("the mesh of CAPTURE has to be a binary PLY")
    count = {line.split()[1]: int(line.split()[2]) for line in lines if line.startswith("element")}
    at = lines.index(f"element vertex {count['vertex']}")
    names = []
    for line in lines[at + 1:]:
        if not line.startswith("property float"):
            break
        names.append(line.split()[2])
    vertices = np.frombuffer(body, "<f4", count["vertex"] * len(names)).reshape(-1, len(names))[:, :3]
    faces = np.frombuffer(body, [("n", "u1"), ("v", "<i4", 3)], count["face"], vertices.shape[0] * 4 * len(names))["v"]
    turned = vertices @ np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    (folder / "mesh.obj").write_text("".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in turned) +
                                     "".join(f"f {a} {b} {c}\n" for a, b, c in faces + 1))


def phone_pose(shot):
    """worldFromCamera with OpenGL's axes, the world with Y up."""
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    return np.vstack([np.column_stack([turn @ np.stack([shot.R[0], -shot.R[1], -shot.R[2]], 1), turn @ shot.p]), [0, 0, 0, 1]])


def grey_jpeg(width, height):
    """A photograph of nothing: every block of a grey JPEG is its two shortest codes."""
    def part(kind, data):
        return bytes([0xff, kind]) + (len(data) + 2).to_bytes(2, "big") + data

    blocks = -(-width // 8) * -(-height // 8)
    size = height.to_bytes(2, "big") + width.to_bytes(2, "big")
    one_code = bytes([1] + [0] * 15 + [0])
    bits = np.concatenate([np.zeros(2 * blocks, np.uint8), np.ones(-2 * blocks % 8, np.uint8)])
    return (b"\xff\xd8" + part(0xdb, bytes([0] + [1] * 64)) + part(0xc0, bytes([8]) + size + bytes([1, 1, 0x11, 0])) +
            part(0xc4, bytes([0]) + one_code) + part(0xc4, bytes([0x10]) + one_code) + part(0xda, bytes([1, 1, 0, 0, 63, 0])) +
            np.packbits(bits).tobytes() + b"\xff\xd9")


def phone(name):
    folder = work / name
    folder.mkdir()
    mesh_with_y_up(folder)
    return folder


def polycam():
    folder = phone("polycam")
    (folder / "keyframes/cameras").mkdir(parents=True)
    (folder / "keyframes/images").mkdir()
    for i, s in enumerate(shots):
        pose = phone_pose(s)
        keys = {f"t_{r}{c}": pose[r, c] for r in range(3) for c in range(4)}
        (folder / f"keyframes/cameras/{i}.json").write_text(json.dumps({"width": s.w, "height": s.h, "fx": s.fx, "fy": s.fy, "cx": s.cx, "cy": s.cy} | keys))
        (folder / f"keyframes/images/{i}.jpg").write_bytes(grey_jpeg(s.w, s.h))
    return folder


def record3d():
    folder = phone("record3d")
    (folder / "rgb").mkdir()
    poses = []
    for i, s in enumerate(shots):
        turned = Shot.__new__(Shot)
        turned.R = phone_pose(s)[:3, :3]
        w, x, y, z = turned.quaternion()
        poses.append([x, y, z, w, *phone_pose(s)[:3, 3]])
        (folder / f"rgb/{i}.jpg").write_bytes(grey_jpeg(s.w, s.h))
    (folder / "metadata.json").write_text(json.dumps({"w": first.w, "h": first.h, "fps": 30, "poses": poses,
                                                      "K": [first.fx, 0, 0, 0, first.fy, 0, first.cx, first.cy, 1]}))
    return folder


def scanner_app():
    folder = phone("scanner-app")
    for i, s in enumerate(shots):
        (folder / f"frame_{i:05}.json").write_text(json.dumps({"cameraPoseARFrame": phone_pose(s).ravel().tolist(), "frame_index": i,
                                                              "intrinsics": [s.fx, 0, s.cx, 0, s.fy, s.cy, 0, 0, 1]}))
        (folder / f"frame_{i:05}.jpg").write_bytes(grey_jpeg(s.w, s.h))
    return folder


def transforms(name, change):
    folder = room(name)
    copy = json.loads(json.dumps(file))
    for frame, shot in zip(copy["frames"], shots):
        frame["file_path"] = "images/" + shot.name
    copy.pop("mesh_path", None)
    change(copy)
    (folder / "transforms.json").write_text(json.dumps(copy))
    return folder


def angle_only(copy):
    """NeRF's: the field of view, nothing else of the lens."""
    for key in ("w", "h", "fl_x", "fl_y", "cx", "cy"):
        copy.pop(key, None)
    copy["camera_angle_x"] = 2 * math.atan(first.w / 2 / first.fx)
    for frame, shot in zip(copy["frames"], shots):
        frame["file_path"] = "./images/" + shot.stem


def per_frame(copy):
    """Nerfstudio's: each frame its own lens, and keys that are its own."""
    for frame in copy["frames"]:
        frame.update({key: copy[key] for key in ("w", "h", "fl_x", "fl_y", "cx", "cy") if key in copy}, colmap_im_id=1)
    for key in ("w", "h", "fl_x", "fl_y", "cx", "cy"):
        copy.pop(key, None)
    copy.update(applied_transform=[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], orientation_override="none")


rooms = [
    ("transforms.json, NeRF's keys", lambda: transforms("nerf", angle_only)),
    ("transforms.json, nerfstudio's", lambda: transforms("nerfstudio", per_frame)),
    ("COLMAP, text", lambda: colmap(room("colmap-text"), "RADIAL" if lens else "PINHOLE").parent.parent),
    ("COLMAP, binary, by COLMAP", lambda: converted("colmap-binary", "BIN", "sparse/0", "RADIAL" if lens else "PINHOLE")),
    ("Bundler, by COLMAP", lambda: converted("bundler", "Bundler", "bundle", "RADIAL" if lens else "SIMPLE_PINHOLE")),
    ("VisualSFM, by COLMAP", lambda: converted("nvm", "NVM", "model.nvm", "SIMPLE_PINHOLE")),
    ("Metashape", metashape), ("Meshroom", meshroom), ("RealityCapture", reality_capture), ("OpenMVG", open_mvg), ("LLFF", llff),
    ("Polycam", polycam), ("Record3D", record3d), ("3D Scanner App", scanner_app),
]
if lens:
    rooms = [one for one in rooms if one[0].split(",")[0] not in ("VisualSFM", "LLFF", "Polycam", "Record3D", "3D Scanner App") and "NeRF" not in one[0]]
missing = set(subprocess.run([arguments.doors, "--formats"], capture_output=True, text=True, check=True).stdout.splitlines())
print("\n| door | read as | views | pixels apart, mean | worst |\n|---|---|---|---|---|")
for name, make in rooms:
    run = subprocess.run([arguments.doors, source, make()], capture_output=True, text=True)
    if run.returncode:
        print(f"| {name} | {run.stderr.strip()} | | | |")
        continue
    found = json.loads(run.stdout)
    missing.discard(found["format"])
    print(f"| {name} | {found['format']} | {found['views']} of {found['of']} | {found['mean']:.2g} | {found['worst']:.2g} |")
print("\nformats without a door here: " + (", ".join(sorted(missing)) or "none"))
shutil.rmtree(work)

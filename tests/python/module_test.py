"""What docs/python.md promises, on a small capture. Run by ctest with PYTHONPATH on the module."""
import json
import os
import pathlib
import re
import sys
import tempfile

import numpy

import relamp

source = pathlib.Path(sys.argv[1])
folder = pathlib.Path(tempfile.mkdtemp(prefix="relamp-python-"))


def raises(kind, text, act):
    try:
        act()
    except kind as error:
        assert text in str(error), str(error)
        return
    raise AssertionError(f"nothing was raised, expected {kind.__name__}: {text}")


def capture_of(place, lamp=False):
    """A square metre under a grey sky, seen by three cameras from above: photographs as small HDR files. `lamp`: a patch in its middle shines."""
    (place / "images").mkdir(parents=True)
    (place / "mesh.obj").write_text(
        "".join(f"v {x / 8 - 0.5} {y / 8 - 0.5} 0\n" for y in range(9) for x in range(9))
        + "".join(f"f {9 * y + x + 1} {9 * y + x + 2} {9 * y + x + 11} {9 * y + x + 10}\n" for y in range(8) for x in range(8))
    )
    frames = []
    for view in range(3):
        header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 24 +X 32\n"
        pixels = b"".join(
            bytes([200, 180, 160, 136] if lamp and max(abs((x - 15.5) / 40 * 1.2 + 0.1 * view), abs((y - 11.5) / 40 * 1.2)) < 0.16 else [64, 72, 80, 128])
            for y in range(24) for x in range(32))
        (place / f"images/{view}.hdr").write_bytes(header + pixels)
        frames.append({"file_path": f"images/{view}.hdr",
                       "transform_matrix": [[1, 0, 0, 0.1 * view], [0, 1, 0, 0], [0, 0, 1, 1.2], [0, 0, 0, 1]]})
    (place / "transforms.json").write_text(json.dumps({"w": 32, "h": 24, "fl_x": 40, "frames": frames}))
    return place


try:
    capture = capture_of(folder / "capture")
    told = []
    shot = relamp.solve(capture, folder / "a.relamp", quality="draft", progress=lambda *what: told.append(what))
    assert all(isinstance(label, str) and 0 <= fraction <= 1 for label, fraction in told)
    assert shot.views == [f"images/{i}.hdr" for i in range(3)], shot.views
    assert shot.positions.shape == (81, 3) and shot.positions.dtype == numpy.float32
    assert shot.triangles.shape == (128, 3) and shot.triangles.max() == 80
    assert shot.albedo.shape == (81, 3) and shot.confidence.shape == (81,)
    assert shot.info["version"] == 2 and "look" not in shot.info

    # Lighting states: told by pattern, one of them without a sky, asked for by name.
    assert "states" not in shot.info
    raises(relamp.Error, "state: no lighting state of the photographs is called night",
           lambda: shot.render(state="night"))
    raises(relamp.Error, "--state-environment night=own: no photograph is of this state",
           lambda: relamp.solve(capture, folder / "b.relamp", state_environments={"night": "own"}))
    dark = relamp.solve(capture, folder / "b.relamp", quality="draft", states={"day": "*", "night": "*2.hdr"},
                        state_environments={"night": "none"})
    assert [state["name"] for state in dark.info["states"]] == ["day", "night"]
    assert dark.render(state="day", samples=1).beauty.max() > 0 == dark.render(state="night", samples=1).beauty.max()

    # Arrays are views that outlive their owner and may not be written to.
    assert numpy.shares_memory(shot.positions, shot.positions)
    raises(ValueError, "read-only", lambda: shot.positions.__setitem__((0, 0), 1))
    frame = relamp.open(shot.folder).render(1, samples=2)
    beauty, depth = frame.beauty, frame.depth
    assert beauty.shape == (24, 32, 3) and depth.shape == (24, 32)
    assert abs(depth[12, 16] - 1.2) < 1e-3, depth[12, 16]
    total = frame.world + sum(frame.lights.values())
    del frame
    assert numpy.abs(total - beauty).max() < 1e-4 and beauty.max() > 0
    assert numpy.array_equal(beauty, shot.render(1, samples=2, threads=1).beauty)

    # Looks are documents; another pose is another picture.
    dark = {"version": 1, "environment": {"source": "none"}}
    assert shot.render(look=dark, samples=1).world.max() == 0
    shot.look = dark
    assert shot.look["environment"]["source"] == "none"
    shot.save()
    assert relamp.open(folder / "a.relamp").look["environment"]["source"] == "none"
    far = numpy.eye(4)
    far[2, 3] = 2.4
    assert abs(shot.render(pose=far, samples=1).depth[12, 16] - 2.4) < 1e-3
    shot.export(folder / "scene")
    assert (folder / "scene/lights.gltf").is_file()

    # How files are read, what fixes the scale, and what was measured on the set.
    known = relamp.solve(capture, folder / "c.relamp", quality="draft", files={"scale": 2}, gauge={"albedo": 0.25})
    assert abs(numpy.ptp(known.positions[:, 0]) - 2) < 1e-6 and known.info["gauge"]["kind"] == "albedo"
    raises(relamp.Error, "files: meshes: unknown", lambda: relamp.solve(capture, folder / "d.relamp", files={"meshes": 1}))
    raises(relamp.Error, "absent.ply", lambda: relamp.solve(capture, folder / "d.relamp", files={"mesh": "absent.ply"}))
    raises(relamp.Error, "gauge: albedo: expected 0.001 to 1", lambda: relamp.solve(capture, folder / "d.relamp", gauge={"albedo": 5}))
    raises(relamp.Error, "gauge: radiance: expected 3 numbers", lambda: relamp.solve(capture, folder / "d.relamp", gauge={"emitter": "a"}))
    for references, text in [
        ({"greys": [{"view": 0, "at": (1, 2)}]}, "greys[0]: radius: expected pixels"),
        ({"greys": [{"view": 0, "at": 7, "radius": 1}]}, "greys[0]: at: expected 2 numbers"),
        ({"greys": [{"view": 9, "at": (1, 2), "radius": 1}]}, "view 9 does not exist"),
        ({"charts": [{"view": 0, "corners": [(1, 2)]}]}, "corners: there are 1, expected 4"),
        ({"mirror_balls": [{"view": 0}]}, "mirror ball in view 0"),
        ({"light_probes": ["absent.exr"]}, "absent.exr"),
        ({"light_probes": "absent.exr"}, "references: light_probes: expected a list"),
    ]:
        raises(relamp.Error, text, lambda: relamp.solve(capture, folder / "d.relamp", quality="draft", references=references))
    assert not (folder / "d.relamp").exists()

    # The examples of docs/python.md in their order, where their files lie.
    lamp = capture_of(folder / "lamp", lamp=True)
    scan = capture_of(folder / "examples/scan")
    (scan / "sparse/0").mkdir(parents=True)
    (scan / "sparse/0/cameras.txt").write_text("1 PINHOLE 32 24 40 40 16 12\n")
    (scan / "sparse/0/images.txt").write_text("".join(f"{v + 1} 0 1 0 0 {-0.1 * v} 0 1.2 1 {v}.hdr\n\n" for v in range(3)))
    (scan / "transforms.json").unlink()
    os.chdir(folder / "examples")
    examples = re.findall(r"```python\n(.*?)```", (source / "docs/python.md").read_text(), re.S)
    assert len(examples) >= 4
    for example in examples:
        own = example.replace("assets/captures/desk-lamp", str(lamp)).replace("mesh.ply", "mesh.obj")
        exec(compile(own, "docs/python.md", "exec"), {})
    assert (folder / "examples/lamp-for-blender/scene.py").is_file()

    # Faults name themselves, and nothing is half done.
    raises(relamp.Error, "add --overwrite", lambda: shot.export(folder / "scene"))
    raises(relamp.Error, "camera: is 3", lambda: shot.render(3))
    raises(relamp.Error, "pose: expected 4 x 4", lambda: shot.render(pose=[1, 2]))
    raises(relamp.Error, "emitters[0]", lambda: setattr(shot, "look", {"version": 1, "emitters": [{"id": 5}]}))
    raises(relamp.Error, "exists already", lambda: relamp.solve(capture, folder / "a.relamp"))
    raises(relamp.Error, "none.relamp", lambda: relamp.open(folder / "none.relamp"))
    raises(relamp.Cancelled, "", lambda: shot.render(samples=4096, progress=lambda *_: False))
    raises(ZeroDivisionError, "", lambda: shot.render(samples=4096, progress=lambda *_: 1 / 0))
    raises(relamp.Cancelled, "",
           lambda: relamp.solve(source / "assets/captures/desk-lamp", folder / "e.relamp", progress=lambda *_: False))
    assert not (folder / "e.relamp").exists()

    # Stub and module name the same things.
    stub = (source / "app/python/relamp.pyi").read_text()
    for name in ("Error", "Cancelled", "Frame", "Shot"):
        for member in [n for n in dir(getattr(relamp, name)) if not n.startswith("_")]:
            known = re.search(rf"\bdef {member}\(|^    {member}:", stub, re.M)
            assert known or name in ("Error", "Cancelled"), f"{name}.{member} is not in the stub"
    print("ok")
finally:
    import shutil

    shutil.rmtree(folder)

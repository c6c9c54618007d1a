"""Table tops and rooms for made_scenes.py whose objects, lamps, colours and light are drawn at random. Metres."""
import math

import numpy as np

import made_shapes as shapes

PANORAMAS = ["blender_interior.exr", "debevec_grace.hdr", "debevec_stpeters.hdr", "polyhaven_city.hdr",
             "polyhaven_lobby.hdr", "polyhaven_night.hdr", "polyhaven_studio.hdr", "polyhaven_sunrise.hdr"]
MESHES = [("armadillo.obj", 0.3), ("fertility.off", 0.28), ("max-planck-decimated.obj", 0.28), ("spot.obj", 0.24),
          ("stanford-bunny.obj", 0.22), ("teapot.obj", 0.16)]
PLACES = [(-0.4, -0.3), (0, -0.34), (0.4, -0.28), (-0.42, 0.05), (0.02, 0.02), (0.42, 0.08), (-0.35, 0.36),
          (0.05, 0.36), (0.42, 0.4)]


def placed(mesh, at, turn=0, tilt=0):
    """A mesh turned about X, then Z, by degrees, then moved."""
    v, f = mesh
    c, s = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    v = np.stack([v[:, 0], c * v[:, 1] - s * v[:, 2], s * v[:, 1] + c * v[:, 2]], 1)
    return shapes.turned(v, turn) + np.asarray(at), f


def ball(r, x, y):
    radius = r.uniform(0.03, 0.07)
    return [], [shapes.sphere((x, y, 0.98 * radius), radius)]


def bulb_on_stick(r, x, y):
    radius, height = r.uniform(0.015, 0.03), r.uniform(0.12, 0.3)
    return [shapes.cylinder(0.01, 0.001, height - radius, 24, 16, (x, y, 0))], [
        shapes.sphere((x, y, height), radius, 28)]


def paper_shade(r, x, y):
    t, low, high, height = np.linspace(0, 1, 16), r.uniform(0.06, 0.1), r.uniform(0.04, 0.07), r.uniform(0.12, 0.2)
    outside = list(zip(low + (high - low) * t, height * t + 0.12))
    foot = [(0.05, 0.001), (0.05, 0.012), (0.008, 0.014), (0.008, 0.118), (0.001, 0.118)]
    inside = [(radius - 0.003, z) for radius, z in outside[::-1]]
    return [shapes.lathe(foot, 32, (x, y, 0))], [shapes.lathe(outside + inside + outside[:1], 56, (x, y, 0))]


def ring(r, x, y):
    a, radius = np.linspace(0, 2 * np.pi, 13), r.uniform(0.08, 0.14)
    whole = shapes.lathe(np.stack([radius + 0.012 * np.cos(a), 0.012 * np.sin(a)], 1), 48)
    return [], [placed(whole, (x, y, r.uniform(0.2, 0.3)), r.uniform(0, 360), 90 + r.uniform(-20, 20))]


def tablet(r, x, y):
    w, h, tilt = r.uniform(0.08, 0.14), r.uniform(0.06, 0.1), r.uniform(50, 75)
    z = h * math.sin(math.radians(tilt)) + 0.008
    return [], [placed(shapes.box((-w, -h, -0.004), (w, h, 0.004), 0.012), (x, y, z), r.uniform(0, 360), tilt)]


def tube(r, x, y):
    h = r.uniform(0.25, 0.45)
    profile = [(0.0005, 0)] + [(0.014, z) for z in np.linspace(0, h, 40)] + [(0.0005, h)]
    return [], [shapes.lathe(profile, 18, (x, y, 0.002))]


def candles(r, x, y):
    """Three lights of one radiance."""
    wax, flames = [], []
    for k in range(3):
        cx, cy = x + 0.05 * math.cos(2.1 * k), y + 0.05 * math.sin(2.1 * k)
        wax.append(shapes.cylinder(0.008, 0.001, 0.08 + 0.02 * k, 16, 14, (cx, cy, 0)))
        flames.append(shapes.sphere((cx, cy, 0.094 + 0.02 * k), 0.014, 18))
    return wax, flames


def cube(r, x, y):
    q = r.uniform(0.03, 0.06)
    return [], [placed(shapes.box((-q, -q, 0), (q, q, 2 * q), 0.008), (x, y, 0.001), r.uniform(0, 90))]


def overhead_panel(r, x, y):
    q = r.uniform(0.12, 0.25)
    panel = shapes.box((-q, -0.6 * q, 0), (q, 0.6 * q, 0.015), 0.03)
    return [], [placed(panel, (0.5 * x, 0.5 * y, r.uniform(0.55, 0.75)), r.uniform(0, 180))]


def wall_strip(r, x, y):
    return [], [placed(shapes.box((-0.4, -0.012, -0.012), (0.4, 0.012, 0.012), 0.012), (x, 0.585, r.uniform(0.4, 0.8)))]


LAMPS = [ball, bulb_on_stick, paper_shade, ring, tablet, tube, candles, cube, overhead_panel]


def area(mesh):
    a, b, c = (np.asarray(mesh[0])[np.asarray(mesh[1])[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def add_lamp(s, r, kind, name, at):
    """What holds it, and its lights, which share a power and a colour. Returns the lights' names."""
    stands, lights = kind(r, *at)
    for k, mesh in enumerate(stands):
        s.add(f"{name}-stand{k}", mesh, (0.4, 0.38, 0.35))
    colour = np.clip(1 + r.uniform(-0.6, 0.6, 3), 0.15, 2)
    power = r.uniform(0.25, 0.9) * (1 + 2 * s.environment[1])
    names = [f"{name}-{k}" for k in range(len(lights))]
    for light, mesh in zip(names, lights):
        s.light(light, mesh, tuple(colour * power / sum(area(m) for m in lights)))
    return names


def draw(s, seed, room):
    """Fills the empty scene `s`: four objects, one to three lamps; a table, or a room with bounced light."""
    r = np.random.default_rng(1000 + seed)
    own, other = r.choice(len(PANORAMAS), 2, replace=False)
    s.bounces, s.fov = (4 if room else 0), 55
    s.environment, s.others = (PANORAMAS[own], r.uniform(0.08, 0.5)), (PANORAMAS[other], 0.35)
    base = r.uniform(0.25, 0.7, 3)
    if room:
        floor = shapes.grid((-1.1, -0.8, 0), (2.2, 0, 0), (0, 1.4, 0), 150, 95)
        s.add("floor", floor, shapes.checks(tuple(base), tuple(0.8 * base), (0, 1), 0.2))
        s.add("wall", shapes.grid((-1.1, 0.6, 0), (2.2, 0, 0), (0, 0, 1.1), 150, 70), tuple(r.uniform(0.4, 0.75, 3)))
        if r.random() < 0.6:
            side = shapes.grid((1.1, 0.6, 0), (0, -1.4, 0), (0, 0, 1.1), 95, 70)
            s.add("side", side, tuple(r.uniform(0.4, 0.75, 3)))
    else:
        top = shapes.box((-0.65, -0.55, -0.04), (0.65, 0.55, 0), 0.011)
        s.add("table", top, s.spots(tuple(base), tuple(0.8 * base), 0.07))
    places = [(x + r.uniform(-0.05, 0.05), y + r.uniform(-0.05, 0.05)) for x, y in r.permutation(PLACES)]
    for k in r.choice(len(MESHES), 3, replace=False):
        file, height = MESHES[k]
        mesh = s.read(file, height * r.uniform(0.8, 1.1), (*places.pop(), 0.001), r.uniform(0, 360))
        s.add(file, mesh, tuple(r.uniform(0.15, 0.75, 3)), r.choice([1.0, 1.0, 0.3]))
    block = placed(shapes.box((-0.08, -0.06, 0.001), (0.08, 0.06, 0.14), 0.008), (*places.pop(), 0), r.uniform(0, 90))
    s.add("block", block, tuple(r.uniform(0.15, 0.75, 3)))
    kinds = LAMPS + ([wall_strip] if room else [])
    for k, kind in enumerate(r.choice(len(kinds), int(r.integers(1, 4)), replace=False)):
        for name in add_lamp(s, r, kinds[kind], f"lamp{k}", places.pop()):
            s.edit(name + "-off", name, power=(0, 0, 0))
    s.edit("moved", "lamp0-0", move=(*(0.5 * np.array(places.pop()) - 0.1), 0.08))
    s.arc((0, 0, 0.12), 9, -90, 110 if room else 250, (1.45, 0.2), (0.75, 0.3), 0.03)
    s.main, s.novel = 4, (np.array((0.5, -1.2, 0.65)), np.array((0, 0, 0.12)))
    return s

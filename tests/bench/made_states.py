"""Photographs of a made scene in other lighting states: the same cameras, some lamps off. Inside Blender:

    blender -b -P tests/bench/made_states.py -- DATA MADE OUT still-life|kitchen|loft [STATE ...]

MADE is what made_scenes.py wrote. Its photographs, with all lamps on, become the state "on" of OUT. "off" has the
environment alone, and a state of each lamp's name has that lamp and the environment. "evening" has all lamps and
another environment (truth/env-evening.exr), "evening-off" that environment alone, "dark" all lamps and no environment.
Named states are rendered, without a name all; those that OUT has already are taken as they are. transforms.json names
"on" and "off"; transforms-lamps.json has each lamp alone and "off", and no view with all of them. The others are pairs
of states with environments of their own. Noise of the states is independent. 2 to 10 minutes on two cores.
"""
import json
import os
import shutil
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import made_scenes  # noqa: E402
from made_render import Renderer, camera_at  # noqa: E402

EVENING = {"still-life": ("polyhaven_night.hdr", 0.2), "kitchen": ("polyhaven_sunrise.hdr", 0.1),
           "loft": ("polyhaven_night.hdr", 0.15)}


def main():
    data, made, out, name, *wanted = sys.argv[sys.argv.index("--") + 1:]
    scene = {"still-life": made_scenes.still_life, "kitchen": made_scenes.kitchen, "loft": made_scenes.loft}[name](data)
    shutil.copytree(made, out, dirs_exist_ok=True)
    renderer = Renderer(scene.objects, scene.bounces, scene.fov)
    day, dark = f"{made}/truth/env.exr", renderer.even(0, f"{out}/truth/env-dark.exr")
    evening = renderer.panorama(f"{data}/hdri/{EVENING[name][0]}", EVENING[name][1], f"{out}/truth/env-evening.exr")
    lights = [o["name"] for o in scene.objects if o["radiance"]]
    states = {"off": (day, []), **{light: (day, [light]) for light in lights}, "evening": (evening, lights),
              "evening-off": (evening, []), "dark": (dark, lights)}
    with open(f"{made}/transforms.json") as f:
        capture = json.load(f)
    frames = {"on": [{**frame, "state": "on"} for frame in capture["frames"]]}
    for k, (state, (environment, shining)) in enumerate(states.items()):
        frames[state] = []
        renderer.light_from(environment)
        for light in lights:
            renderer.change(light, power=(1, 1, 1) if light in shining else (0, 0, 0))
        os.makedirs(f"{out}/images/{state}", exist_ok=True)
        for i, frame in enumerate(capture["frames"]):
            file = f"images/{state}/{i:04}.exr"
            if (not wanted or state in wanted) and not os.path.exists(f"{out}/{file}"):
                renderer.render(camera_at(*scene.cameras[i]), f"{out}/{file}", 40, 1000 * (k + 1) + i)
            frames[state].append({**frame, "file_path": file, "state": state})

    def write(file, names, **told):
        table = {"states": told} if told else {}
        with open(f"{out}/{file}", "w") as f:
            json.dump({**capture, **table, "frames": [x for s in names for x in frames[s]]}, f, indent=1)
    own, none = {"environment": "own"}, {"environment": "none"}
    write("transforms.json", ["on", "off"])
    write("transforms-lamps.json", ["off"] + lights)
    write("transforms-evening.json", ["on", "evening"], evening=own)
    write("transforms-evening-off.json", ["off", "evening"], evening=own)
    write("transforms-dark.json", ["on", "dark"], dark=none)
    write("transforms-dark-off.json", ["off", "dark"], dark=none)


if __name__ == "__main__":
    main()

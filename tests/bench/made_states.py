"""Photographs of a made scene in other lighting states: the same cameras, some lamps off. Inside Blender:

    blender -b -P tests/bench/made_states.py -- DATA MADE OUT still-life|kitchen|loft

MADE is what made_scenes.py wrote. Its photographs, with all lamps on, become the state "on" of OUT; "off" has the
environment alone, and a state of each lamp's name has that lamp and the environment. transforms.json names "on" and
"off"; transforms-lamps.json has each lamp alone and "off", and no view with all of them. Noise of the states is
independent. 2 to 10 minutes on two cores.
"""
import json
import os
import shutil
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import made_scenes  # noqa: E402
from made_render import Renderer, camera_at  # noqa: E402


def main():
    data, made, out, name = sys.argv[sys.argv.index("--") + 1:][:4]
    scene = {"still-life": made_scenes.still_life, "kitchen": made_scenes.kitchen, "loft": made_scenes.loft}[name](data)
    shutil.copytree(made, out, dirs_exist_ok=True)
    renderer = Renderer(scene.objects, scene.bounces, scene.fov)
    renderer.light_from(f"{made}/truth/env.exr")
    lights = [o["name"] for o in scene.objects if o["radiance"]]
    with open(f"{made}/transforms.json") as f:
        capture = json.load(f)
    frames = {state: [] for state in ["on", "off"] + lights}
    for i, frame in enumerate(capture["frames"]):
        frames["on"].append({**frame, "state": "on"})
        for k, state in enumerate(["off"] + lights):
            for light in lights:
                renderer.change(light, power=(1, 1, 1) if light == state else (0, 0, 0))
            os.makedirs(f"{out}/images/{state}", exist_ok=True)
            file = f"images/{state}/{i:04}.exr"
            renderer.render(camera_at(*scene.cameras[i]), f"{out}/{file}", 40, 1000 * (k + 1) + i)
            frames[state].append({**frame, "file_path": file, "state": state})

    def write(file, states):
        with open(f"{out}/{file}", "w") as f:
            json.dump({**capture, "frames": [frame for s in states for frame in frames[s]]}, f, indent=1)
    write("transforms.json", ["on", "off"])
    write("transforms-lamps.json", ["off"] + lights)


if __name__ == "__main__":
    main()

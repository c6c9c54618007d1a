#!/usr/bin/env python3
"""How soon the window follows the hand: from a mouse step to changed light on screen, and from release to rest.

    window_latency.py EDITOR SHOT [--steps 40] [--busy] [--size 1600x1000]

Starts Xvfb and the editor on SHOT, selects the first light, moves it with G and the mouse, then clicks. Prints the median and the 90th
percentile of a step in milliseconds, from the motion to the end of the swap that shows its light, the processor time that the editor
takes for a step, and the seconds until the light is refined, and until the image at rest is there. Processor time is the figure to
compare on a machine that others use. --busy: another
process computes on one core meanwhile. Needs Xvfb and xdotool. A figure holds one look at a file every 2 ms."""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time


def processor_time(process):
    """Milliseconds of all its threads."""
    fields = open(f"/proc/{process}/stat").read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) * 1000 / os.sysconf("SC_CLK_TCK")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("editor")
    parser.add_argument("shot")
    parser.add_argument("--steps", type=int, default=40)
    parser.add_argument("--busy", action="store_true")
    parser.add_argument("--size", default="1600x1000")
    given = parser.parse_args()
    width, height = (int(n) for n in given.size.split("x"))
    read, write = os.pipe()
    xvfb = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{given.size}x24", "-nolisten", "tcp"],
                            pass_fds=[write], stderr=subprocess.DEVNULL)
    display = ":" + os.read(read, 16).decode().strip()
    home = tempfile.TemporaryDirectory()
    map_file = os.path.join(home.name, "map.json")
    environment = dict(os.environ, DISPLAY=display, HOME=home.name, XDG_CONFIG_HOME=home.name + "/config",
                       XDG_STATE_HOME=home.name + "/state", RELAMP_ITEM_MAP=map_file, LIBGL_ALWAYS_SOFTWARE="1")
    editor = subprocess.Popen([given.editor, "--width", str(width), "--height", str(height), given.shot],
                              env=environment, stderr=subprocess.DEVNULL)
    other = subprocess.Popen([sys.executable, "-c", "while True: pass"]) if given.busy else None

    def state():
        try:
            return json.load(open(map_file))
        except (OSError, ValueError):
            return {}

    def until(done, seconds=120):
        start = time.monotonic()
        while time.monotonic() - start < seconds:
            now = state()
            if now and done(now):
                return time.monotonic() - start
            time.sleep(0.002)
        raise SystemExit("waited too long; the window says " + str({k: v for k, v in state().items() if k != "items"}))

    hand = subprocess.Popen(["xdotool", "-"], env=environment, stdin=subprocess.PIPE, text=True)

    def xdotool(*words):
        hand.stdin.write(" ".join(map(str, words)) + "\n")
        hand.stdin.flush()

    try:
        rest = lambda m: m["refined"] and m["rest"] and not m["busy"]  # noqa: E731
        until(lambda m: m["estimate"] and rest(m))
        light = next(name for name in state()["items"] if name.startswith("emitter:"))
        low_x, low_y, high_x, high_y = state()["items"][light]
        xdotool("mousemove", int((low_x + high_x) / 2), int((low_y + high_y) / 2))
        time.sleep(0.3)
        xdotool("click", 1)
        until(lambda m: m["selected"])
        x, y = width // 2, height // 2
        xdotool("mousemove", x, y)
        time.sleep(0.3)
        xdotool("key", "g")
        until(lambda m: m["gesture"])
        steps = []
        busy = processor_time(editor.pid)
        for i in range(given.steps):
            time.sleep(0.1)
            before = state()["live_meshes"]
            start = time.monotonic()
            x += 6 if i < given.steps // 2 else -6
            xdotool("mousemove", x, y)
            until(lambda m: m["live_meshes"] > before, 20)
            steps.append((time.monotonic() - start) * 1000)
        busy = processor_time(editor.pid) - busy
        xdotool("click", 1)
        start = time.monotonic()
        until(lambda m: not m["gesture"])
        until(lambda m: m["refined"])
        refined = time.monotonic() - start
        until(rest)
        print(f"step: median {statistics.median(steps):.0f} ms, 90th percentile {sorted(steps)[int(0.9 * len(steps))]:.0f} ms, "
              f"processor time {busy / given.steps:.0f} ms; "
              f"release to refined light {refined:.1f} s, to full rest {time.monotonic() - start:.1f} s")
    finally:
        for process in (hand, editor, other, xvfb):
            if process:
                process.kill()
        home.cleanup()


main()

#!/usr/bin/env python3
"""How well solves explain sets of real photographs: one row a set.

    real_sets.py --relamp build/relamp CAPTURE [CAPTURE...] [--solve-args "..."] [--work DIR]

CAPTURE: a folder that `relamp solve` takes (real_capture.py makes them from data sets with a calibration). Columns: median, worst and left-out PSNR of the
solve's own measure, what the plain median of each vertex's observations reproduces at the same pixels, the gauge with its deviation, the median albedo of the
vertices seen, seconds and exit code."""
import argparse
import json
import os
import shlex
import struct
import subprocess
import tempfile


def median_albedo(path):
    """Per channel, over the vertices that a view sees, from reflectance.ply (binary little-endian)."""
    with open(path, "rb") as file:
        names, kinds, count = [], "", 0
        for line in iter(lambda: file.readline().split(), [b"end_header"]):
            if line[:2] == [b"element", b"vertex"]:
                count = int(line[2])
            elif line[0] == b"property" and line[1] != b"list":
                names.append(line[2].decode())
                kinds += {b"float": "f", b"double": "d", b"int": "i"}[line[1]]
        row = struct.Struct("<" + kinds)
        rows = [row.unpack(file.read(row.size)) for _ in range(count)]
    at = {name: i for i, name in enumerate(names)}
    seen = [r for r in rows if r[at["observed"]] > 0]
    return [sorted(r[at["albedo_" + c]] for r in seen)[len(seen) // 2] for c in "rgb"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("captures", nargs="+")
    arguments.add_argument("--relamp", default="build/relamp")
    arguments.add_argument("--solve-args", default="")
    arguments.add_argument("--work")
    a = arguments.parse_args()
    work = a.work or tempfile.mkdtemp(prefix="relamp-real-")
    print("| set | views | PSNR | worst | left out | plain median | gauge | median albedo | s | exit |\n|---|---|---|---|---|---|---|---|---|---|")
    for capture in a.captures:
        name = os.path.basename(os.path.normpath(capture))
        shot = os.path.join(work, name + ".relamp")
        code = subprocess.call([a.relamp, "--quiet", "solve", capture, "-o", shot, "--overwrite", *shlex.split(a.solve_args)])
        if code not in (0, 4):
            print(f"| {name} | failed with {code} |")
            continue
        info = json.loads(subprocess.check_output([a.relamp, "info", shot, "--json"]))
        r, gauge = info["reproduction"], info["gauge"]
        held = f"{r['held_out_psnr']:.1f}" if r["held_out_psnr"] else "-"
        sigma = f" {100 * gauge['sigma'][1]:.0f} %" if "sigma" in gauge else ""
        albedo = " ".join(f"{x:.2f}" for x in median_albedo(os.path.join(shot, "reflectance.ply")))
        print(f"| {name} | {len(r['views'])} | {r['psnr']:.1f} | {min(v['psnr'] for v in r['views']):.1f} | {held} | {r['observed_psnr']:.1f} | {gauge['kind']}{sigma} | {albedo} | "
              f"{info['resources']['seconds']:.0f} | {code} |", flush=True)


if __name__ == "__main__":
    main()

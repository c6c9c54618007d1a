#!/usr/bin/env python3
"""Response curves and radiance from brackets: relamp beside OpenCV and pfstools.

    compare_brackets.py --relamp build/relamp [--scene BRACKETS_SCENE] [--memorial FOLDER]

Needs python3-numpy, python3-openimageio; python3-opencv and pfstools where installed, else left out.

--scene: a capture with `exposures` in transforms.json, truth/response.json and the HDR images that brackets.json names. Each tool
  merges each view's set with the curve it finds from that set alone. Figures, the median over the views:
    response RMSE   ln exposure over codes 5..250, after one offset a channel
    radiance        median relative error over the pixels, after one scale a channel / after one scale for all three
    bright, dark    the same (one scale a channel) for the brightest and the darkest tenth of the pixels
--memorial: photographs without truth. The odd exposures are given, the even ones predicted from radiance and curve: root mean
  square and median error of the predicted codes, pixels well exposed in both.
"""
import argparse, json, pathlib, shutil, subprocess, tempfile
import numpy as np
import OpenImageIO as oiio

try:
    import cv2
except ImportError:
    cv2 = None


def read(path):
    source = oiio.ImageInput.open(str(path))
    pixels = source.read_image(0, 0, 0, 3, "float")
    source.close()
    return np.asarray(pixels, np.float64)


def codes(path):
    source = oiio.ImageInput.open(str(path))
    pixels = source.read_image(0, 0, 0, 3, "uint8")
    source.close()
    return np.ascontiguousarray(pixels)


def by_relamp(program, files, times, folder):
    out, curve = folder / "relamp.exr", folder / "relamp.json"
    subprocess.run([program, "--quiet", "merge-hdr", *map(str, files), "-o", out, "--response", curve, "--times", ",".join(map(repr, times))], check=True)
    g = json.load(open(curve))["log_exposure"]
    return read(out), np.array([g[c] for c in "rgb"])


def by_opencv(kind):
    def merge(_, files, times, folder):
        images = [codes(f) for f in files]
        t = np.array(times, np.float32)
        calibrate = cv2.createCalibrateDebevec() if kind == "debevec" else cv2.createCalibrateRobertson()
        curve = calibrate.process(images, t)
        merger = cv2.createMergeDebevec() if kind == "debevec" else cv2.createMergeRobertson()
        radiance = merger.process(images, t, curve)
        return np.asarray(radiance, np.float64), np.log(np.maximum(curve[:, 0, :].T.astype(np.float64), 1e-12))
    return merge


def by_pfstools(kind):
    def merge(_, files, times, folder):
        listing, curve, out = folder / "list.hdrgen", folder / "curve.m", folder / "pfs.exr"
        listing.write_text("".join(f"{f} {1 / t!r} 4 100 0\n" for f, t in zip(files, times)))
        subprocess.run(f"pfsinhdrgen {listing} | pfshdrcalibrate -c {kind} -s {curve} 2>/dev/null | pfsoutexr {out}", shell=True, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        rows = [[float(w) for w in line.split()] for line in open(curve) if line.strip() and not line.startswith("#")][:768]
        table = np.array(rows)[:, 2].reshape(3, 256)
        # The file's order is red, green, blue by the names IR, IG, IB.
        return read(out), np.log(np.maximum(table, 1e-12))
    return merge


def tools():
    found = {"relamp": by_relamp}
    if cv2:
        found |= {"OpenCV Debevec": by_opencv("debevec"), "OpenCV Robertson": by_opencv("robertson")}
    if shutil.which("pfshdrcalibrate"):
        found |= {"pfstools Robertson": by_pfstools("robertson"), "pfstools Mitsunaga": by_pfstools("mitsunaga")}
    return found


def scene(program, folder):
    brackets = json.load(open(folder / "brackets.json"))["views"]
    curve = json.load(open(folder / "truth/response.json"))["curve"]
    truth_g = np.log(np.maximum(np.array([curve[c] for c in "rgb"]), 1e-12))
    z = slice(5, 251)
    print(f"{'':20} response RMSE  radiance/channel  radiance/common  bright  dark")
    for name, merge in tools().items():
        rows = []
        for view in brackets:
            with tempfile.TemporaryDirectory() as work:
                files = [folder / b["file_path"] for b in view["brackets"]]
                try:
                    radiance, g = merge(program, files, [b["exposure_time"] for b in view["brackets"]], pathlib.Path(work))
                except (subprocess.CalledProcessError, Exception) as error:
                    print(name, "failed on", view["frame"], error)
                    continue
            truth = read(folder / view["hdr"])
            difference = g[:, z] - truth_g[:, z]
            difference[g[:, z] < -27] = np.nan
            rmse = np.sqrt(np.nanmean((difference - np.nanmean(difference, 1, keepdims=True)) ** 2))
            # Clipped even in the shortest exposure: no tool can know.
            shortest = codes(files[int(np.argmin([b["exposure_time"] for b in view["brackets"]]))])
            known = (shortest.max(2) < 250) & (truth.min(2) > 1e-5) & np.isfinite(radiance).all(2)
            a, b = radiance[known], truth[known]
            ratio = np.maximum(a, 1e-12) / b
            common = np.median(ratio)
            error = np.abs(ratio / np.median(ratio, 0) - 1)
            brightness = b.mean(1)
            bright, dark = brightness > np.quantile(brightness, .9), brightness < np.quantile(brightness, .1)
            rows.append([rmse, np.median(error), np.median(np.abs(ratio / common - 1)), np.median(error[bright]), np.median(error[dark])])
        m = np.median(rows, 0)
        print(f"{name:20} {m[0]:13.4f}  {m[1]:16.4f}  {m[2]:15.4f}  {m[3]:6.4f}  {m[4]:6.4f}")


def memorial(program, folder):
    rows = [line.split() for line in open(folder / "memorial.hdr_image_list.txt") if line.startswith("memorial")]
    files = [folder / pathlib.Path(r[0]).with_suffix(".png") for r in rows]
    times = [1 / float(r[1]) for r in rows]
    print(f"{'':20} code RMSE  median  (exposures left out)")
    kept, left = list(range(0, len(files), 2)), list(range(1, len(files), 2))
    for name, merge in tools().items():
        with tempfile.TemporaryDirectory() as work:
            radiance, g = merge(program, [files[i] for i in kept], [times[i] for i in kept], pathlib.Path(work))
        errors = []
        for i in left:
            seen = codes(files[i]).astype(np.float64)
            border = np.zeros(seen.shape[:2], bool)  # pure blue: no picture there
            for k in range(len(files)):
                p = codes(files[k])
                border |= (p[..., 2] > 200) & (p[..., 0] < 30) & (p[..., 1] < 30)
            for c in range(3):
                curve = np.maximum.accumulate(g[c]) + np.arange(256) * 1e-9
                # The tools' radiance is in units of their own: the scale that fits the codes best.
                wanted = np.interp(seen[..., c], np.arange(256), curve) - np.log(times[i])
                good = ~border & (seen[..., c] > 10) & (seen[..., c] < 245) & (radiance[..., c] > 0) & np.isfinite(radiance[..., c])
                shift = np.median((wanted - np.log(np.maximum(radiance[..., c], 1e-30)))[good])
                predicted = np.interp(np.log(np.maximum(radiance[..., c], 1e-30)) + shift + np.log(times[i]), curve, np.arange(256))
                errors.append((predicted - seen[..., c])[good])
        e = np.concatenate(errors)
        print(f"{name:20} {np.sqrt(np.mean(e ** 2)):9.2f}  {np.median(np.abs(e)):6.2f}")


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--relamp", default="build/relamp")
parser.add_argument("--scene", type=pathlib.Path)
parser.add_argument("--memorial", type=pathlib.Path)
options = parser.parse_args()
if options.scene:
    scene(options.relamp, options.scene)
if options.memorial:
    memorial(options.relamp, options.memorial)

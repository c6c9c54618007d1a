#!/usr/bin/env python3
"""Submits a relamp sequence to OpenCue (needs its pyoutline and pycue).

    relamp_opencue.py SHOT FRAME.####.exr FIRST-LAST [--chunk 4] [--name JOB] [--cores 4] -- [render options...]

One layer, a frame range cut into chunks. OpenCue's last chunk may run past the end of the range; relamp skips such frames with a
notice. A frame that is killed and retried leaves nothing half written and does not render again what is there.
"""
import argparse
import shlex
import sys


def command(shot, frame, chunk, options):
    """The command of a chunk, as a list; OpenCue puts the chunk's first and last frame in place of its tokens."""
    frames = "#IFRAME#" if chunk == 1 else "#FRAME_START#-#FRAME_END#"
    return ["relamp", "--progress", "none", "render", shot, "-o", frame, "--frames", frames, "--skip-existing"] + options


def main():
    own, _, options = " ".join(map(shlex.quote, sys.argv[1:])).partition(" -- ")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shot")
    parser.add_argument("frame")
    parser.add_argument("range")
    parser.add_argument("--chunk", type=int, default=4)
    parser.add_argument("--name", default="relamp")
    parser.add_argument("--cores", type=int, default=4)
    parser.add_argument("--dry-run", action="store_true", help="print the command, submit nothing")
    args = parser.parse_args(shlex.split(own))
    line = command(args.shot, args.frame, args.chunk, shlex.split(options))
    if args.dry_run:
        print(" ".join(map(shlex.quote, line)))
        return
    import outline
    import outline.cuerun
    import outline.modules.shell
    job = outline.Outline(args.name, frame_range=args.range)
    job.add_layer(outline.modules.shell.Shell("render", command=line, chunk=args.chunk, threads=args.cores, threadable=True, range=args.range))
    outline.cuerun.launch(job, use_pycuerun=False)


if __name__ == "__main__":
    main()

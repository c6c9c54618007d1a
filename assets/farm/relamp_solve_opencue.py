#!/usr/bin/env python3
"""Submits the solves of a list of captures to OpenCue (needs its pyoutline and pycue).

    relamp_solve_opencue.py LIST FOLDER [--name JOB] [--cores 4] -- [solve options...]

One layer, a frame a capture. LIST has a line a capture (relamp solve --list). A frame that is killed and retried goes on from its
checkpoint; shots that are there already are left.
"""
import argparse
import shlex
import sys


def captures(path):
    """How many captures the list names."""
    with open(path, encoding="utf-8") as lines:
        return sum(1 for line in lines if line.strip() and not line.strip().startswith("#"))


def command(path, folder, options):
    """The command of a capture, as a list; OpenCue puts the frame's number in place of its token."""
    return ["relamp", "--progress", "none", "solve", "--list", path, "-o", folder, "--items", "#IFRAME#", "--skip-existing",
            "--resume"] + options


def main():
    words = sys.argv[1:]
    at = words.index("--") if "--" in words else len(words)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("list")
    parser.add_argument("folder")
    parser.add_argument("--name", default="relamp-solve")
    parser.add_argument("--cores", type=int, default=4)
    parser.add_argument("--dry-run", action="store_true", help="print the range and the command, submit nothing")
    args = parser.parse_args(words[:at])
    count = captures(args.list)
    if count == 0:
        parser.error(f"{args.list}: names no capture")
    line = command(args.list, args.folder, words[at + 1:])
    if args.dry_run:
        print(f"1-{count}", " ".join(map(shlex.quote, line)))
        return
    import outline
    import outline.cuerun
    import outline.modules.shell
    job = outline.Outline(args.name, frame_range=f"1-{count}")
    job.add_layer(outline.modules.shell.Shell("solve", command=line, chunk=1, threads=args.cores, threadable=True, range=f"1-{count}"))
    outline.cuerun.launch(job, use_pycuerun=False)


if __name__ == "__main__":
    main()

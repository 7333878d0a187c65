#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes GlassRooms of many sizes and lets `dataset check` look at each: it must find nothing.

Prints what it said of each faulty room and a table of how many rooms had findings. Rooms that lie
under --out already are not made again. Exit code 1 when any room had a finding.

    scripts/sweep_check.py build/release/bin/glint-bench --out /tmp/rooms --spp 1 --seeds 3 4
"""
import argparse
import itertools
import pathlib
import subprocess
import sys


def arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="glint-bench")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the rooms")
    parser.add_argument("--rooms", nargs="+", default=[f"room_{i}" for i in range(1, 6)])
    parser.add_argument("--seeds", nargs="+", type=int, default=[0, 1, 2, 3])
    parser.add_argument("--sizes", nargs="+", default=["32x18", "64x36", "160x90"])
    parser.add_argument("--views", nargs="+", type=int, default=[3, 9, 24])
    parser.add_argument("--spp", nargs="+", type=int, default=[1, 4, 16])
    return parser.parse_args()


def made(program, out, room, seed, size, views, spp):
    """The folder of a room, or None when this layout cannot be made (which is no finding)."""
    folder = out / f"{room}_{seed}_{size}_{views}_{spp}"
    if (folder / "scene.json").exists():
        return folder
    width, height = size.split("x")
    options = ["--scene", room, "--seed", seed, "--width", width, "--height", height,
               "--views", views, "--spp", spp, "--out", folder, "--quiet"]
    result = subprocess.run([program, "dataset", "make", "glassroom", *map(str, options)],
                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if result.returncode != 0:
        print(f"not made: {folder.name}: {result.stderr.strip().splitlines()[-1]}")
        return None
    return folder


def findings(program, folder):
    result = subprocess.run([program, "dataset", "check", str(folder), "--quiet"],
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return result.stdout.strip() if result.returncode != 0 else ""


def print_table(counts, sizes, views):
    print("rooms with findings / rooms, by size and number of views")
    print("| size |" + "".join(f" {v} views |" for v in views))
    print("|---|" + "---|" * len(views))
    for size in sizes:
        cells = ["{}/{}".format(*counts[size, v]) for v in views]
        print(f"| {size} | " + " | ".join(cells) + " |")


def main():
    args = arguments()
    counts = {key: [0, 0] for key in itertools.product(args.sizes, args.views)}
    cells = itertools.product(args.sizes, args.views, args.spp, args.seeds, args.rooms)
    for size, views, spp, seed, room in cells:
        folder = made(args.program, args.out, room, seed, size, views, spp)
        if folder is None:
            continue
        said = findings(args.program, folder)
        counts[size, views][0] += bool(said)
        counts[size, views][1] += 1
        if said:
            print(f"{folder.name}:\n{said}", flush=True)
    print_table(counts, args.sizes, args.views)
    return 1 if any(bad for bad, _ in counts.values()) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Scores runs within the inner case of `nested_1`: PSNR, and AbsRel of the second and third layer.

    scripts/inner_case.py ROOM RUN...

ROOM is the folder of the dataset, RUN a folder that `glint-bench train` or `all --keep` left. Its pixels are those
of test views whose second layer is a pane of the inner case; views with fewer than 20 of them are left out.
Mean over pixels of a view, then over views. A method without layers gives what it has farthest: the depth behind
glass, else depth. Needs the Python module (PYTHONPATH=build/release/python) and NumPy.
"""
import argparse
import json
import pathlib

import glint_bench
import numpy as np
from truth_maps import plane, world_points

SLACK = 0.02  # metres around the case: its panes' thickness and the maps' rounding
LEAST = 20  # pixels of a view that counts


def points_in_case(points, case):
    """Which of the points [H][W][3] in the world lie in or on the container of scene.json."""
    half = np.array(case["size"]) / 2
    local = (points - np.array(case["pose"]["translation"])) @ np.array(case["pose"]["rotation_world_from_local"])
    local[..., 2] -= half[2]  # its origin is the middle of its floor
    return (np.abs(local) < half + SLACK).all(-1)


def inner_pixels(view, case):
    depth = plane(view.truth, "layer_2_depth")
    is_glass = plane(view.truth, "layer_2_glass") > 0.5
    return is_glass & (depth > 0) & points_in_case(world_points(view.camera, depth), case)


def scores(view, maps, mask):
    """PSNR (dB), AbsRel of layers 2 and 3."""
    behind = ("behind_depth", "depth")
    layers = [
        glint_bench.depth(plane(maps, f"layer_{k}_depth", *behind), plane(view.truth, f"layer_{k}_depth"), mask)
        for k in (2, 3)
    ]
    psnr = glint_bench.psnr(np.clip(maps["rgb"], 0, 1), view.image, mask)
    return [psnr["mean"]["psnr"]] + [layer["mean"]["depth-absrel"] for layer in layers]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("room", type=pathlib.Path)
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    options = parser.parse_args()

    facts = json.loads((options.room / "scene.json").read_text(encoding="utf-8"))
    if "inner_container" not in facts:
        raise SystemExit(f"{options.room}/scene.json: no inner_container; expected a room like nested_1")
    masks = [(view, inner_pixels(view, facts["inner_container"])) for view in glint_bench.load_scene(options.room).test]
    masks = [(view, mask) for view, mask in masks if mask.sum() >= LEAST]
    if not masks:
        raise SystemExit(f"{options.room}: no test view has {LEAST} pixels within the inner case")
    print("| run | views | pixels | PSNR (dB) | layer 2 | layer 3 |\n|---|---:|---:|---:|---:|---:|")
    for folder in options.runs:
        run = glint_bench.load_run(folder, options.room)
        psnr, second, third = np.mean([scores(view, run.render(view), mask) for view, mask in masks], axis=0)
        pixels = sum(mask.sum() for _, mask in masks)
        print(f"| {'/'.join(folder.parts[-3:])} | {len(masks)} | {pixels} | {psnr:.2f} | {second:.3f} | {third:.3f} |")


if __name__ == "__main__":
    main()

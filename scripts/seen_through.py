#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Are reflections baked into what stands behind glass? PSNR of runs by what training views see through glass.

    scripts/seen_through.py ROOM RUN... [--picture FILE --views NAME...]

ROOM is the folder of a dataset with true depth, glass and depth behind it; RUN a folder that `glint-bench train` or
`all` left. Pixels of test views that are not glass fall into parts by the share, of the training views that see their
surface, that see it through glass. A method without reflections can give that surface the colour of what the pane
mirrors before it, and training views, which seldom see it bare, hardly object; test views that see it bare do. PSNR is
of the mean squared error of all pixels of a part, of colours clipped to [0, 1]. --picture: a row for each of the
views, its photo, then its render by each run. Needs the Python module (PYTHONPATH=build/release/python), NumPy, and
for the picture Pillow.
"""
import argparse
import pathlib

import glint_bench
import numpy as np
from truth_maps import plane, world_points

SAME = 0.03  # of the depth: two views see one surface
# Title of a part, and its shares of views: above the first, at most the second.
PARTS = [("never", -1, 0), ("to 1/3", 0, 1 / 3), ("to 2/3", 1 / 3, 2 / 3), ("above", 2 / 3, 1)]


def is_glass(view):
    return plane(view.truth, "glass") > 0.5


def views_of(points, views):
    """How many of the views see each point [H][W][3] bare, and how many through glass: [H][W] each."""
    bare, through = np.zeros(points.shape[:2], int), np.zeros(points.shape[:2], int)
    for view in views:
        x, y, z = np.moveaxis(view.camera.project(points.reshape(-1, 3)).reshape(points.shape), -1, 0)
        with np.errstate(invalid="ignore"):
            inside = (z > 0) & (x >= 0) & (x < view.camera.width) & (y >= 0) & (y < view.camera.height)
        column, row = np.where(inside, x, 0).astype(int), np.where(inside, y, 0).astype(int)
        glass = is_glass(view)[row, column]
        depth = np.where(glass, plane(view.truth, "behind_depth")[row, column], plane(view.truth, "depth")[row, column])
        seen = inside & (np.abs(depth - z) < SAME * z)
        bare += seen & ~glass
        through += seen & glass
    return bare, through


def parts_of(view, train):
    """Masks [H][W] by title: glass, then the parts of what is not."""
    glass, depth = is_glass(view), plane(view.truth, "depth")
    bare, through = views_of(world_points(view.camera, depth), train)
    counted = ~glass & (depth > 0) & (bare + through > 0)
    share = through / np.maximum(bare + through, 1)
    return {"glass": glass} | {title: counted & (share > low) & (share <= high) for title, low, high in PARTS}


def squared_errors(run, views):
    """[H][W] of each view, mean of the channels."""
    return [np.square(np.clip(run.render(view)["rgb"], 0, 1) - view.image).mean(-1) for view in views]


def psnr(errors, masks):
    values = np.concatenate([error[mask] for error, mask in zip(errors, masks)])
    return f"{-10 * np.log10(values.mean()):.2f}" if values.size else "-"


def named_views(scene, names):
    """The views of these names; ends the program where the scene lacks one."""
    views = {view.name: view for view in [*scene.train, *scene.test]}
    unknown = sorted(set(names) - set(views))
    if unknown:
        raise SystemExit(f"--views: no view {', '.join(unknown)}; expected names such as {', '.join(list(views)[:3])}")
    return [views[name] for name in names]


def picture(views, runs):
    """uint8 [H][W][3]: rows of views, columns of the photo and of the runs."""
    rows = [np.concatenate([view.image, *(run.render(view)["rgb"] for run in runs)], 1) for view in views]
    return (255 * np.clip(np.concatenate(rows), 0, 1) + 0.5).astype(np.uint8)


def write_picture(path, values):
    """To a temporary name, then renamed."""
    from PIL import Image

    temporary = path.with_stem(path.stem + ".tmp")
    Image.fromarray(values).save(temporary, quality=90)
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("room", type=pathlib.Path)
    parser.add_argument("runs", type=pathlib.Path, nargs="+")
    parser.add_argument("--picture", type=pathlib.Path, help="file of a format that Pillow knows by its ending")
    parser.add_argument("--views", nargs="+", default=[], help="names of views that it shows")
    options = parser.parse_args()
    if bool(options.picture) != bool(options.views):
        parser.error("--picture and --views belong together: the file, and the names of the views in it")

    scene = glint_bench.load_scene(options.room)
    lacks = {"depth", "glass", "behind_depth"} - set(scene.test[0].truth)
    if lacks:
        raise SystemExit(f"{options.room}: no true {', '.join(sorted(lacks))}; expected a room with both layers of glass")
    shown = named_views(scene, options.views)
    parts = [parts_of(view, scene.train) for view in scene.test]
    titles = list(parts[0])
    print(f"| run | {' | '.join(titles)} |\n|---|{'---:|' * len(titles)}")
    shares = [np.mean([part[title].mean() for part in parts]) for title in titles]
    print(f"| share of pixels (%) | {' | '.join(f'{100 * share:.1f}' for share in shares)} |")
    runs = [glint_bench.load_run(folder, options.room) for folder in options.runs]
    for folder, run in zip(options.runs, runs):
        errors = squared_errors(run, scene.test)
        values = [psnr(errors, [part[title] for part in parts]) for title in titles]
        print(f"| {'/'.join(folder.parts[-3:])} | {' | '.join(values)} |")
    if options.picture:
        write_picture(options.picture, picture(shown, runs))


if __name__ == "__main__":
    main()

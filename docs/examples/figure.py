# SPDX-License-Identifier: MIT
"""Draws a test view with matplotlib: truth, render and error; depth and normals beside the true ones.

    build/release/bin/glint-bench dataset make glassroom --scene room_1 --width 128 --height 72 --out data/room_1
    PYTHONPATH=build/release/python python3 docs/examples/figure.py data/room_1 --iterations 2000

Needs matplotlib (Debian: python3-matplotlib).
"""

import argparse
import sys

import numpy as np

import glint_bench

try:
    import matplotlib
except ImportError:
    print("needs matplotlib", file=sys.stderr)
    sys.exit(77)
matplotlib.use("Agg")  # no display
from matplotlib import pyplot

parser = argparse.ArgumentParser()
parser.add_argument("dataset")
parser.add_argument("--run", help="folder of a run; else one is trained in memory")
parser.add_argument("--method", default="2dgs")
parser.add_argument("--iterations", type=int, default=2000)
parser.add_argument("--out", default="figure.png")
options = parser.parse_args()

if options.run:
    run = glint_bench.load_run(options.run, options.dataset)
else:
    run = glint_bench.train(options.dataset, options.method, iterations=options.iterations)

# The view with the most glass.
view = max(run.scene.test, key=lambda view: view.truth["glass"].sum() if "glass" in view.truth else 0)
maps = run.render(view)
render = np.clip(maps["rgb"], 0, 1)
error = np.abs(render - view.image).mean(axis=-1)
psnr = glint_bench.psnr(maps["rgb"], view.image)["mean"]["psnr"]

panels = [("photo", view.image), (f"{run.method}, {psnr:.2f} dB", render), ("error", error)]
if "depth" in view.truth:
    absrel = glint_bench.depth(maps["depth"], view.truth["depth"])["mean"]["depth-absrel"]
    panels += [("true depth (m)", view.truth["depth"]), (f"depth (m), AbsRel {absrel:.3f}", maps["depth"])]
if "normal" in view.truth:
    panels += [("normal", maps["normal"])]

columns = 3
rows = -(-len(panels) // columns)
height, width = view.image.shape[:2]
figure, axes = pyplot.subplots(
    rows, columns, figsize=(3 * columns, rows * (2.6 * height / width + 0.25)), layout="constrained", squeeze=False
)
farthest = np.percentile(view.truth["depth"], 99) if "depth" in view.truth else None
for axis in axes.flat:
    axis.axis("off")
for axis, (title, panel) in zip(axes.flat, panels):
    axis.set_title(title, fontsize=9)
    if title == "error":
        drawn = axis.imshow(panel, cmap="magma", vmin=0, vmax=0.25)
    elif "depth" in title:
        missing = np.where(panel[..., 0] > 0, panel[..., 0], np.nan)
        drawn = axis.imshow(missing, cmap="viridis_r", vmin=0, vmax=farthest)
    elif title == "normal":
        axis.imshow(0.5 + 0.5 * panel * np.float32([1, -1, -1]))  # as people know them: y up, z to the viewer
        continue
    else:
        axis.imshow(panel)
        continue
    figure.colorbar(drawn, ax=axis, shrink=0.8).ax.tick_params(labelsize=7)
figure.savefig(options.out, dpi=150)
print(f"{options.out}: view {view.name} of {run.scene.name}, {options.iterations if not options.run else run.iterations} steps")

# SPDX-License-Identifier: MIT
"""Trains a method and scores the test views every few hundred steps: in the picture, and where the glass is.

    build/release/bin/glint-bench dataset make glassroom --scene room_1 --width 128 --height 72 --out data/room_1
    PYTHONPATH=build/release/python python3 docs/examples/score_while_training.py data/room_1 --iterations 2000
"""

import argparse

import numpy as np

import glint_bench

parser = argparse.ArgumentParser()
parser.add_argument("dataset")
parser.add_argument("--method", default="2dgs")
parser.add_argument("--iterations", type=int, default=2000)
options = parser.parse_args()

scene = glint_bench.load_scene(options.dataset)
print(scene)


def score(step, run):
    """Called with the numbers of a step and the run, which can be rendered."""
    views = run.scene.test
    renders = [run.render(view)["rgb"] for view in views]
    images = [view.image for view in views]
    glass = [view.truth.get("glass", np.zeros((*view.image.shape[:2], 1), np.float32)) for view in views]
    psnr = glint_bench.psnr(renders, images, glass=glass)["mean"]
    ssim = glint_bench.ssim(renders, images)["mean"]
    print(
        f"step {step['iteration'] + 1:5}: loss {step['loss']:.4f}, {step['num_surfels']} surfels, "
        f"PSNR {psnr['psnr']:.2f} dB, on glass {psnr.get('psnr@glass', float('nan')):.2f} dB, "
        f"SSIM {ssim['ssim-3dgs']:.4f}"
    )


run = glint_bench.train(
    scene,
    options.method,
    iterations=options.iterations,
    callback=score,
    callback_every=max(1, options.iterations // 4),
)

# Every metric that the method's maps and the scene's truth allow, as `glint-bench eval` has them.
view = scene.test[0]
scores = glint_bench.score_view(run.render(view), view)["metrics"]
for name in ("psnr", "psnr@glass", "depth-absrel", "depth-absrel@glass", "normal-mae", "behind-absrel"):
    if name in scores:
        print(f"{view.name}: {name} {scores[name]:.4f}")

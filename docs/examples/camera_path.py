# SPDX-License-Identifier: MIT
"""Renders a camera path of your own: a slow turn about what the first test view looks at, written as NPY and PPM.

    build/release/bin/glint-bench dataset make glassroom --scene room_1 --width 128 --height 72 --out data/room_1
    PYTHONPATH=build/release/python python3 docs/examples/camera_path.py data/room_1 --iterations 2000
"""

import argparse
import pathlib

import numpy as np

import glint_bench
from glint_bench import Camera

parser = argparse.ArgumentParser()
parser.add_argument("dataset")
parser.add_argument("--run", help="folder of a run; else one is trained in memory")
parser.add_argument("--method", default="2dgs")
parser.add_argument("--iterations", type=int, default=2000)
parser.add_argument("--frames", type=int, default=8)
parser.add_argument("--out", default="path")
options = parser.parse_args()

if options.run:
    run = glint_bench.load_run(options.run, options.dataset)
else:
    run = glint_bench.train(options.dataset, options.method, iterations=options.iterations)

# What the first test view has in its middle: the true depth there, else the scene's middle.
view = run.scene.test[0]
camera = view.camera
right, down, forward = camera.rotation_cam_from_world
if "depth" in view.truth:
    target = camera.center + float(view.truth["depth"][camera.height // 2, camera.width // 2, 0]) * forward
else:
    target = (run.scene.bounds_min + run.scene.bounds_max) / 2
fov_x_deg = np.degrees(2 * np.arctan(camera.width / (2 * camera.fx)))

# A tenth of the distance to either side and up and down.
reach = 0.1 * np.linalg.norm(target - camera.center)
folder = pathlib.Path(options.out)
folder.mkdir(parents=True, exist_ok=True)
for frame, angle in enumerate(np.linspace(0, 2 * np.pi, options.frames, endpoint=False)):
    eye = camera.center + reach * (np.cos(angle) * right + np.sin(angle) * down)
    moved = Camera.look_at(eye, target, -down, width=camera.width, height=camera.height, fov_x_deg=fov_x_deg)
    maps = run.render(moved)
    np.save(folder / f"{frame:04}_depth.npy", maps["depth"])  # [H][W][1], planar z, metres
    pixels = np.rint(np.clip(maps["rgb"], 0, 1) * 255).astype(np.uint8)
    (folder / f"{frame:04}.ppm").write_bytes(b"P6 %d %d 255\n" % (camera.width, camera.height) + pixels.tobytes())
    print(f"{folder}/{frame:04}.ppm: {moved}")

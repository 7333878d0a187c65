"""GLINT Bench for Python: scores, scenes, trainings and records as arrays and dicts.

Arrays are NumPy float32 in C order, images [H][W][C]: rows first, channels last, values as displayed
(sRGB-encoded) in [0, 1]. Depth is planar z in metres, normals are unit and in camera space (x right,
y down, z forward). Every number comes from the code of the programs, to the last digit.

    import glint_bench

    scene = glint_bench.load_scene("data/glassroom/room_1")
    run = glint_bench.train(scene, "2dgs", iterations=2000)
    for view in scene.test:
        print(view.name, glint_bench.psnr(run.render(view)["rgb"], view.image)["mean"])

Scores: psnr, ssim, lpips, depth, normal, mesh, glass, score_view.
Scenes, runs: load_scene, load_run, load_model, train, Camera, View, Scene, Run.
Records: read_records. Process: set_device, set_threads, set_quiet, methods.
Errors: GlintError. Warnings: GlintWarning.
"""

from ._errors import GlintError, GlintWarning
from ._glint_bench import Camera, Run, Scene, View, methods, set_device, set_quiet, set_threads
from ._metrics import depth, glass, lpips, mesh, normal, psnr, score_view, ssim
from ._runs import load_model, load_run, load_scene, read_records, train

__all__ = [
    "Camera",
    "GlintError",
    "GlintWarning",
    "Run",
    "Scene",
    "View",
    "depth",
    "glass",
    "load_model",
    "load_run",
    "load_scene",
    "lpips",
    "mesh",
    "methods",
    "normal",
    "psnr",
    "read_records",
    "score_view",
    "set_device",
    "set_quiet",
    "set_threads",
    "ssim",
    "train",
]

for _name in ("Camera", "Run", "Scene", "View", "methods", "set_device", "set_quiet", "set_threads"):
    globals()[_name].__module__ = __name__
for _class in (GlintError, GlintWarning):
    _class.__module__ = __name__

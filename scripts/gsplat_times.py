# SPDX-License-Identifier: MIT
"""Times gsplat's 2DGS on the scene that `glint-bench perf --write-scene` wrote: forward, forward + backward, both from
and to the raw parameters (activation and spherical harmonics inside, as `perf`'s "activate, SH, rasterize ..."), and
a training step (L1, Adam; with and without SSIM), by CUDA events, median of the runs. For gsplat_check.sh.

    python3 gsplat_times.py SCENE_FOLDER RUNS        one JSON object on standard output
"""
import json
import os
import statistics
import sys

import numpy
import torch
from gsplat import rasterization_2dgs
from gsplat.cuda import _wrapper

SH_DEGREE = 3
MIN_SCALE = 1e-6  # of the disc's normal, which gsplat wants and does not use
# As in the 2DGS paper's code.
RATES = {"means": 1.6e-4, "sh_dc": 2.5e-3, "sh_rest": 1.25e-4, "opacity": 5e-2, "scale": 5e-3, "rotation": 1e-3}


def read_surfels(path):
    """The raw parameters, all float32 in one row a surfel (glint/scene/ply.h)."""
    with open(path, "rb") as file:
        names, count = [], 0
        while (line := file.readline().decode().strip()) != "end_header":
            words = line.split()
            if words[:2] == ["element", "vertex"]:
                count = int(words[2])
            elif words[0] == "property":
                names.append(words[2])
        rows = numpy.fromfile(file, "<f4", count * len(names)).reshape(count, len(names))

    def columns(*wanted):
        return torch.from_numpy(rows[:, [names.index(name) for name in wanted]].copy())

    rest = columns(*(f"f_rest_{i}" for i in range(45)))
    return {
        "means": columns("x", "y", "z"),
        "sh_dc": columns("f_dc_0", "f_dc_1", "f_dc_2")[:, None, :],
        "sh_rest": rest.reshape(count, 3, 15).transpose(1, 2).contiguous(),  # colours last
        "opacity": columns("opacity")[:, 0],
        "scale": columns("scale_0", "scale_1"),
        "rotation": columns("rot_0", "rot_1", "rot_2", "rot_3"),
    }


class Scene:
    def __init__(self, folder):
        with open(os.path.join(folder, "camera.json")) as file:
            camera = json.load(file)
        self.width, self.height = camera["width"], camera["height"]
        view = torch.eye(4)
        view[:3] = torch.tensor(camera["cam_from_world"])
        k = torch.tensor([[camera["fx"], 0, camera["cx"]], [0, camera["fy"], camera["cy"]], [0, 0, 1]])
        self.view, self.k = view[None].cuda(), k[None].cuda()
        surfels = read_surfels(os.path.join(folder, "surfels.ply"))
        self.surfels = {name: value.cuda().requires_grad_() for name, value in surfels.items()}
        generator = torch.Generator().manual_seed(2)
        target = torch.rand((1, self.height, self.width, 3), generator=generator)
        self.target = (0.3 + 0.3 * target).cuda()

    def render(self):
        s = self.surfels
        scales = torch.cat([s["scale"].exp(), torch.full_like(s["scale"][:, :1], MIN_SCALE)], dim=1)
        return rasterization_2dgs(
            s["means"],
            s["rotation"],
            scales,
            s["opacity"].sigmoid(),
            torch.cat([s["sh_dc"], s["sh_rest"]], dim=1),
            self.view,
            self.k,
            self.width,
            self.height,
            near_plane=0.2,
            sh_degree=SH_DEGREE,
            render_mode="RGB+D",
        )


def ssim(x, y):
    """Mean SSIM of [1, H, W, 3] by an 11x11 Gaussian window, as two passes of a convolution."""
    offsets = torch.arange(11, device=x.device) - 5.0
    line = torch.exp(-(offsets**2) / (2 * 1.5**2))
    line = line / line.sum()

    def blur(image):
        wide = torch.nn.functional.conv2d(image, line.view(1, 1, 1, 11).expand(3, 1, 1, 11), padding=(0, 5), groups=3)
        return torch.nn.functional.conv2d(wide, line.view(1, 1, 11, 1).expand(3, 1, 11, 1), padding=(5, 0), groups=3)

    x, y = x.permute(0, 3, 1, 2), y.permute(0, 3, 1, 2)
    mean_x, mean_y = blur(x), blur(y)
    var_x, var_y = blur(x * x) - mean_x**2, blur(y * y) - mean_y**2
    covariance = blur(x * y) - mean_x * mean_y
    c1, c2 = 0.01**2, 0.03**2
    top = (2 * mean_x * mean_y + c1) * (2 * covariance + c2)
    return (top / ((mean_x**2 + mean_y**2 + c1) * (var_x + var_y + c2))).mean()


def accept_columns():
    """gsplat 90d7b4b3 refuses its own gradient of depths, a column of another array ("grad.depths must be contiguous");
    a copy of it, one kernel more."""
    call = _wrapper._make_lazy_cuda_func

    def with_copies(name):
        function = call(name)
        return lambda *args, **kwargs: function(*[a.contiguous() if isinstance(a, torch.Tensor) else a for a in args], **kwargs)

    _wrapper._make_lazy_cuda_func = with_copies


def median_ms(body, runs):
    times = []
    for run in range(runs + 3):  # three to warm up
        begin, end = torch.cuda.Event(enable_timing=True), torch.cuda.Event(enable_timing=True)
        begin.record()
        body()
        end.record()
        end.synchronize()
        if run >= 3:
            times.append(begin.elapsed_time(end))
    return statistics.median(times)


def main(folder, runs):
    accept_columns()
    scene = Scene(folder)
    adam = torch.optim.Adam([{"params": [scene.surfels[name]], "lr": rate} for name, rate in RATES.items()], eps=1e-15, fused=True)

    def forward():
        with torch.no_grad():
            scene.render()

    def backward():
        image, alpha, normal, *_ = scene.render()
        (image.sum() + alpha.sum() + normal.sum()).backward()
        adam.zero_grad(set_to_none=True)

    def step(with_ssim):
        image = scene.render()[0][..., :3]
        loss = 0.8 * (image - scene.target).abs().mean()
        if with_ssim:
            loss = loss + 0.2 * (1 - ssim(image, scene.target))
        loss.backward()
        adam.step()
        adam.zero_grad(set_to_none=True)

    with torch.no_grad():
        image = scene.render()[0][..., :3]
    result = {
        "device": torch.cuda.get_device_name(),
        "torch": torch.__version__,
        "width": scene.width,
        "height": scene.height,
        "surfels": len(scene.surfels["means"]),
        "mean_colour": image.mean(dim=(0, 1, 2)).tolist(),
        "forward_ms": median_ms(forward, runs),
        "forward_backward_ms": median_ms(backward, runs),
        "step_l1_ms": median_ms(lambda: step(False), runs),
        "step_l1_ssim_ms": median_ms(lambda: step(True), runs),
    }
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))

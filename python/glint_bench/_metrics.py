"""Scores of arrays, by the code of the programs glint-psnr, glint-ssim, ... and of `glint-bench eval`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np

from . import _glint_bench

Images = Union[np.ndarray, Sequence[np.ndarray]]
Surface = Union[np.ndarray, "tuple[np.ndarray, np.ndarray]"]


def psnr(
    render: Images,
    truth: Images,
    mask: Images | None = None,
    glass: Images | None = None,
    *,
    eight_bit: bool = False,
) -> dict[str, Any]:
    """Peak signal-to-noise ratio in dB, as glint-psnr --json prints it.

    render, truth: float32 [H][W][3] in [0, 1], or lists of as many; the render is clamped
    mask: [H][W] bool, uint8 or float32, pixels that count; one for all, or a list
    glass: the same, pixels that are glass: the regions glass, glass-border and opaque are scored, too
    eight_bit: the render is rounded to n / 255 first, as a saved PNG is ("psnr-8bit")

    Returns {"mean": {"psnr": dB, "psnr@glass": ...}, "images": [{"metrics": ..., "warnings": ...}],
    "protocol": {"psnr": ...}, "summary": {"num_identical": ...}, ...}.
    """
    return _score("psnr", "render", render, truth, mask, glass, [], 1 if eight_bit else 0)


def ssim(
    render: Images,
    truth: Images,
    mask: Images | None = None,
    glass: Images | None = None,
    *,
    variant: str = "3dgs",
) -> dict[str, Any]:
    """Structural similarity, as glint-ssim --json prints it.

    render, truth: float32 [H][W][3] in [0, 1], or lists of as many
    mask, glass: as psnr() has them, [H][W]
    variant: "3dgs" (zeros outside the image), "wang" (where the window lies inside) or "all"

    Returns psnr()'s dict with "ssim-3dgs", "ssim-wang".
    """
    return _score("ssim", "render", render, truth, mask, glass, ["--variant", variant])


def lpips(
    render: Images,
    truth: Images,
    mask: Images | None = None,
    glass: Images | None = None,
    *,
    weights: str | None = None,
    net: str | None = None,
    range: str = "lpips",
) -> dict[str, Any]:
    """LPIPS 0.1, as glint-lpips --json prints it; small: alike.

    render, truth: float32 [H][W][3] in [0, 1], or lists of as many (one network for all)
    mask, glass: as psnr() has them, [H][W]
    weights: file or folder; else GLINT_LPIPS_WEIGHTS, then ~/.cache/glint-bench/lpips
        (scripts/fetch_lpips_weights.sh)
    net: "alex" or "vgg"; else the file's, or "alex"
    range: "lpips" (the network is fed [-1, 1]) or "3dgs" ([0, 1], as 3DGS does)

    Returns psnr()'s dict with "lpips-alex", ...
    """
    args = ["--range", range]
    args += ["--weights", str(weights)] if weights is not None else []
    args += ["--net", net] if net is not None else []
    return _score("lpips", "render", render, truth, mask, glass, args)


def depth(
    prediction: Images,
    truth: Images,
    mask: Images | None = None,
    glass: Images | None = None,
    *,
    align: str = "none",
    max_depth: float | None = None,
    release: bool = False,
    ray: Sequence[float] | None = None,
) -> dict[str, Any]:
    """Errors of depth maps, as glint-depth --json prints them.

    prediction, truth: float32 [H][W] or [H][W][1], planar z in metres; 0 or not finite: no depth; or
        lists of as many
    mask, glass: as psnr() has them, [H][W]
    align: "none", or a fit for each image: "median", "scale", "affine"
    max_depth: metres; depths at or beyond do not exist
    release: the official release: median scale, below 20 m, holes skipped
    ray: fx, fy, cx, cy in pixels: the prediction holds distances along rays, not planar z

    Returns psnr()'s dict with "depth-absrel", "depth-rmse" (metres), "depth-delta1" (%),
    "depth-coverage" (%).
    """
    args = ["--align", align] if align != "none" else []
    args += ["--max-depth", repr(float(max_depth))] if max_depth is not None else []
    args += ["--release"] if release else []
    args += ["--ray", *(repr(float(number)) for number in ray)] if ray is not None else []
    return _score("depth", "prediction", prediction, truth, mask, glass, args)


def normal(
    prediction: Images,
    truth: Images,
    mask: Images | None = None,
    glass: Images | None = None,
    *,
    axes: str = "opencv",
    reference_axes: str = "opencv",
) -> dict[str, Any]:
    """Angles between normal maps in degrees, as glint-normal --json prints them.

    prediction, truth: float32 [H][W][3], unit, camera space; zero: no normal; or lists of as many
    mask, glass: as psnr() has them, [H][W]
    axes, reference_axes: of either side: "opencv" (x right, y down, z forward), "opengl" (x right, y up,
        z to the viewer) or "stablenormal" (x left, y up, z to the viewer)

    Returns psnr()'s dict with "normal-mae", "normal-median" (degrees), shares below angles (%), ...
    """
    args = ["--axes", axes, "--reference-axes", reference_axes]
    return _score("normal", "prediction", prediction, truth, mask, glass, args)


def mesh(
    prediction: Surface,
    truth: Surface,
    cameras: Sequence[_glint_bench.Camera] = (),
    *,
    samples: int = 1_000_000,
    seed: int = 0,
    thresholds: Sequence[float] = (0.01, 0.02, 0.05, 0.1),
    distance: str = "point-to-triangle",
    max_distance: float = 0,
    tolerance: float = 0.02,
    max_edge: float = 0.2,
) -> dict[str, Any]:
    """Chamfer distance, precision, recall, F1 and agreement of normals, as glint-mesh --json prints them.

    prediction, truth: (vertices float32 [N][3] in metres, faces integer [M][3]), or points float32 [N][3]
    cameras: faces that none of them sees are left out of both; none: nothing is
    samples: points on either surface; seed: of them
    thresholds: metres, of precision, recall and F1
    distance: "point-to-triangle" (exact) or "point-to-point" (nearest sample)
    max_distance: metres; larger distances are set to it; 0: no limit
    tolerance, max_edge: metres, of leaving out what no camera sees

    Returns {"metrics": {"mesh-cd": metres, "mesh-f1@5cm": ...}, "protocol": ..., "curve": ..., ...}.
    """
    protocol = {
        "num_samples": int(samples),
        "seed": int(seed),
        "thresholds_m": [float(metres) for metres in thresholds],
        "distance": distance,
        "max_distance_m": float(max_distance),
        "cull_tolerance_m": float(tolerance),
        "cull_max_edge_m": float(max_edge),
    }
    return _glint_bench.score_mesh(prediction, truth, list(cameras), json.dumps(protocol))


def score_view(
    rendered: Mapping[str, np.ndarray],
    truth: Mapping[str, np.ndarray] | _glint_bench.View,
    counted: np.ndarray | None = None,
) -> dict[str, Any]:
    """Every metric that both sides have the maps for, as `glint-bench eval` scores a view.

    rendered: {id: float32 [H][W][C]}, as Run.render() gives them
    truth: a View, or {id: array} with "rgb" [H][W][3] as displayed, "depth" [H][W][1] in metres, "normal"
        [H][W][3], "glass" [H][W][1] 0 or 1, ...; with "glass" the regions are scored, too
    counted: of a dict, [H][W]: pixels that count; a View has its own

    Returns {"metrics": {"psnr": dB, "depth-absrel@glass": ..., "transparency-iou": ...}, "protocol": ...}.
    """
    if not isinstance(truth, _glint_bench.View):
        truth = dict(truth)
    return _glint_bench.score_view(dict(rendered), truth, counted)


def glass(
    rendered: Mapping[str, np.ndarray],
    truth: Mapping[str, np.ndarray] | _glint_bench.View,
    counted: np.ndarray | None = None,
) -> dict[str, Any]:
    """What of score_view() is about glass: whether it is found, what is behind it, scores by region.

    rendered, truth, counted: as score_view() has them, arrays [H][W][C]; the truth needs "glass" [H][W][1]

    Returns {"metrics": {"transparency-iou": ..., "behind-absrel": ..., "psnr@glass": dB, ...}, "protocol": ...}.
    """
    scores = score_view(rendered, truth, counted)
    anywhere = ("psnr", "ssim", "lpips", "depth", "normal")
    metrics = {
        name: value
        for name, value in scores["metrics"].items()
        if "@" in name or name.split("-")[0] not in anywhere
    }
    plain = {name.split("@")[0] for name in metrics}
    return {
        "metrics": metrics,
        "protocol": {name: text for name, text in scores["protocol"].items() if name in plain},
    }


def _listed(images: Images | None) -> list[Any]:
    if images is None:
        return []
    return list(images) if isinstance(images, (list, tuple)) else [images]


def _score(
    tool: str,
    name: str,
    prediction: Images,
    truth: Images,
    mask: Images | None,
    glass_mask: Images | None,
    args: list[str],
    family: int = 0,
) -> dict[str, Any]:
    predictions, truths = _listed(prediction), _listed(truth)
    masks, glasses = _listed(mask), _listed(glass_mask)
    if not predictions or len(predictions) != len(truths):
        raise ValueError(f"{name}: {len(predictions)}, truth: {len(truths)} images; expected as many, and one at least")
    for side, given in (("mask", masks), ("glass", glasses)):
        if len(given) not in (0, 1, len(predictions)):
            raise ValueError(f"{side}: {len(given)} for {len(predictions)} images; expected one, or one for each")
    return _glint_bench.score_arrays(tool, (name, "truth"), predictions, truths, masks, glasses, args, family)

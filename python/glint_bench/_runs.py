"""Scenes, runs, trainings and records."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from typing import Any, Union

from . import _glint_bench
from ._glint_bench import Run, Scene

Path = Union[str, "os.PathLike[str]"]


def load_scene(
    folder: Path,
    *,
    max_pixels: float = 0,
    image_ratio: float = 1,
    loader: str = "",
    background: str = "",
) -> Scene:
    """A dataset: folder or packed file, of any format that `glint-bench dataset info` knows.

    max_pixels: images are shrunk until height x width is below; 0: as stored
    image_ratio: or both sides are shrunk to this share
    loader: id of the loader; "": the surest
    background: what is made of alpha: "black", "white", "mask" or "stored"; "": as the data say

    Views have images float32 [H][W][3] as displayed, in [0, 1], and maps [H][W][C] in their own units.
    """
    return _glint_bench.load_scene(os.fspath(folder), max_pixels, image_ratio, loader, background)


def load_run(folder: Path, dataset: Path | None = None) -> Run:
    """A run that `glint-bench train`, `glint-bench all` or train() left in a folder, to be rendered.

    dataset: where its data are now, if they have moved

    Run.render() gives maps float32 [H][W][C].
    """
    return _glint_bench.load_run(os.fspath(folder), os.fspath(dataset) if dataset is not None else "")


def load_model(
    model: Path, dataset: Path, *, max_pixels: float = 0, image_ratio: float = 1
) -> Run:
    """Gaussians that another program trained, to be rendered.

    model: PLY, or folder (docs/guide/your_renders.md)
    dataset: folder or packed file that it was trained on
    max_pixels, image_ratio: how its images are shrunk, as load_scene() has it

    Run.render() gives maps float32 [H][W][C].
    """
    return _glint_bench.load_model(os.fspath(model), os.fspath(dataset), max_pixels, image_ratio)


def train(
    dataset: Path | Scene,
    method: str = "glint",
    *,
    iterations: int = 7000,
    run: Path | None = None,
    seed: int = 0,
    settings: Mapping[str, Any] | None = None,
    callback: Callable[[dict[str, Any], Run], Any] | None = None,
    callback_every: int = 1,
    max_pixels: float = 0,
    image_ratio: float = 1,
    force: bool = False,
    checkpoint_seconds: float = 300,
    test_psnr_every: int = 0,
) -> Run:
    """Trains a method, as `glint-bench train` does.

    dataset: folder or packed file, or a Scene (in memory alone)
    method: id (methods())
    iterations: steps; schedules scale with them
    run: folder of the run, which goes on there if it was stopped; None: in memory, no file is written
    seed: of the initial surfels and of the order of the views
    settings: fields of the method (`glint-bench methods ID`), {"name": value}
    callback: called as callback(step, run) every `callback_every` steps and after the last. step: {"iteration":
        from 0, "loss", "psnr" in dB of this step's view, "num_surfels", "terms", "sets", "events"}; on a GPU
        the numbers of most steps are NaN, since nobody waits for them. run.render() works there, maps
        float32 [H][W][C]. What it raises ends the training, as Ctrl-C does; a folder is left with a
        checkpoint, and the same call goes on.
    max_pixels, image_ratio: how images are shrunk, as load_scene() has it; not of a Scene
    force: replaces a run that is there
    checkpoint_seconds: between checkpoints, at least
    test_psnr_every: steps between lines of log.jsonl with the PSNR of test views in dB; 0: none
    """
    if iterations < 1 or callback_every < 1:
        raise ValueError("iterations and callback_every: expected 1 or more")
    return _glint_bench.train(
        dataset if isinstance(dataset, Scene) else os.fspath(dataset),
        callback,
        method=method,
        iterations=iterations,
        run="" if run is None else os.fspath(run),
        seed=seed,
        settings=json.dumps(dict(settings or {})),
        every=callback_every,
        max_pixels=max_pixels,
        image_ratio=image_ratio,
        force=force,
        checkpoint_seconds=checkpoint_seconds,
        test_psnr_every=test_psnr_every,
    )


def read_records(path: Path) -> list[dict[str, Any]]:
    """Results of a profile, records.jsonl: a flat dict for each scene, method and seed, as pandas.DataFrame takes them.

    Metrics have their ids ("psnr" in dB, "depth-absrel@glass", ...: docs/reference/metrics.md), other fields the names of
    docs/reference/records.md, those of objects joined by dots ("timings.train" in seconds). Means over test views of
    images [H][W][3].
    """
    return _glint_bench.read_records(os.fspath(path))

"""Types of the compiled part."""

from collections.abc import Callable, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Maps = dict[str, NDArray[np.float32]]

class Camera:
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    rotation_cam_from_world: NDArray[np.float64]
    translation_cam_from_world: NDArray[np.float64]
    center: NDArray[np.float64]
    def __init__(
        self,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float | None = None,
        cy: float | None = None,
        rotation_cam_from_world: ArrayLike | None = None,
        translation_cam_from_world: Sequence[float] = (0, 0, 0),
    ) -> None: ...
    @staticmethod
    def look_at(
        eye: Sequence[float],
        target: Sequence[float],
        up: Sequence[float] = (0, 0, 1),
        *,
        width: int,
        height: int,
        fov_x_deg: float = 60.0,
    ) -> Camera: ...
    def with_size(self, width: int, height: int) -> Camera: ...
    def project(self, points: ArrayLike) -> NDArray[np.float64]: ...

class View:
    name: str
    camera: Camera
    image: NDArray[np.float32]
    counted: NDArray[np.float32] | None
    truth: Maps
    priors: Maps

class Scene:
    name: str
    dataset: str
    train: list[View]
    test: list[View]
    points: Maps
    bounds_min: NDArray[np.float32]
    bounds_max: NDArray[np.float32]
    spatial_scale: float
    simulated_priors: bool
    data_notes: list[str]
    spec_hash: str
    def describe(self) -> str: ...

class Run:
    method: str
    folder: str | None
    iterations: int
    seed: int
    scene: Scene
    config: dict[str, Any]
    num_surfels: int
    warnings: list[str]
    notes: list[str]
    @overload
    def render(self, camera: Camera) -> Maps: ...
    @overload
    def render(self, view: View) -> Maps: ...

def methods() -> list[dict[str, str]]: ...
def set_device(name: str) -> None: ...
def set_threads(count: int) -> None: ...
def set_quiet(quiet: bool) -> None: ...
def load_scene(folder: str, max_pixels: float, image_ratio: float, loader: str, background: str) -> Scene: ...
def load_run(folder: str, dataset: str) -> Run: ...
def load_model(model: str, dataset: str, max_pixels: float, image_ratio: float) -> Run: ...
def train(dataset: str | Scene, callback: Callable[[dict[str, Any], Run], Any] | None, **options: Any) -> Run: ...
def read_records(path: str) -> list[dict[str, Any]]: ...
def score_arrays(
    tool: str,
    names: tuple[str, str],
    predictions: list[Any],
    references: list[Any],
    masks: list[Any],
    glass: list[Any],
    args: list[str],
    family: int,
) -> dict[str, Any]: ...
def score_view(rendered: dict[str, Any], truth: dict[str, Any] | View, counted: Any) -> dict[str, Any]: ...
def score_mesh(prediction: Any, reference: Any, cameras: list[Camera], protocol: str) -> dict[str, Any]: ...

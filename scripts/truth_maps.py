# SPDX-License-Identifier: MIT
"""Points of true maps, for scripts that score parts of pictures. Needs the Python module and NumPy."""
import numpy as np


def plane(maps, *names):
    """The first of these maps [H][W][1] that is there, as [H][W]."""
    return np.array(next(maps[name] for name in names if name in maps))[..., 0]


def world_points(camera, depth):
    """Points [H][W][3] of the pixels' middles at these depths [H][W] (metres along the axis)."""
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    seen = np.stack([(x - camera.cx) / camera.fx * depth, (y - camera.cy) / camera.fy * depth, depth], -1)
    return (seen - np.array(camera.translation_cam_from_world)) @ np.array(camera.rotation_cam_from_world)

# SPDX-License-Identifier: MIT
"""A scene whose rays meet up to four surfaces, for the metrics by layer and by path (metrics/layers.h)."""

import numpy as np

from conformance_files import write_cameras, write_exr, write_png
from conformance_orders import order_vectors

WIDTH, HEIGHT = 24, 16
PATHS = ["t", "tt", "r", "tr", "rt", "rest"]


def name_of(layer, of):
    """The map of a layer, 1 first."""
    return of if layer == 1 and of != "mirror" else f"layer_{layer}_{of}"


def true_maps(values):
    """values(salt, low, high, channels): floats that scripts in any language can make again."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    maps = {"glass": (x > 3) & (x < 15) & (y > 2), "layer_1_mirror": x > 18}
    exists = maps["glass"] | maps["layer_1_mirror"]
    depth = values(50, 1, 2, 1)
    maps["depth"] = depth
    for layer in (2, 3, 4):
        depth = depth + values(50 + layer, 0.2, 1, 1)
        maps[name_of(layer, "depth")] = np.where(exists, depth, 0).astype("f4")
        maps[name_of(layer, "glass")] = exists & (x > 4 + layer) & (y < 14 - layer)
        maps[name_of(layer, "mirror")] = exists & (x > 4 + layer) & (y == 14 - layer)
        exists = maps[name_of(layer, "glass")] | maps[name_of(layer, "mirror")]
    for layer in (1, 2, 3, 4):
        there = maps[name_of(layer, "depth")] > 0
        maps[name_of(layer, "normal")] = normals(values, 60 + layer) * there[:, :, None]
    opening = maps["glass"] | maps["layer_1_mirror"]
    for salt, path in enumerate(PATHS):
        maps["path_" + path] = values(70 + salt, 0, 0.5, 3) * opening[:, :, None]
    maps["rgb"] = np.rint(values(80, 0, 1, 3) * 255).astype(np.uint8)
    return maps


def normals(values, salt):
    n = values(salt, -0.6, 0.6, 3).astype(np.float64)
    n[:, :, 2] = -1
    return (n / np.sqrt((n * n).sum(axis=2, keepdims=True))).astype("f4")


def found_maps(truth, values):
    maps = {"rgb": values(90, 0, 1, 3)}
    for layer in (1, 2, 3, 4):
        depth = truth[name_of(layer, "depth")] * values(90 + layer, 0.8, 1.2, 1)
        holes = values(100 + layer, 0, 1, 1) < 0.1 * (layer - 1)
        maps[name_of(layer, "depth")] = np.where(holes, 0, depth).astype("f4")
        maps[name_of(layer, "normal")] = normals(values, 110 + layer)
        maps[name_of(layer, "transparency")] = values(120 + layer, 0, 1, 1)
    for salt, path in enumerate(PATHS[:-1]):
        maps["path_" + path] = values(130 + salt, 0, 0.6, 3)
    return maps


def write(truth, found):
    write_cameras("layers/scene", WIDTH, HEIGHT)
    for view in ["0000", "0001"]:
        write_png(f"layers/scene/images/{view}/000000.png", truth["rgb"])
        for key, value in truth.items():
            if value.dtype == bool:
                write_png(f"layers/scene/gt/{key}/{view}.png", (value * 255).astype(np.uint8))
            elif key != "rgb":
                write_exr(f"layers/scene/gt/{key}/{view}.exr", value)
    for key, value in found.items():
        write_exr(f"layers/renders/0000/{key}.exr", value)


def layer_vectors(values, depth_values, add, source):
    truth = true_maps(values)
    found = found_maps(truth, values)
    write(truth, found)
    d = {k: v.astype(np.float64) for k, v in found.items()}
    t = {k: v if v.dtype == bool else v.astype(np.float64) for k, v in truth.items()}

    def vector(key, expected, convention, tolerance=1e-5):
        run = ["glint-bench", "eval", "--predictions", "layers", "--dataset", "layers/scene"]
        add(f"layers/{key}", run, key, expected, tolerance, source, convention)

    opens = [t[name_of(k, "glass")] | t[name_of(k, "mirror")] for k in (1, 2, 3, 4)]
    depths = [t[name_of(k, "depth")] for k in (1, 2, 3, 4)]
    behind_glass = np.zeros_like(opens[0])
    for k in (1, 2, 3, 4):
        seen = opens[0] if k == 1 else np.any(opens[:k - 1], axis=0) & (depths[k - 1] > 0)
        where = "pixels with such a layer behind glass or in a mirror (1: glass or mirror first)"
        p = d[name_of(k, "depth")][seen]
        vector(f"layer-{k}-absrel", depth_values(p, depths[k - 1][seen])["absrel"],
               where + ", a hole counts as 0 metres")
        vector(f"layer-{k}-coverage", 100 * (p > 0).mean(), where, 1e-9)
        cosine = (d[name_of(k, "normal")] * t[name_of(k, "normal")]).sum(axis=2)[seen]
        vector(f"layer-{k}-mae", np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean(), where, 1e-3)
        if k == 4:
            break
        mask = np.ones_like(seen) if k == 1 else behind_glass & (depths[k - 1] > 0)
        called, glass = d[name_of(k, "transparency")] >= 0.5, t[name_of(k, "glass")]
        vector(f"layer-{k}-t-iou", (called & glass & mask).sum() / ((called | glass) & mask).sum(),
               "called glass at 0.5 or more, where such a layer is behind glass (1: all)", 1e-9)
        behind_glass = behind_glass | glass

    order_vectors(vector, depths, [d[name_of(k, "depth")] for k in (1, 2, 3, 4)], opens[0],
                  "points of all layers, pixels that begin with glass or a mirror")

    last, found_last = np.zeros_like(depths[0]), d["depth"].copy()
    for k in (4, 3, 2):
        ends = np.all(opens[:k - 1], axis=0) & ~opens[k - 1] & (depths[k - 1] > 0)
        last = np.where(ends, depths[k - 1], last)
    for k in (2, 3, 4):
        found_last = np.where(d[name_of(k, "depth")] > 0, d[name_of(k, "depth")], found_last)
    seen = last > 0
    where = "first opaque surface behind glass or in a mirror, the deepest predicted layer"
    vector("layer-last-absrel", depth_values(found_last[seen], last[seen])["absrel"], where)
    vector("layer-last-coverage", 100 * (found_last[seen] > 0).mean(), where, 1e-9)

    total = sum(t["path_" + path] for path in PATHS)
    for path in PATHS[:-1]:
        part = t["path_" + path]
        share = np.divide(part, total, out=np.zeros_like(total), where=total > 0)
        error = (d["path_" + path] - t["rgb"] / 255 * share) ** 2
        vector(f"path-{path}-psnr", -10 * np.log10(error.mean(axis=2)[opens[0]].mean()),
               "displayed pixel times the path's share of the linear radiance, glass and mirrors")

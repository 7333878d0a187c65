#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes metrics/conformance/: small inputs and the values that metrics must have for them.

Every value comes from NumPy, SciPy or scikit-image, or from a closed form that is stated with it;
none from this project's programs. `glint-bench selftest` runs the vectors. Needs Debian's
python3-skimage; LPIPS needs --weights lpips_alex_v0.1.safetensors (else the old values stay). Run it at the root.
"""

import argparse
import json
from pathlib import Path

import numpy as np
import scipy
import skimage
from scipy.ndimage import correlate1d, maximum_filter
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

from conformance_files import ROOT, write_cameras, write_exr, write_npy, write_ply, write_png
from conformance_layers import HEIGHT as LAYERS_HEIGHT, WIDTH as LAYERS_WIDTH, layer_vectors
from conformance_lpips import alex_lpips, read_weights
from conformance_orders import order_vectors

NUMPY = f"NumPy {np.__version__}"
SKIMAGE = f"scikit-image {skimage.__version__}"
SCIPY = f"SciPy {scipy.__version__}"
CLOSED = "closed form"
WIDTH, HEIGHT = 48, 36
vectors = []


def add(name, arguments, value, expected, tolerance, source, convention):
    vectors.append({
        "id": name, "arguments": arguments, "value": value, "expected": float(expected),
        "tolerance": tolerance, "source": source, "convention": convention,
    })


# --- formulas on integers, which tests/metrics/golden_images.h repeats ---------------------------

def hashed(x, y, c, salt):
    """32 scrambled bits per pixel and channel."""
    v = x * 374761393 + y * 668265263 + c * 40503 + salt * 974711
    v = v & 0xFFFFFFFF
    v = ((v ^ (v >> 13)) * 1274126177) & 0xFFFFFFFF
    return v ^ (v >> 16)


def grid(width, height, channels):
    y, x, c = np.meshgrid(
        np.arange(height), np.arange(width), np.arange(channels), indexing="ij"
    )
    return x.astype(np.int64), y.astype(np.int64), c.astype(np.int64)


def triangle_wave(t):
    t = t % 256
    return np.where(t < 128, 2 * t, 510 - 2 * t)


def reference_bytes(width, height, channels):
    x, y, c = grid(width, height, channels)
    value = triangle_wave(3 * x + 2 * y + 30 * c) + hashed(x, y, c, 1) % 41 - 20
    return np.clip(value, 0, 255)


def prediction_bytes(width, height, channels):
    x, y, c = grid(width, height, channels)
    wave = (3 * triangle_wave(3 * x + 2 * y + 30 * c + 5) + 64) // 4
    return np.clip(wave + hashed(x, y, c, 2) % 61 - 30, 0, 255)


def mask_of(width, height):
    x, y, c = grid(width, height, 1)
    return (hashed(x // 4, y // 4, c, 3) % 3 != 0)[:, :, 0]


def stored(bytes_):
    """As an 8-bit file is read: float32."""
    return bytes_.astype(np.float32) / np.float32(255)


def as_rendered(bytes_):
    """Float values that leave [0, 1]."""
    return (bytes_.astype(np.float64) * (1.1 / 255) - 0.03).astype(np.float32)


def wang_map(prediction, reference):
    return structural_similarity(
        prediction, reference, data_range=1, channel_axis=2, gaussian_weights=True, sigma=1.5,
        use_sample_covariance=False, full=True,
    )


def zero_padded_map(x, y):
    d = np.arange(11) - 5
    w = np.exp(-d * d / (2 * 1.5 ** 2))
    w /= w.sum()

    def mean(image):
        rows = correlate1d(image, w, axis=0, mode="constant")
        return correlate1d(rows, w, axis=1, mode="constant")

    mx, my = mean(x), mean(y)
    vx, vy, cxy = mean(x * x) - mx * mx, mean(y * y) - my * my, mean(x * y) - mx * my
    c1, c2 = 0.01 ** 2, 0.03 ** 2
    ssim = (2 * mx * my + c1) * (2 * cxy + c2) / ((mx * mx + my * my + c1) * (vx + vy + c2))
    return ssim.mean(axis=2)


def depth_maps(width, height):
    """Metres; some pixels without depth (0, NaN), some beyond 20 m."""
    x, y, c = grid(width, height, 1)
    h, g = hashed(x, y, c, 4), hashed(x, y, c, 5)
    reference = (1000 + h % 4000) / 1000.0
    reference = np.where(h % 29 == 0, 25.0, np.where(h % 17 == 0, 0.0, reference))
    prediction = reference * (1 + (g % 401 - 150) / 500.0) + 0.05
    prediction = np.where(g % 13 == 0, 0.0, np.where(g % 31 == 0, np.nan, prediction))
    return prediction.astype(np.float32)[:, :, 0], reference.astype(np.float32)[:, :, 0]


def align(mode, p, r):
    if mode == "median":
        return p * (np.median(r) / np.median(p))
    if mode == "scale":
        return p * ((p * r).sum() / (p * p).sum())
    if mode == "affine":
        return np.polyval(np.polyfit(p, r, 1), p)
    return p


def depth_values(p, r):
    ratio = np.maximum(p, 1e-300) / r
    ratio = np.maximum(ratio, 1 / ratio)
    return {
        "absrel": (np.abs(p - r) / r).mean(),
        "rmse": np.sqrt(((p - r) ** 2).mean()),
        "delta1": 100 * (ratio < 1.25).mean(),
    }


def depth_case(prediction, reference):
    prediction, reference = prediction.astype(np.float64), reference.astype(np.float64)
    valid = reference > 0
    predicted = valid & np.isfinite(prediction) & (prediction > 0)
    case = {"coverage": 100 * predicted.sum() / valid.sum()}
    for mode in ["none", "median", "scale", "affine"]:
        aligned = np.zeros_like(reference)
        aligned[predicted] = align(mode, prediction[predicted], reference[predicted])
        case[mode] = depth_values(aligned[valid], reference[valid])
    near = predicted & (prediction < 20) & (reference < 20)
    p, r = prediction[near], reference[near]
    case["release"] = depth_values(align("median", p, r), r)
    case["release"]["rmse"] /= r.mean()
    return case


def normal_maps(width, height):
    """Unit vectors; some missing, some of the reference's blended (not of unit length)."""
    x, y, c = grid(width, height, 3)
    n = (hashed(x, y, c, 6) % 2001 - 1000) / 1000.0
    n[:, :, 2] = -1.0
    # Summed as the C++ side does, so that both round alike.
    norm = np.sqrt(n[:, :, 0] * n[:, :, 0] + n[:, :, 1] * n[:, :, 1] + n[:, :, 2] * n[:, :, 2])
    reference = n / norm[:, :, None]
    pick = hashed(x, y, 0 * c, 7)
    prediction = 0.5 * (reference + (hashed(x, y, c, 8) % 801 - 400) / 1000.0)
    prediction = np.where(pick % 11 == 0, 0.0, prediction)
    reference = np.where(pick % 7 == 0, 0.8 * reference, reference)
    reference = np.where(pick % 19 == 0, 0.0, reference)
    return prediction.astype(np.float32), reference.astype(np.float32)


def normal_case(prediction, reference):
    prediction, reference = prediction.astype(np.float64), reference.astype(np.float64)
    norm = np.linalg.norm(reference, axis=2)
    unit = (norm > 0) & (np.abs(norm - 1) < 0.05)
    p, r = prediction[unit], reference[unit]
    angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(p, r), axis=1), (p * r).sum(axis=1)))
    missing = np.linalg.norm(p, axis=1) == 0
    angle[missing] = 90
    case = {
        "mean": angle.mean(), "median": np.median(angle),
        "coverage": 100 * (1 - missing.mean()),
        "dropped": 100 * ((norm > 0) & ~unit).sum() / (norm > 0).sum(),
    }
    case["below"] = [100 * (angle < t).mean() for t in [5, 7.5, 11.25, 22.5, 30]]
    return case


# --- pictures ------------------------------------------------------------------------------------

def picture_pair(width=WIDTH, height=HEIGHT):
    """8-bit prediction and reference, a float prediction that leaves [0, 1], and a mask."""
    reference = reference_bytes(width, height, 3).astype(np.uint8)
    prediction = prediction_bytes(width, height, 3).astype(np.uint8)
    mask = (mask_of(width, height) * 255).astype(np.uint8)
    return prediction, reference, as_rendered(prediction.astype(np.int64)), mask


TIGHT = 1e-5  # inputs are float32


def picture_run(tool, name, *more, reference="image/reference.png"):
    return [tool, f"image/{name}", reference, *more]


def picture_psnr(a, b):
    return peak_signal_noise_ratio(b, a, data_range=1)


def write_pictures(prediction, reference, rendered, mask):
    write_png("image/prediction.png", prediction)
    write_png("image/reference.png", reference)
    write_npy("image/rendered.npy", rendered)
    write_exr("image/rendered.exr", rendered.astype(np.float32))
    write_png("image/mask.png", mask)
    alpha = np.dstack([prediction, mask])
    write_png("image/prediction_alpha.png", alpha)
    write_png("image/prediction_grey.png", prediction[:, :, 1])
    write_png("image/reference_grey.png", reference[:, :, 1])
    sixteen = (prediction[:, :, 1].astype(np.uint32) * 257).astype(np.uint16)
    write_png("image/prediction_16bit.png", sixteen)


def psnr_vectors(p, r, clamped, chosen):
    run, psnr, tight = picture_run, picture_psnr, TIGHT
    add("psnr/8bit", run("glint-psnr", "prediction.png"), "psnr-8bit", psnr(p, r), tight, SKIMAGE,
        "one MSE over all pixels and channels, peak 1")
    add("psnr/clamped", run("glint-psnr", "rendered.npy"), "psnr", psnr(clamped, r), tight, SKIMAGE,
        "float predictions are clamped to [0, 1]")
    add("psnr/exr", run("glint-psnr", "rendered.exr"), "psnr", psnr(clamped, r), tight, SKIMAGE,
        "EXR rows from the top, channels by name")
    squares = ((p - r) ** 2).mean(axis=2)
    add("psnr/mask", run("glint-psnr", "prediction.png", "--mask", "image/mask.png"), "psnr-8bit",
        -10 * np.log10(squares[chosen].mean()), tight, NUMPY,
        "divided by the pixels of the mask, not by all")
    add("psnr/identical", ["glint-psnr", "image/reference.png", "image/reference.png"],
        "psnr-8bit", 100, 0, CLOSED, "identical pictures count with the cap, 100 dB")
    add("psnr/alpha", run("glint-psnr", "prediction_alpha.png"), "psnr-8bit", psnr(p, r), tight,
        SKIMAGE, "alpha is dropped, not blended")
    grey = psnr(p[:, :, 1], r[:, :, 1])
    add("psnr/grey", run("glint-psnr", "prediction_grey.png", reference="image/reference_grey.png"),
        "psnr-8bit", grey, tight, SKIMAGE, "one channel on either side")
    add("psnr/16bit", run("glint-psnr", "prediction_16bit.png",
                          reference="image/reference_grey.png"),
        "psnr-8bit", grey, tight, SKIMAGE, "16-bit integers are divided by 65535")


def ssim_vectors(p, r, clamped, chosen):
    run, tight = picture_run, TIGHT
    wang, _ = wang_map(p, r)
    padded = zero_padded_map(p, r)
    add("ssim/wang", run("glint-ssim", "prediction.png", "--variant", "wang"),
        "ssim-wang", wang, tight, SKIMAGE,
        "Gaussian window 11, sigma 1.5, population covariance, valid region, mean over channels")
    add("ssim/3dgs", run("glint-ssim", "prediction.png"), "ssim-3dgs", padded.mean(), tight, SCIPY,
        "the same window, zeros outside the picture, every pixel")
    add("ssim/3dgs-mask", run("glint-ssim", "prediction.png", "--mask", "image/mask.png"),
        "ssim-3dgs", padded[chosen].mean(), tight, SCIPY, "the map is averaged over the mask")
    add("ssim/clamped", run("glint-ssim", "rendered.npy"), "ssim-3dgs",
        zero_padded_map(clamped, r).mean(), tight, SCIPY, "predictions are clamped")


def odd_size_vectors():
    run, psnr, tight = picture_run, picture_psnr, TIGHT
    for width, height in [(37, 53), (11, 11)]:
        size = f"{width}x{height}"
        names = f"prediction_{size}.png", f"image/reference_{size}.png"
        odd = picture_pair(width, height)[:2]
        for name, bytes_ in zip([f"image/{names[0]}", names[1]], odd):
            write_png(name, bytes_)
        p, r = odd[0] / 255.0, odd[1] / 255.0
        add(f"psnr/{size}", run("glint-psnr", names[0], reference=names[1]), "psnr-8bit",
            psnr(p, r), tight, SKIMAGE, "any size")
        add(f"ssim/wang-{size}", run("glint-ssim", names[0], "--variant", "wang", reference=names[1]),
            "ssim-wang", wang_map(p, r)[0], tight, SKIMAGE, "any size, down to the window's")
        add(f"ssim/3dgs-{size}", run("glint-ssim", names[0], reference=names[1]), "ssim-3dgs",
            zero_padded_map(p, r).mean(), tight, SCIPY, "any size")


def image_vectors():
    prediction, reference, rendered, mask = picture_pair()
    write_pictures(prediction, reference, rendered, mask)
    p, r = prediction / 255.0, reference / 255.0
    clamped = np.clip(rendered.astype(np.float64), 0, 1)
    psnr_vectors(p, r, clamped, mask > 0)
    ssim_vectors(p, r, clamped, mask > 0)
    odd_size_vectors()


# --- depth and normals ---------------------------------------------------------------------------

def depth_vectors():
    prediction, reference = depth_maps(WIDTH, HEIGHT)
    write_npy("depth/prediction.npy", prediction)
    write_npy("depth/reference.npy", reference)
    case = depth_case(prediction, reference)
    pair = ["depth/prediction.npy", "depth/reference.npy"]
    what = {
        "none": "no alignment; pixels without prediction count with the whole depth as error",
        "median": "times median(reference) / median(prediction), per view",
        "scale": "least-squares scale", "affine": "least-squares scale and shift",
        "release": "median scale, both below 20 m, holes skipped, RMSE over mean depth",
    }
    for mode, convention in what.items():
        option = {"none": [], "release": ["--release"]}.get(mode, ["--align", mode])
        suffix = "" if mode == "none" else f"-{mode}"
        for key in ["absrel", "rmse", "delta1"]:
            add(f"depth/{mode}-{key}", ["glint-depth", *pair, *option], f"depth-{key}{suffix}",
                case[mode][key], 1e-5 if key != "delta1" else 1e-9, NUMPY, convention)
    add("depth/coverage", ["glint-depth", *pair], "depth-coverage", case["coverage"], 1e-9, NUMPY,
        "percent of true depths that have a prediction")
    fx, fy, cx, cy = 40.0, 42.0, 23.0, 18.5
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    ray = prediction * np.sqrt(((x - cx) / fx) ** 2 + ((y - cy) / fy) ** 2 + 1)
    write_npy("depth/ray.npy", ray)
    add("depth/ray", ["glint-depth", "depth/ray.npy", pair[1], "--ray", "40", "42", "23", "18.5"],
        "depth-absrel", case["none"]["absrel"], 1e-5, NUMPY,
        "distances along rays become z; pixel centres at half pixels")


def normal_vectors():
    prediction, reference = normal_maps(WIDTH, HEIGHT)
    write_npy("normal/prediction.npy", prediction)
    write_npy("normal/reference.npy", reference)
    case = normal_case(prediction, reference)
    run = ["glint-normal", "normal/prediction.npy", "normal/reference.npy"]
    add("normal/mae", run, "normal-mae", case["mean"], 1e-5, NUMPY,
        "atan2(|a x b|, a . b) in degrees; missing predictions count as 90; reference normals that "
        "are not of unit length (0.05) are dropped")
    add("normal/median", run, "normal-median", case["median"], 1e-5, NUMPY,
        "median of the angles, mean of the middle two")
    for threshold, value in zip(["5", "7.5", "11.25", "22.5", "30"], case["below"]):
        add(f"normal/{threshold}", run, f"normal-{threshold}", value, 1e-9, NUMPY,
            "percent strictly below the angle")
    add("normal/coverage", run, "normal-coverage", case["coverage"], 1e-9, NUMPY,
        "percent of the scored pixels with a prediction")
    add("normal/dropped", run, "normal-dropped", case["dropped"], 1e-9, NUMPY,
        "percent of the reference's normals that are not of unit length")
    length = np.linalg.norm(reference.astype(np.float64), axis=2)
    scored, background = (length > 0) & (np.abs(length - 1) < 0.05), length == 0
    wrong = background & (np.linalg.norm(prediction, axis=2) > 0)
    whole = (case["mean"] * scored.sum() + 90 * wrong.sum()) / (scored.sum() + background.sum())
    add("normal/mae-background", run, "normal-mae-background", whole, 1e-5, NUMPY,
        "pixels without a true normal count, too: 0 where nothing is predicted, else 90")


# --- surfaces ------------------------------------------------------------------------------------

def sphere(radius, subdivisions):
    """An icosahedron's faces split in four, again and again, on the sphere."""
    g = (1 + 5 ** 0.5) / 2
    v = [np.array(p, float) for p in [
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
        (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]]
    f = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
         (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
         (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middle, split = {}, []
        for a, b, c in f:
            corner = []
            for i, j in ((a, b), (b, c), (c, a)):
                key = (min(i, j), max(i, j))
                if key not in middle:
                    middle[key] = len(v)
                    v.append(v[i] + v[j])
                corner.append(middle[key])
            x, y, z = corner
            split += [(a, x, z), (b, y, x), (c, z, y), (x, y, z)]
        f = split
    return np.array([radius * p / np.linalg.norm(p) for p in v]), f


def mesh_vectors():
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    two = [(0, 1, 2), (0, 2, 3)]
    write_ply("mesh/square.ply", square, two)
    write_ply("mesh/square_above.ply", square + (0, 0, 0.03), two)
    many = [(i * 17 + j, i * 17 + j + 1, i * 17 + j + 18) for i in range(16) for j in range(16)]
    many += [(i * 17 + j, i * 17 + j + 18, i * 17 + j + 17) for i in range(16) for j in range(16)]
    dense = [((i / 16) ** 2, j / 16, 0) for i in range(17) for j in range(17)]
    write_ply("mesh/square_dense.ply", dense, many)
    write_ply("mesh/sphere_100.ply", *sphere(1.0, 3))
    write_ply("mesh/sphere_095.ply", *sphere(0.95, 3))
    write_ply("mesh/tilted.ply", square @ np.array([[1, 0, 0.1], [0, 1, 0], [0, 0, 1]]), two)

    def run(a, b, *more, samples=50000):
        return ["glint-mesh", f"mesh/{a}", f"mesh/{b}", "--cull", "none", "--samples", str(samples),
                *more]

    above = run("square.ply", "square_above.ply")
    parallel = "two parallel unit squares 3 cm apart"
    add("mesh/parallel-cd", above, "mesh-cd", 0.03, 1e-7, CLOSED, parallel)
    add("mesh/parallel-f1-2cm", above, "mesh-f1@2cm", 0, 0, CLOSED, parallel)
    add("mesh/parallel-f1-5cm", above, "mesh-f1@5cm", 1, 0, CLOSED, parallel)
    add("mesh/parallel-normal", above, "mesh-normal", 1, 1e-6, CLOSED, parallel)
    add("mesh/itself", run("sphere_100.ply", "sphere_100.ply"), "mesh-cd", 0, 1e-7, CLOSED,
        "a surface against itself, whatever the samples")
    add("mesh/density", run("square_dense.ply", "square_above.ply"), "mesh-cd", 0.03, 1e-7, CLOSED,
        "samples are uniform by area: the tessellation does not matter")
    # Faces of 1280 lie at most 0.3 % inside the radius.
    spheres = run("sphere_095.ply", "sphere_100.ply")
    add("mesh/spheres-cd", spheres, "mesh-cd", 0.05, 0.003, CLOSED, "concentric spheres, 5 cm")
    # Accuracy: from z = 0.1 x to the plane: 0.1 x, mean 0.05. Completeness: along the tilted
    # plane's normal, 0.1 x / sqrt(1.01), for all places whose foot lies on the tilted square
    # (x <= 1: the foot of x is x / 1.01).
    tilted = run("tilted.ply", "square.ply", samples=400000)
    add("mesh/tilted-accuracy", tilted, "mesh-accuracy", 0.05, 2e-4, CLOSED,
        "a square that rises 0.1 over its length, to the flat one")
    add("mesh/tilted-completeness", tilted, "mesh-completeness", 0.05 / 1.01 ** 0.5, 2e-4, CLOSED,
        "the way back is shorter: distances are to the surface, not along an axis")
    # Nearest of n uniform points in the plane: mean distance 1 / (2 sqrt(n)), here at height 3 cm.
    p2p = run("square.ply", "square_dense.ply", "--distance", "point-to-point")
    add("mesh/p2p-floor", p2p, "mesh-cd-p2p", 0.5 / 50000 ** 0.5, 2e-4, CLOSED,
        "equal surfaces are not 0 apart from sample to sample: 1 / (2 sqrt(samples per m2))")


# --- a scene with glass, for the metrics of both layers --------------------------------------------

def bounded(salt, low, high, channels=1, size=(WIDTH, HEIGHT)):
    x, y, c = grid(*size, channels)
    value = low + (high - low) * (hashed(x, y, c, salt) % 1001) / 1000.0
    return value.astype(np.float32) if channels > 1 else value.astype(np.float32)[:, :, 0]


def glass_maps():
    """Truth and prediction by map name. A pane with a slanted edge in the middle of the picture."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    glass = (x > 12 + y // 4) & (x < 36) & (y > 7) & (y < 30)
    prediction, reference, rendered, _ = picture_pair()
    behind = bounded(21, 3, 5)
    depth = np.where(glass, np.float32(2) + behind / 10, behind).astype(np.float32)
    predicted_normal, normal = normal_maps(WIDTH, HEIGHT)
    truth = {"depth": depth, "behind_depth": behind, "normal": normal,
             "transmitted": bounded(22, 0, 1, 3), "reflected": bounded(23, 0, 0.5, 3),
             "glass": glass, "rgb": reference / 255.0}
    found = {"rgb": rendered.astype(np.float32), "depth": depth * bounded(24, 0.9, 1.1),
             "behind_depth": behind * bounded(25, 0.8, 1.3), "normal": predicted_normal,
             "behind_expected": behind * bounded(30, 0.9, 1.6),
             "behind_median": np.where(bounded(31, 0, 1) < 0.2, 0, behind * bounded(32, 0.7, 1.2)),
             "first_mode": np.where(bounded(33, 0, 1) < 0.1, 0, depth * bounded(34, 0.8, 1.1)),
             "last_mode": np.where(bounded(35, 0, 1) < 0.1, 0, behind * bounded(36, 0.9, 1.3)),
             "transparency": np.clip(0.7 * glass + bounded(26, -0.2, 0.4), -0.1, 1.1).astype("f4"),
             "specularity": np.clip(0.2 * glass + bounded(27, 0, 0.3), 0, 1).astype("f4"),
             "transmitted": bounded(28, 0, 1, 3), "reflected": bounded(29, 0, 0.4, 3)}
    return truth, found


def write_glass(truth, found):
    write_cameras("glass/scene", WIDTH, HEIGHT)
    for name in ["0000", "0001"]:
        rgb = np.rint(truth["rgb"] * 255).astype(np.uint8)
        write_png(f"glass/scene/images/{name}/000000.png", rgb)
        for key in ["depth", "behind_depth", "normal", "transmitted", "reflected"]:
            write_exr(f"glass/scene/gt/{key}/{name}.exr", truth[key])
        write_png(f"glass/scene/gt/glass/{name}.png", (truth["glass"] * 255).astype(np.uint8))
    for key, value in found.items():
        write_exr(f"glass/renders/0000/{key}.exr", value)


def regions_of(glass):
    near, far = maximum_filter(glass, 7), maximum_filter(~glass, 7)
    everything = np.ones_like(glass)
    return {"": everything, "@glass": glass, "@glass-border": near & far, "@opaque": ~glass}


def best_iou(maps, glass):
    def iou(m, t):
        called = m >= t
        return (called & glass).sum() / (called | glass).sum()
    return max(iou(m, t) for m in maps for t in [i / 20 for i in range(1, 20)])


def glass_vector(key, expected, source, convention, tolerance=1e-5):
    run = ["glint-bench", "eval", "--predictions", "glass", "--dataset", "glass/scene"]
    add(f"glass/{key}", run, key, expected, tolerance, source, convention)


def region_psnr(a, b, m):
    return -10 * np.log10(((a - b) ** 2).mean(axis=2)[m].mean())


def region_vectors(d, t, glass, clipped):
    vector = glass_vector
    rgb = np.clip(d["rgb"], 0, 1)
    rounded = np.rint(rgb.astype(np.float32) * np.float32(255)) / 255.0
    padded = zero_padded_map(rgb, t["rgb"])
    wang = wang_map(rgb, t["rgb"])[1].mean(axis=2)
    inside = np.zeros_like(glass)
    inside[5:HEIGHT - 5, 5:WIDTH - 5] = True

    for at, m in regions_of(glass).items():
        where = "whole picture" if not at else f"region {at[1:]} (border: within 3 px, Chebyshev)"
        vector("psnr" + at, region_psnr(rgb, t["rgb"], m), NUMPY, where)
        vector("psnr-8bit" + at, region_psnr(rounded, t["rgb"], m), NUMPY, where + ", rounded to 8 bits")
        vector("ssim-3dgs" + at, padded[m].mean(), SCIPY, where)
        vector("ssim-wang" + at, wang[m & inside].mean(), SKIMAGE, where)
        values = depth_values(d["depth"][m], t["depth"][m])
        for key in ["absrel", "rmse", "delta1"]:
            vector(f"depth-{key}{at}", values[key], NUMPY, where)
        values = depth_values(d["first_mode"][m], t["depth"][m])
        vector("depth-absrel-first-mode" + at, values["absrel"], NUMPY,
               where + ", holes count as 0 metres")
        vector("depth-coverage-first-mode" + at, 100 * (d["first_mode"][m] > 0).mean(), NUMPY,
               where, 1e-9)
        vector("transparency-mae" + at, np.abs(clipped - glass)[m].mean(), NUMPY, where)


def behind_vectors(d, t, glass):
    vector = glass_vector
    order_vectors(lambda key, expected, words: vector(key, expected, NUMPY, words, 1e-9),
                  [t["depth"], t["behind_depth"]], [d["depth"], d["behind_depth"]], glass,
                  "points of the first surface and of what is behind glass")
    behind = depth_values(d["behind_depth"][glass], t["behind_depth"][glass])
    vector("behind-absrel", behind["absrel"], NUMPY, "depth of what is behind glass, glass pixels")
    content = t["behind_depth"] - t["depth"] < 1.25
    for key, part in [("content", glass & content), ("beyond", glass & ~content)]:
        assert part.any()
        values = depth_values(d["behind_depth"][part], t["behind_depth"][part])
        vector(f"behind-absrel-{key}", values["absrel"], NUMPY,
               "glass pixels with less than 1.25 m between the layers, and the others")
    for suffix, key in [("", "behind_depth"), ("-expected", "behind_expected"),
                        ("-median", "behind_median"), ("-last-mode", "last_mode")]:
        p = d[key][glass]
        if suffix:
            values = depth_values(p, t["behind_depth"][glass])
            vector("behind-absrel" + suffix, values["absrel"], NUMPY,
                   "one rule for all methods, a hole counts as 0 metres")
        vector("behind-coverage" + suffix, 100 * (p > 0).mean(), NUMPY,
               "percent of glass pixels with a depth", 1e-9)


def component_vectors(d, t, glass, clipped):
    vector = glass_vector
    called = clipped >= 0.5
    vector("transparency-iou", (called & glass).sum() / (called | glass).sum(), NUMPY,
           "called glass at 0.5 or more", 1e-9)
    vector("glass-iou-best", best_iou([clipped, d["specularity"]], glass), NUMPY,
           "best threshold of 0.05, 0.10, ..., 0.95, better map of the two", 1e-9)
    total = t["transmitted"] + t["reflected"]
    for key, part in [("trans-psnr", "transmitted"), ("refl-psnr", "reflected")]:
        share = np.divide(t[part], total, out=np.zeros_like(total), where=total > 0)
        vector(key, region_psnr(np.clip(d[part], 0, 1), t["rgb"] * share, glass), NUMPY,
               "displayed pixel times the component's share of the linear radiance, glass pixels")


def glass_vectors():
    truth, found = (dict((k, np.asarray(v)) for k, v in maps.items()) for maps in glass_maps())
    write_glass(truth, found)
    d = {k: v.astype(np.float64) for k, v in found.items()}
    t = {k: v.astype(np.float64) for k, v in truth.items() if k != "glass"}
    clipped = np.clip(d["transparency"], 0, 1)
    region_vectors(d, t, truth["glass"], clipped)
    behind_vectors(d, t, truth["glass"])
    component_vectors(d, t, truth["glass"], clipped)


# --- LPIPS -----------------------------------------------------------------------------------------

def lpips_vectors(path):
    name = "lpips/alex"
    if path is None:
        old = json.loads((ROOT / "vectors.json").read_text())["vectors"]
        vectors.extend(v for v in old if v["id"].startswith("lpips/"))
        return
    weights = read_weights(path)
    x, y, c = grid(96, 80, 3)
    reference = stored(np.clip(triangle_wave(3 * x + 2 * y + 30 * c), 0, 255))
    noise = hashed(x, y, c, 31) % 81 - 40
    prediction = stored(np.clip(np.rint(reference * 255) + noise, 0, 255))
    for key, image in [("prediction", prediction), ("reference", reference)]:
        write_png(f"lpips/{key}.png", np.rint(image * 255).astype(np.uint8))
    value = alex_lpips(prediction.astype(np.float64), reference.astype(np.float64), weights)
    add(name, ["glint-lpips", "lpips/prediction.png", "lpips/reference.png", "--net", "alex"],
        "lpips-alex", value, 1e-4, f"{NUMPY}, from the network's definition",
        "version 0.1, AlexNet, fed [-1, 1], sum over taps of spatial means")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--weights", type=Path, help="lpips_alex_v0.1.safetensors")
    options = parser.parse_args()
    image_vectors()
    depth_vectors()
    normal_vectors()
    mesh_vectors()
    glass_vectors()
    layer_vectors(lambda *of: bounded(*of, size=(LAYERS_WIDTH, LAYERS_HEIGHT)), depth_values, add, NUMPY)
    lpips_vectors(options.weights)
    document = {"made_by": "scripts/make_conformance.py", "vectors": vectors}
    (ROOT / "vectors.json").write_text(json.dumps(document, indent=1) + "\n")
    size = sum(f.stat().st_size for f in ROOT.rglob("*") if f.is_file())
    print(f"{ROOT}: {len(vectors)} vectors, {size / 1000:.0f} kB")


if __name__ == "__main__":
    main()

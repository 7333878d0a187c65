#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Writes tests/metrics/golden/metrics.json: metric values by NumPy and scikit-image.

The images are formulas on integers that tests/metrics/golden_images.h repeats, so none is stored.
Needs Debian's python3-skimage. Run from the repository's root: scripts/make_metric_goldens.py
"""

import json
from pathlib import Path

import numpy as np
import skimage
from scipy.ndimage import correlate1d
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio, structural_similarity

SIZES = [(64, 48, 3), (37, 53, 3), (11, 11, 3), (160, 90, 1)]
MAP_SIZES = [(48, 32), (23, 17)]


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


def rendered(bytes_):
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


def image_case(width, height, channels):
    reference = stored(reference_bytes(width, height, channels)).astype(np.float64)
    prediction = stored(prediction_bytes(width, height, channels)).astype(np.float64)
    float_prediction = np.clip(rendered(prediction_bytes(width, height, channels)), 0, 1)
    rounded = np.rint(float_prediction * np.float32(255)) / 255.0
    mask = mask_of(width, height)
    squares = ((prediction - reference) ** 2).mean(axis=2)
    wang, full = wang_map(prediction, reference)
    inside = np.zeros_like(mask)
    inside[5:height - 5, 5:width - 5] = True
    padded = zero_padded_map(prediction, reference)
    float_prediction = float_prediction.astype(np.float64)
    case = {
        "width": width, "height": height, "channels": channels,
        "mse": mean_squared_error(reference, prediction),
        "psnr": peak_signal_noise_ratio(reference, prediction, data_range=1),
        "psnr_masked": -10 * np.log10(squares[mask].mean()),
        "psnr_rendered": peak_signal_noise_ratio(reference, float_prediction, data_range=1),
        "psnr_8bit_rendered": peak_signal_noise_ratio(reference, rounded, data_range=1),
        "ssim_wang": wang,
        "ssim_3dgs": padded.mean(),
        "ssim_3dgs_masked": padded[mask].mean(),
        "ssim_3dgs_rendered": zero_padded_map(float_prediction, reference).mean(),
    }
    if (mask & inside).any():
        case["ssim_wang_masked"] = full.mean(axis=2)[mask & inside].mean()
    return case


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


def depth_case(width, height):
    prediction, reference = (m.astype(np.float64) for m in depth_maps(width, height))
    valid = reference > 0
    predicted = valid & np.isfinite(prediction) & (prediction > 0)
    case = {"width": width, "height": height, "coverage": 100 * predicted.sum() / valid.sum()}
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


def normal_case(width, height):
    prediction, reference = (m.astype(np.float64) for m in normal_maps(width, height))
    norm = np.linalg.norm(reference, axis=2)
    unit = (norm > 0) & (np.abs(norm - 1) < 0.05)
    p, r = prediction[unit], reference[unit]
    angle = np.degrees(np.arctan2(np.linalg.norm(np.cross(p, r), axis=1), (p * r).sum(axis=1)))
    missing = np.linalg.norm(p, axis=1) == 0
    angle[missing] = 90
    case = {
        "width": width, "height": height,
        "mean": angle.mean(), "median": np.median(angle), "rms": np.sqrt((angle ** 2).mean()),
        "coverage": 100 * (1 - missing.mean()),
        "dropped": 100 * ((norm > 0) & ~unit).sum() / (norm > 0).sum(),
    }
    case["below"] = [100 * (angle < t).mean() for t in [5, 7.5, 11.25, 22.5, 30]]
    return case


def main():
    goldens = {
        "made_by": f"scripts/make_metric_goldens.py, scikit-image {skimage.__version__}",
        "images": [image_case(*size) for size in SIZES],
        "depth": [depth_case(*size) for size in MAP_SIZES],
        "normal": [normal_case(*size) for size in MAP_SIZES],
    }
    path = Path("tests/metrics/golden/metrics.json")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(goldens, indent=1) + "\n")


if __name__ == "__main__":
    main()

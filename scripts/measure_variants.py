#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Measures how far common variants of metrics differ: the tables of docs/reference/metrics.md.

    scripts/measure_variants.py PICTURE.png

Degrades the picture in three stated ways (seeded) and scores each with NumPy, SciPy and scikit-image
(Debian's python3-skimage). None of this project's programs is used.
"""

import sys

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter
from skimage.metrics import structural_similarity


def psnr(prediction, reference):
    return -10 * np.log10(np.mean((prediction - reference) ** 2))


def noisy(reference, decibels, rng):
    sigma = 10 ** (-decibels / 20)
    return np.clip(reference + rng.normal(0, sigma, reference.shape), 0, 1)


def psnr_variants(reference, rng):
    print("| PSNR in float | rounded to 8 bits | truncated to 8 bits | dark by 1/255, then rounded |")
    print("|---|---|---|---|")
    for decibels in (31, 41, 46):
        image = noisy(reference, decibels, rng)
        plain = psnr(image, reference)
        rounded = psnr(np.round(image * 255) / 255, reference)
        truncated = psnr(np.floor(image * 255) / 255, reference)
        dark = psnr(np.round(np.clip(image * 255 - 1, 0, 255)) / 255, reference)
        print(f"| {plain:.2f} | {rounded - plain:+.3f} | {truncated - plain:+.3f} "
              f"| {dark - plain:+.3f} |")


def window_ssim(x, y, data_range=1.0, mode="constant"):
    """Wang's window at every pixel; `mode` says what is outside of the picture."""
    def blur(z):
        return gaussian_filter(z, (1.5, 1.5, 0), radius=(5, 5, 0), mode=mode)
    c1, c2 = (0.01 * data_range) ** 2, (0.03 * data_range) ** 2
    mx, my = blur(x), blur(y)
    vx, vy, vxy = blur(x * x) - mx * mx, blur(y * y) - my * my, blur(x * y) - mx * my
    return ((2 * mx * my + c1) * (2 * vxy + c2)) / ((mx**2 + my**2 + c1) * (vx + vy + c2))


def halved(x):
    h, w = x.shape[0] // 2 * 2, x.shape[1] // 2 * 2
    return x[:h, :w].reshape(h // 2, 2, w // 2, 2, -1).mean((1, 3))


def luma(x):
    return (x @ [0.299, 0.587, 0.114])[..., None]


def inside(ssim_map):
    return ssim_map[5:-5, 5:-5].mean()


SSIM = {
    "`ssim-3dgs`": lambda x, y: window_ssim(x, y).mean(),
    "`ssim-wang`": lambda x, y: inside(window_ssim(x, y)),
    "reflected border (torchmetrics from 1.4.2)": lambda x, y: window_ssim(
        x, y, mode="mirror").mean(),
    "scikit-image's default: uniform 7x7, sample covariance": lambda x, y: structural_similarity(
        x, y, data_range=1, channel_axis=2),
    "luma only": lambda x, y: inside(window_ssim(luma(x), luma(y))),
    "shrunk by 2 first": lambda x, y: inside(window_ssim(halved(x), halved(y))),
    "data range 2 on values in [0, 1]": lambda x, y: inside(window_ssim(x, y, 2)),
}


def ssim_variants(reference, rng):
    blurred = gaussian_filter(reference, (1, 1, 0))
    pairs = [noisy(blurred, 36, rng), noisy(reference, 26, rng),
             gaussian_filter(reference, (2.5, 2.5, 0))]
    print("\n| variant | A | B | C |\n|---|---|---|---|")
    for name, score in SSIM.items():
        print(f"| {name} | " + " | ".join(f"{score(p, reference):.4f}" for p in pairs) + " |")


def ray_length_error():
    """Mean of length / z - 1 over a picture of 16:9, by horizontal field of view."""
    print("\nAbsRel of a ray's length taken for z:")
    for degrees in (40, 60, 90):
        x = np.linspace(-1, 1, 1601) * np.tan(np.radians(degrees) / 2)
        y = np.linspace(-1, 1, 901) * np.tan(np.radians(degrees) / 2) * 9 / 16
        length = np.sqrt(1 + x[None] ** 2 + y[:, None] ** 2)
        print(f"  {degrees} degrees: {np.mean(length - 1):.3f}")


def normal_floor(rng):
    n = rng.normal(size=(200_000, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    print("\nMean angle of a normal and its 8-bit copy:")
    for name, quantise in (("rounded", np.round), ("truncated", np.floor)):
        q = quantise((n * 0.5 + 0.5) * 255) / 255 * 2 - 1
        angle = np.arctan2(np.linalg.norm(np.cross(n, q), axis=1), np.sum(n * q, axis=1))
        print(f"  {name}: {np.degrees(angle.mean()):.2f} degrees")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rng = np.random.default_rng(0)
    reference = np.asarray(Image.open(sys.argv[1]).convert("RGB"), dtype=float) / 255
    psnr_variants(reference, rng)
    ssim_variants(reference, rng)
    ray_length_error()
    normal_floor(rng)


if __name__ == "__main__":
    main()

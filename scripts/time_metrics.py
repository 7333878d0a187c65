#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Times glint-psnr and glint-ssim against scikit-image on the same pairs of PNG files.

    scripts/time_metrics.py [build/release/bin] [PICTURE.png]

Both read the files and score them; start-up of glint's programs counts, Python's does not. They take
turns, and medians of the rounds are printed. Without PICTURE the pairs are a drawn picture; with one,
it is scaled to 960x540. Needs NumPy, Pillow and scikit-image (Debian's python3-skimage).
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image
from skimage import io
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

WIDTH, HEIGHT, NUM_PAIRS, ROUNDS = 960, 540, 40, 5


def drawn():
    """Waves and hard edges, as many shades as a photograph."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    waves = [np.sin(x / (17 + 9 * c)) * np.cos(y / (23 + 5 * c)) for c in range(3)]
    edges = ((x // 60 + y // 45) % 2) * 0.5
    return np.clip(0.45 + 0.25 * np.stack(waves, -1) + edges[..., None] * 0.4, 0, 1) * 255


def picture(path):
    if path is None:
        return drawn()
    return np.asarray(Image.open(path).convert("RGB").resize((WIDTH, HEIGHT)), np.float64)


def write_pairs(folder, source):
    rng = np.random.default_rng(0)
    for side in ("predictions", "references"):
        (folder / side).mkdir()
    for i in range(NUM_PAIRS):
        reference = np.roll(source, 7 * i, 1)
        noisy = reference + rng.normal(0, 8, source.shape)
        for side, values in (("predictions", noisy), ("references", reference)):
            image = Image.fromarray(np.clip(values, 0, 255).astype(np.uint8))
            image.save(folder / side / f"{i}.png")


def psnr(reference, prediction):
    return peak_signal_noise_ratio(reference, prediction, data_range=255)


def ssim(reference, prediction):
    return structural_similarity(reference, prediction, data_range=255, channel_axis=2,
                                 gaussian_weights=True, sigma=1.5, use_sample_covariance=False)


def theirs(folder, metric):
    start = time.perf_counter()
    values = [metric(io.imread(folder / "references" / f"{i}.png"),
                     io.imread(folder / "predictions" / f"{i}.png")) for i in range(NUM_PAIRS)]
    return time.perf_counter() - start, np.mean(values)


def ours(folder, command):
    start = time.perf_counter()
    out = subprocess.run([*command, folder / "predictions", folder / "references", "--quiet"],
                         check=True, capture_output=True, text=True).stdout
    return time.perf_counter() - start, float(out.split()[-1])


def main():
    programs = Path(sys.argv[1] if len(sys.argv) > 1 else "build/release/bin")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_pairs(folder, picture(sys.argv[2] if len(sys.argv) > 2 else None))
        for title, metric, command in (
                ("PSNR", psnr, [programs / "glint-psnr"]),
                ("SSIM", ssim, [programs / "glint-ssim", "--variant", "wang"])):
            rounds = [(theirs(folder, metric), ours(folder, command)) for _ in range(ROUNDS)]
            milliseconds = [[1e3 * seconds / NUM_PAIRS for seconds, _ in round] for round in rounds]
            a, b = (statistics.median(times) for times in zip(*milliseconds))
            ratios = sorted(x / y for x, y in milliseconds)
            (_, their_value), (_, our_value) = rounds[-1]
            print(f"{title}: scikit-image {a:.1f} ms a pair ({their_value:.4f}), here {b:.1f} ms "
                  f"({our_value:.4f}); {ratios[0]:.1f} to {ratios[-1]:.1f} times as fast, "
                  f"median {statistics.median(ratios):.1f}")


if __name__ == "__main__":
    main()

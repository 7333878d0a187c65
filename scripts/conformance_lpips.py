# SPDX-License-Identifier: MIT
"""LPIPS with AlexNet [Zhang18] in NumPy."""

import json
import struct

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view


def read_weights(path):
    """Tensors of a safetensors file, by name."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<Q", data)
    header, weights = json.loads(data[8:8 + length]), {}
    for key, tensor in header.items():
        begin, end = tensor["data_offsets"]
        values = np.frombuffer(data[8 + length + begin:8 + length + end], "<f4")
        weights[key] = values.reshape(tensor["shape"]).astype(np.float64)
    return weights


def convolve(x, weight, bias, stride, padding):
    x = np.pad(x, ((0, 0), (padding, padding), (padding, padding)))
    windows = sliding_window_view(x, weight.shape[2:], axis=(1, 2))[:, ::stride, ::stride]
    out = np.einsum("chwij,ocij->ohw", windows, weight, optimize=True)
    return np.maximum(out + bias[:, None, None], 0)


def pool(x):
    return sliding_window_view(x, (3, 3), axis=(1, 2))[:, ::2, ::2].max(axis=(3, 4))


def alex_taps(image, w):
    shift, scale = np.array([-.030, -.088, -.188]), np.array([.458, .448, .450])
    x = np.moveaxis((2 * image - 1 - shift) / scale, 2, 0)
    taps = []
    for layer, stride, padding, pooled in [(0, 4, 2, False), (3, 1, 2, True), (6, 1, 1, True),
                                           (8, 1, 1, False), (10, 1, 1, False)]:
        x = pool(x) if pooled else x
        name = f"features.{layer}"
        x = convolve(x, w[f"{name}.weight"], w[f"{name}.bias"], stride, padding)
        taps.append(x)
    return taps


def alex_lpips(prediction, reference, weights):
    total = 0
    for i, (a, b) in enumerate(zip(alex_taps(prediction, weights), alex_taps(reference, weights))):
        a = a / (np.sqrt((a * a).sum(axis=0)) + 1e-10)
        b = b / (np.sqrt((b * b).sum(axis=0)) + 1e-10)
        lin = weights[f"lin{i}.weight"].reshape(-1)
        total += (lin[:, None, None] * (a - b) ** 2).sum(axis=0).mean()
    return total

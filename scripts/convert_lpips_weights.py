#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the weights file of glint-lpips from the published files, which you download yourself:

  features   torchvision: alexnet-owt-*.pth, squeezenet1_1-*.pth or vgg16-*.pth
  lin        LPIPS 0.1: lpips/weights/v0.1/{alex,squeeze,vgg}.pth of the PerceptualSimilarity repository

  convert_lpips_weights.py --net alex --features alexnet-owt-7be5be79.pth --lin alex.pth \\
      --out ~/.cache/glint-bench/lpips

Needs PyTorch to read them. The result, lpips_<net>_v0.1.npz, holds the same bytes whenever it is made.
"""
import argparse
import hashlib
import pathlib
import re
import struct
import sys
import zipfile

import torch

NUM_TAPS = {"alex": 5, "squeeze": 7, "vgg": 5}
FIRST_SHAPE = {"alex": (64, 3, 11, 11), "squeeze": (64, 3, 3, 3), "vgg": (64, 3, 3, 3)}
EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest date that a zip can hold


def fail(message):
    sys.exit(f"convert_lpips_weights.py: {message}")


def check_name_hash(path):
    """torchvision puts the first eight digits of a file's SHA-256 into its name."""
    stated = re.search(r"-([0-9a-f]{8})\.pth$", path.name)
    if stated is None:
        return
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if not found.startswith(stated.group(1)):
        fail(f"{path}: SHA-256 {found[:8]}..., but its name says {stated.group(1)}; download it again")


def load_state(path):
    check_name_hash(path)
    state = torch.load(path, map_location="cpu", weights_only=True)
    if not isinstance(state, dict):
        fail(f"{path}: holds a {type(state).__name__}, expected a dictionary of tensors")
    return state


def feature_arrays(path, net):
    arrays = {name: tensor for name, tensor in load_state(path).items() if name.startswith("features.")}
    first = arrays.get("features.0.weight")
    found = None if first is None else tuple(first.shape)
    if found != FIRST_SHAPE[net]:
        fail(f"{path}: features.0.weight has shape {found}, expected {FIRST_SHAPE[net]} of {net}")
    return arrays


def lin_arrays(path, net):
    state = load_state(path)
    arrays = {}
    for tap in range(NUM_TAPS[net]):
        name = f"lin{tap}.model.1.weight"
        if name not in state:
            fail(f"{path}: no '{name}'; expected the v0.1 file of {net}")
        arrays[f"lin{tap}.weight"] = state[name].flatten()  # [1][channels][1][1] in the file
    if f"lin{NUM_TAPS[net]}.model.1.weight" in state:
        fail(f"{path}: more than {NUM_TAPS[net]} taps; this is not the file of {net}")
    return arrays


def npy_bytes(tensor):
    """A float32 array in NumPy's format 1.0: values start at a multiple of 64 bytes."""
    values = tensor.to(torch.float32).contiguous().flatten().tolist()
    shape = "".join(f"{extent}, " for extent in tensor.shape)
    if tensor.dim() > 1:
        shape = shape[:-2]
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape.strip()}), }}"
    header += " " * (-(10 + len(header) + 1) % 64) + "\n"
    preamble = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header))
    return preamble + header.encode() + struct.pack(f"<{len(values)}f", *values)


def write_npz(path, arrays):
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    with zipfile.ZipFile(temporary, "w") as archive:
        for name, tensor in arrays.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", EPOCH), npy_bytes(tensor))
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--net", required=True, choices=sorted(NUM_TAPS))
    parser.add_argument("--features", required=True, type=pathlib.Path, help="torchvision's .pth file")
    parser.add_argument("--lin", required=True, type=pathlib.Path, help="the .pth file of LPIPS 0.1")
    parser.add_argument("--out", default=".", type=pathlib.Path, help="folder of the result")
    options = parser.parse_args()
    arrays = feature_arrays(options.features, options.net) | lin_arrays(options.lin, options.net)
    path = options.out.expanduser() / f"lpips_{options.net}_v0.1.npz"
    write_npz(path, arrays)
    print(path)


if __name__ == "__main__":
    main()

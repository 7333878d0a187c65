#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the weights file of glint-lpips from the published files, which you download yourself:

  features   torchvision: alexnet-owt-*.pth, squeezenet1_1-*.pth or vgg16-*.pth
  lin        LPIPS 0.1: lpips/weights/v0.1/{alex,squeeze,vgg}.pth of the PerceptualSimilarity repository

  convert_lpips_weights.py --net alex --features alexnet-owt-7be5be79.pth --lin alex.pth \\
      --out ~/.cache/glint-bench/lpips

scripts/fetch_lpips_weights.sh downloads and converts all of them. Needs neither PyTorch nor NumPy. The result,
lpips_<net>_v0.1.npz, holds the same bytes whenever it is made. Sums: torchvision's files have the first digits of their
SHA-256 in their names; AlexNet's and SqueezeNet's arrays are known as a whole, VGG16's are not.
"""
import argparse
import hashlib
import pathlib
import re
import struct
import sys
import zipfile

from torch_files import BadFile, tensors

NUM_TAPS = {"alex": 5, "squeeze": 7, "vgg": 5}
FIRST_SHAPE = {"alex": (64, 3, 11, 11), "squeeze": (64, 3, 3, 3), "vgg": (64, 3, 3, 3)}
KNOWN_ARRAYS = {  # SHA-256 of names and values, as metrics/lpips_weights.cpp has them
    "alex": "0ef71af41cc957e07f0eaf349e2ec748453cce1a8f60ed9a6c878328338496a7",
    "squeeze": "2ca1ac118a52387307bd9d1c829d83b8f5c2214a4e6569e89b1a149ef5a2c533",
}
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


def arrays_in(path):
    """name -> (shape, floats)"""
    check_name_hash(path)
    return {name: (tensor.shape, tensor.values()) for name, tensor in tensors(path).items()}


def feature_arrays(path, net):
    arrays = {name: array for name, array in arrays_in(path).items() if name.startswith("features.")}
    found, _ = arrays.get("features.0.weight", (None, None))
    if found != FIRST_SHAPE[net]:
        fail(f"{path}: features.0.weight has shape {found}, expected {FIRST_SHAPE[net]} of {net}")
    return arrays


def lin_arrays(path, net):
    state = arrays_in(path)
    arrays = {}
    for tap in range(NUM_TAPS[net]):
        name = f"lin{tap}.model.1.weight"
        if name not in state:
            fail(f"{path}: no '{name}'; expected the v0.1 file of {net}")
        _, values = state[name]  # [1][channels][1][1]
        arrays[f"lin{tap}.weight"] = ((len(values),), values)
    if f"lin{NUM_TAPS[net]}.model.1.weight" in state:
        fail(f"{path}: more than {NUM_TAPS[net]} taps; this is not the file of {net}")
    return arrays


def npy_bytes(shape, values):
    """A float32 array in NumPy's format 1.0: values start at a multiple of 64 bytes."""
    text = ", ".join(map(str, shape)) + ("," if len(shape) == 1 else "")
    header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({text}), }}"
    header += " " * (-(10 + len(header) + 1) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + little_endian(values)


def little_endian(values):
    if sys.byteorder == "big":
        values = values[:]
        values.byteswap()
    return values.tobytes()


def check_known(arrays, net):
    digest = hashlib.sha256()
    for name in sorted(arrays):
        digest.update(name.encode() + b"\0" + little_endian(arrays[name][1]))
    if net not in KNOWN_ARRAYS:
        print(f"{net}: no sum of its linear layers is on record; compare a pair with a known value "
              "(docs/METRICS.md)", file=sys.stderr)
    elif digest.hexdigest() != KNOWN_ARRAYS[net]:
        fail(f"{net}: other values than those that were published (SHA-256 of the arrays {digest.hexdigest()[:16]}...); "
             "download the files again, or give --unpublished")


def write_npz(path, arrays):
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    with zipfile.ZipFile(temporary, "w") as archive:
        for name, (shape, values) in arrays.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy", EPOCH), npy_bytes(shape, values))
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--net", required=True, choices=sorted(NUM_TAPS))
    parser.add_argument("--features", required=True, type=pathlib.Path, help="torchvision's .pth file")
    parser.add_argument("--lin", required=True, type=pathlib.Path, help="the .pth file of LPIPS 0.1")
    parser.add_argument("--out", default=".", type=pathlib.Path, help="folder of the result")
    parser.add_argument("--unpublished", action="store_true", help="take weights that are not those of LPIPS 0.1")
    options = parser.parse_args()
    arrays = feature_arrays(options.features, options.net) | lin_arrays(options.lin, options.net)
    if not options.unpublished:
        check_known(arrays, options.net)
    path = options.out.expanduser() / f"lpips_{options.net}_v0.1.npz"
    write_npz(path, arrays)
    print(path)


if __name__ == "__main__":
    try:
        main()
    except BadFile as error:
        fail(error)

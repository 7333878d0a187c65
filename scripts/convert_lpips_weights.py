#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes the weights file of glint-lpips from the published files, which you download yourself:

  features   torchvision: alexnet-owt-*.pth or vgg16-*.pth
  lin        LPIPS 0.1: lpips/weights/v0.1/{alex,vgg}.pth of the PerceptualSimilarity repository

  convert_lpips_weights.py --net alex --features alexnet-owt-7be5be79.pth --lin alex.pth \\
      --out ~/.cache/glint-bench/lpips

or, beside it, from the .npz that earlier versions made: convert_lpips_weights.py --npz FILE.

scripts/fetch_lpips_weights.sh downloads and converts both. Needs neither PyTorch nor NumPy. The result,
lpips_<net>_v0.1.safetensors, holds the same bytes whenever it is made. Sums: torchvision's files have the first digits of
their SHA-256 in their names; AlexNet's arrays are known as a whole, VGG16's are not.
"""
import argparse
import ast
import hashlib
import json
import math
import pathlib
import re
import struct
import sys
import zipfile

from torch_files import BadFile, floats_of, tensors

NUM_TAPS = 5
FIRST_SHAPE = {"alex": (64, 3, 11, 11), "vgg": (64, 3, 3, 3)}
KNOWN_ARRAYS = {  # SHA-256 of names and values, as metrics/lpips_weights.cpp has them
    "alex": "0ef71af41cc957e07f0eaf349e2ec748453cce1a8f60ed9a6c878328338496a7",
}


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
    for tap in range(NUM_TAPS):
        name = f"lin{tap}.model.1.weight"
        if name not in state:
            fail(f"{path}: no '{name}'; expected the v0.1 file of {net}")
        _, values = state[name]  # [1][channels][1][1]
        arrays[f"lin{tap}.weight"] = ((len(values),), values)
    if f"lin{NUM_TAPS}.model.1.weight" in state:
        fail(f"{path}: more than {NUM_TAPS} taps; this is not the file of {net}")
    return arrays


def npz_arrays(path):
    """Of NumPy's zip of arrays, float32 in C order."""
    arrays = {}
    try:
        archive = zipfile.ZipFile(path)
        for name in archive.namelist():
            data = archive.read(name)
            (length,) = struct.unpack_from("<H", data, 8)  # of the header of format 1.0
            header = ast.literal_eval(data[10:10 + length].decode("latin-1"))
            arrays[name.removesuffix(".npy")] = (tuple(header["shape"]), floats_of(data[10 + length:]))
            if header["descr"] != "<f4" or header["fortran_order"]:
                raise BadFile(f"{name}: not float32 in C order")
    except (OSError, ValueError, SyntaxError, KeyError, TypeError, struct.error, zipfile.BadZipFile, BadFile) as error:
        raise BadFile(f"{path}: no .npz of LPIPS weights: {error}") from None
    return arrays


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
              "(docs/reference/metrics.md)", file=sys.stderr)
    elif digest.hexdigest() != KNOWN_ARRAYS[net]:
        fail(f"{net}: other values than those that were published (SHA-256 of the arrays {digest.hexdigest()[:16]}...); "
             "download the files again, or give --unpublished")


def write_safetensors(path, arrays):
    header, at = {}, 0
    for name, (shape, values) in arrays.items():
        if math.prod(shape) != len(values):
            fail(f"{name}: {len(values)} values do not fill {shape}")
        header[name] = {"dtype": "F32", "shape": shape, "data_offsets": (at, at + 4 * len(values))}
        at += 4 * len(values)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix(".tmp")
    with open(temporary, "wb") as file:
        file.write(struct.pack("<Q", len(text)) + text)
        for _, values in arrays.values():
            file.write(little_endian(values))
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--net", choices=sorted(FIRST_SHAPE))
    parser.add_argument("--features", type=pathlib.Path, help="torchvision's .pth file")
    parser.add_argument("--lin", type=pathlib.Path, help="the .pth file of LPIPS 0.1")
    parser.add_argument("--npz", type=pathlib.Path, help="lpips_<net>_v0.1.npz, instead of the other three")
    parser.add_argument("--out", type=pathlib.Path, help="folder of the result; otherwise the .npz's, or this one")
    parser.add_argument("--unpublished", action="store_true", help="take weights that are not those of LPIPS 0.1")
    options = parser.parse_args()
    if options.npz:
        net = "alex" if "lpips_alex" in options.npz.name else "vgg"
        arrays, out = npz_arrays(options.npz), options.out or options.npz.parent
    elif options.net and options.features and options.lin:
        net, out = options.net, options.out or pathlib.Path(".")
        arrays = feature_arrays(options.features, net) | lin_arrays(options.lin, net)
    else:
        parser.error("give --net, --features and --lin, or --npz")
    if not options.unpublished:
        check_known(arrays, net)
    path = out.expanduser() / f"lpips_{net}_v0.1.safetensors"
    write_safetensors(path, arrays)
    print(path)


if __name__ == "__main__":
    try:
        main()
    except BadFile as error:
        fail(error)

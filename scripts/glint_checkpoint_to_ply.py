#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the surfel sets of an official GLINT or EnvGS checkpoint (EasyVolcap's latest.pt) as PLYs.

    scripts/glint_checkpoint_to_ply.py latest.pt --out model/
    glint-bench render --model model/ --dataset DATA --method glint-official

The official code's own PLYs lack transparency and specularity, which its checkpoints have. Nothing of the file is
run (torch_files.py); neither PyTorch nor NumPy is needed. Sets: pcd -> interface.ply (transparency, specular),
trans_env -> transmission.ply, env -> reflection.ply; all values raw, before their activations.
"""
import argparse
import array
import pathlib
import sys

from torch_files import BadFile, tensors

SETS = {"pcd": "interface.ply", "trans_env": "transmission.ply", "env": "reflection.ply"}
EXTRA = {"transparency": "_transmission_coeff", "specular": "_specular"}
FLAT = -13.815511  # log of 1e-6: a third scale for viewers of ellipsoids


def fail(message):
    sys.exit(f"glint_checkpoint_to_ply.py: {message}")


def columns_of(state, prefix, name, width, rows=None):
    """The columns of a set's array, [rows][...width]."""
    key = f"{prefix}.{name}"
    if key not in state:
        fail(f"no {key} in the checkpoint")
    tensor = state[key]
    values, count = tensor.values(), (tensor.shape or (0,))[0]
    if count * width != len(values) or rows not in (None, count):
        fail(f"{key}: shape {list(tensor.shape)}, expected {rows or 'N'} rows of {width} numbers")
    return [values[k::width] for k in range(width)], count


def set_columns(state, prefix, extra):
    """Fields of a PLY and their columns, in the order of 3DGS."""
    means, rows = columns_of(state, prefix, "_xyz", 3)
    zeros = array.array("f", bytes(4 * rows))
    fields = list(zip("xyz", means)) + [(name, zeros) for name in ("nx", "ny", "nz")]
    higher = state.get(f"{prefix}._features_rest")
    rest = higher.shape[1] if higher is not None and len(higher.shape) == 3 else 0
    dc, _ = columns_of(state, prefix, "_features_dc", 3, rows)
    fields += [(f"f_dc_{c}", dc[c]) for c in range(3)]
    if rest:
        higher, _ = columns_of(state, prefix, "_features_rest", 3 * rest, rows)
        fields += [(f"f_rest_{c * rest + k}", higher[3 * k + c]) for c in range(3) for k in range(rest)]
    for name, key, width in (("opacity", "_opacity", 1), ("scale", "_scaling", 2), ("rot", "_rotation", 4)):
        columns, _ = columns_of(state, prefix, key, width, rows)
        fields += [(name if width == 1 else f"{name}_{k}", columns[k]) for k in range(width)]
        if name == "scale":
            fields.append(("scale_2", array.array("f", [FLAT]) * rows))
    for name in extra:
        columns, _ = columns_of(state, prefix, EXTRA[name], 1, rows)
        fields.append((name, columns[0]))
    return fields, rows


def write_ply(path, fields, rows):
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {rows}\n"
    header += "".join(f"property float {name}\n" for name, _ in fields) + "end_header\n"
    values = array.array("f", bytes(4 * rows * len(fields)))
    for k, (_, column) in enumerate(fields):
        values[k::len(fields)] = column
    if sys.byteorder == "big":
        values.byteswap()
    temporary = path.with_suffix(".tmp")
    temporary.write_bytes(header.encode() + values.tobytes())
    temporary.replace(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the PLYs")
    options = parser.parse_args()
    if not options.checkpoint.is_file():
        fail(f"{options.checkpoint}: not there")
    state = tensors(options.checkpoint, ("sampler.",))
    sets = [name for name in SETS if f"sampler.{name}._xyz" in state]
    if "pcd" not in sets:
        fail(f"{options.checkpoint}: no sampler.pcd._xyz; expected a checkpoint of GLINT or EnvGS")
    interface = ["transparency"] * ("trans_env" in sets) + ["specular"]
    columns = {name: set_columns(state, f"sampler.{name}", interface if name == "pcd" else []) for name in sets}
    options.out.mkdir(parents=True, exist_ok=True)
    for name, (fields, rows) in columns.items():
        write_ply(options.out / SETS[name], fields, rows)
        print(f"{options.out / SETS[name]}: {rows} surfels")
    if "sampler.trans_env._specular" in state:
        print("note: the specularity of the transmission set is left out: what mirrors there is not rendered by glint-bench")


if __name__ == "__main__":
    try:
        main()
    except BadFile as error:
        fail(error)

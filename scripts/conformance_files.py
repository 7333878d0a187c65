# SPDX-License-Identifier: MIT
"""Files of conformance vectors, written without this project's programs."""

import struct
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path("metrics/conformance")


def write_npy(name, array):
    path = ROOT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    np.save(path, np.ascontiguousarray(array.astype(np.float32)))


def write_png(name, array, mode=None):
    path = ROOT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(array, mode).save(path)


def write_exr(name, array):
    """OpenEXR 2: scan lines, no compression, 32-bit floats."""
    planes = {"Z": array} if array.ndim == 2 else dict(zip("RGB", np.moveaxis(array, 2, 0)))
    height, width = array.shape[:2]

    def attribute(key, kind, data):
        return key.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data

    channels = b"".join(
        c.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for c in sorted(planes)
    ) + b"\0"
    box = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    header = struct.pack("<ii", 20000630, 2) + b"".join([
        attribute("channels", "chlist", channels), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", box), attribute("displayWindow", "box2i", box),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]) + b"\0"
    line_bytes = 4 * width * len(planes)
    lines, offsets = b"", b""
    for y in range(height):
        offsets += struct.pack("<Q", len(header) + 8 * height + len(lines))
        row = b"".join(planes[c][y].astype("<f4").tobytes() for c in sorted(planes))
        lines += struct.pack("<ii", y, line_bytes) + row
    path = ROOT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(header + offsets + lines)


def write_ply(name, vertices, faces):
    path = ROOT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = b"".join(struct.pack("<Biii", 3, *face) for face in faces)
    path.write_bytes(header.encode() + np.asarray(vertices, "<f4").tobytes() + rows)


CAMERA = """%YAML:1.0
---
names:
   - "0000"
   - "0001"
"""


def matrix(key, rows, cols, data):
    numbers = ", ".join(f"{float(v):.17g}" for v in data)
    return (f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n"
            f"   data: [ {numbers} ]\n")


def write_cameras(name, width, height):
    """Two, one beside the other, as EasyVolcap keeps them."""
    intri, extri = CAMERA, CAMERA
    for view in ["0000", "0001"]:
        intri += matrix(f"K_{view}", 3, 3, [40, 0, width / 2, 0, 40, height / 2, 0, 0, 1])
        intri += f"H_{view}: {height}\nW_{view}: {width}\n" + matrix(f"D_{view}", 5, 1, [0] * 5)
        shift = 0.1 * int(view)
        extri += matrix(f"R_{view}", 3, 1, [0, 0, 0])
        extri += matrix(f"Rot_{view}", 3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])
        extri += matrix(f"T_{view}", 3, 1, [shift, 0, 0])
    folder = ROOT / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "intri.yml").write_text(intri)
    (folder / "extri.yml").write_text(extri)

# SPDX-License-Identifier: MIT
"""Files of a scene folder (docs/reference/formats.md), in plain Python: EXR floats, 8-bit PNG, cameras as OpenCV's FileStorage."""
import array
import os
import struct
import sys
import zlib


def write_file(path, content):
    """Under a temporary name first, so that nobody sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.part")
    temporary.write_bytes(content)
    os.replace(temporary, path)


def little_endian(values):
    if sys.byteorder == "big":
        values = array.array("f", values)
        values.byteswap()
    return values.tobytes()


def exr_header(size, channels):
    """One part, scan lines, not compressed; channels of float32 in the order of the alphabet."""
    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    listed = b"".join(c.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for c in sorted(channels)) + b"\0"
    window = struct.pack("<4i", 0, 0, size[0] - 1, size[1] - 1)
    return struct.pack("<ii", 20000630, 2) + b"".join((
        attribute("channels", "chlist", listed),
        attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", window),
        attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
    )) + b"\0"


def write_exr(path, size, channels, values):
    """`values`: rows from the top, the channels of each pixel in the order of `channels`."""
    width, height = size
    count = len(channels)
    header = exr_header(size, channels)
    row_bytes = 4 * width * count
    first = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (row_bytes + 8) for y in range(height)))
    lines = []
    for y in range(height):
        row = values[y * width * count:(y + 1) * width * count]
        planes = b"".join(little_endian(row[channels.index(c)::count]) for c in sorted(channels))
        lines.append(struct.pack("<ii", y, row_bytes) + planes)
    write_file(path, header + offsets + b"".join(lines))


def write_png(path, size, channels, values):
    """8 bits; 1 channel: grey, 3: colour."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    width, height = size
    row = width * channels
    lines = b"".join(b"\0" + values[y * row:(y + 1) * row] for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 0, 0, 0, 0)
    write_file(path, b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) +
               chunk(b"IEND", b""))


def srgb_byte(linear):
    """IEC 61966-2-1, clamped, half to even."""
    linear = min(max(linear, 0), 1)
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return round(255 * encoded)


def matrix(key, rows, columns, values):
    data = ", ".join(repr(float(value)) for value in values)
    return f"{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: [ {data} ]\n"


def write_cameras(folder, views):
    """intri.yml and extri.yml: world to camera, OpenCV axes, pixel centres at +0.5."""
    head = "%YAML:1.0\n---\nnames:\n" + "".join(f'   - "{view["name"]}"\n' for view in views)
    intri, extri = head, head
    for view in views:
        name = view["name"]
        intri += matrix(f"K_{name}", 3, 3, (view["fx"], 0, view["cx"], 0, view["fy"], view["cy"], 0, 0, 1))
        intri += f"H_{name}: {view['height']}\nW_{name}: {view['width']}\n"
        extri += matrix(f"Rot_{name}", 3, 3, sum(view["rotation_cam_from_world"], []))
        extri += matrix(f"T_{name}", 3, 1, view["translation_cam_from_world"])
    write_file(folder / "intri.yml", intri.encode())
    write_file(folder / "extri.yml", extri.encode())

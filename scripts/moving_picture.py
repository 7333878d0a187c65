#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An animated WebP of a camera path, for pages that show no video: what README opens with.

    glint-bench dataset make glassroom --scene room_2 --width 128 --height 72 --views 178 --spp 64 --out ROOM
    glint-bench train --dataset ROOM --method glint/plus --iterations 30000 --run RUN
    glint-bench render --run RUN --path orbit --frames 60 --size 320x180 \\
        --maps rgb,away,reflection,depth,behind_depth,normal --to FOLDER
    scripts/moving_picture.py FOLDER docs/images/moving.webp --columns 3 --quality 66

Takes FOLDER/layers/0000.png, ... in their order, forth and, with --back, back again, and lays the maps of a frame out
in so many columns. Needs Pillow with WebP.
Exit codes: 1 usage, 3 no frames, 4 the file is larger than --most-bytes (it is not written).
"""
import argparse
import io
import pathlib
import sys


def laid_out(sheet, count, columns):
    """The `count` maps that stand side by side, in rows of `columns`."""
    from PIL import Image

    width, rows = sheet.width // count, -(-count // columns)
    picture = Image.new("RGB", (columns * width, rows * sheet.height), sheet.getpixel((0, 0)))
    for i in range(count):
        tile = sheet.crop((i * width, 0, (i + 1) * width, sheet.height))
        picture.paste(tile, (i % columns * width, i // columns * sheet.height))
    return picture


def frames_in(folder, width, columns):
    from PIL import Image

    count = sum(1 for entry in folder.iterdir() if entry.is_dir() and entry.name != "layers")
    frames = []
    for file in sorted((folder / "layers").glob("*.png")):
        picture = laid_out(Image.open(file).convert("RGB"), count, min(columns or count, count))
        height = round(picture.height * width / picture.width)
        frames.append(picture.resize((width, height), Image.LANCZOS))
    return frames


def encoded(frames, fps, quality):
    data = io.BytesIO()
    options = {"save_all": True, "append_images": frames[1:], "duration": round(1000 / fps), "loop": 0}
    frames[0].save(data, "WEBP", quality=quality, method=6, **options)
    return data.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=pathlib.Path, help="of `render --path --to`")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--fps", type=float, default=12)
    parser.add_argument("--columns", type=int, default=0, help="maps side by side; 0: all")
    parser.add_argument("--width", type=int, default=900, help="pixels")
    parser.add_argument("--quality", type=int, default=60, help="of WebP, 0 to 100")
    parser.add_argument("--back", action="store_true", help="and back again, so that it does not jump")
    parser.add_argument("--most-bytes", type=int, default=3_000_000)
    given = parser.parse_args()
    frames = frames_in(given.folder, given.width, given.columns)
    if not frames:
        print(f"{given.folder / 'layers'}: no frames; glint-bench render --path writes them", file=sys.stderr)
        return 3
    data = encoded(frames + frames[-2:0:-1] if given.back else frames, given.fps, given.quality)
    if len(data) > given.most_bytes:
        print(f"{len(data)} bytes; take fewer frames, or a lower --quality or --width", file=sys.stderr)
        return 4
    unfinished = given.out.with_name(given.out.name + ".new")
    unfinished.write_bytes(data)
    unfinished.rename(given.out)
    print(f"{given.out}: {len(frames)} frames, {len(data)} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())

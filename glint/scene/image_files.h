// SPDX-License-Identifier: MIT
// Image files: PNG (read with libdeflate, written by libpng), JPEG, WebP, BMP, EXR, NPY maps.
// Colours stay as stored (sRGB-encoded values in [0, 1]); nothing here changes a transfer function.
// Writers are atomic. Errors (kBadReference) name the file and say what was found and expected:
// truncated files, wrong channel counts, sizes that do not match the header, cropped or deep EXR,
// missing EXR channels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/image.h"
#include "glint/core/service.h"

namespace glint {

// Pictures of integers, by extension, in lower case.
inline const std::vector<std::string> kPictureExtensions{".png", ".jpg", ".jpeg", ".webp", ".bmp"};

// 8- and 16-bit PNG, JPEG, WebP, BMP, EXR, NPY, TIFF (library glint_tiff) by extension. Grey images
// get one channel, colour three, in the order R G B; an alpha channel is dropped. Integers are
// divided by their maximum.
Image read_image(const fs::path& path);
// The same, always `channels` channels (1 or 3; grey is repeated, colour to grey is an error).
Image read_image(const fs::path& path, int channels);
// The size in the header of a PNG, JPEG, WebP or BMP; nothing is decoded.
ImageSize read_image_size(const fs::path& path);
// Pixels of at least half of the range count. Errors besides: values, but none that large (a mask
// of 0 and 1 in 8 bits).
MaskImage read_mask(const fs::path& path);

// What is odd about the values of colours as displayed, which lie in [0, 1] and not far from it:
// those of radiance or of 0 to 255. Empty: nothing.
std::string color_range_problem(ImageView colors);

// [0, 1] clamped, times 255, rounded half to even; not a number: 0.
ByteImage to_bytes(ImageView image);
// 1 or 3 channels; floats by to_bytes().
void write_png(const fs::path& path, ByteView image);
void write_png(const fs::path& path, ImageView image);
// Floats times 65535; 1 channel.
void write_png16(const fs::path& path, ImageView grey);
// The bytes of a JPEG of 1 or 3 channels; quality from 1 to 100. Errors (kEnvironment): no memory.
std::string jpeg_bytes(ByteView image, int quality);
// float32 channels: Z for 1, R G B for 3 (or X Y Z when `xyz`), scan lines, ZIP.
void write_exr(const fs::path& path, ImageView image, bool xyz = false);
void write_npy(const fs::path& path, ImageView image);

// Area average for shrinking, bilinear for growing (OpenCV, library glint_resize).
inline constinit Service<Image(ImageView, ImageSize)> resize_image{
    "resizing pictures",
    "pack the scene at that size with the full build (glint-bench dataset pack --max-pixels)"};

// float32 and 8- and 16-bit TIFF (libtiff, library glint_tiff); alpha is laid on a grey where one
// is given, else dropped. Errors (kBadReference): as above.
inline constinit Service<Image(const fs::path&, std::optional<float>)> read_tiff{
    "reading TIFF", "convert the file to EXR or NPY, or build with libtiff-dev installed"};

// IEC 61966-2-1. Values outside [0, 1] are continued (encode clamps below at 0).
float srgb_encode(float linear);
float srgb_decode(float encoded);

}  // namespace glint

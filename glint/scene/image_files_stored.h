// SPDX-License-Identifier: MIT
// What the values of an image file are stored as, which read_image() no longer shows. By the file's
// header: of NPY and TIFF the name does not tell it.
#pragma once

#include <string>

#include "glint/core/files.h"
#include "glint/core/image.h"
#include "glint/core/service.h"

namespace glint {

// Are they integers, which read_image() divides by their maximum, so that values are multiples of a
// step? Of a file that is not read, a missing one too, false: its reader has the message. Errors:
// kBadReference (a damaged header of NPY or TIFF), kEnvironment (TIFF without library glint_tiff).
bool stores_integers(const fs::path& path);
// That maximum: 65535 of 16 bits, 255 of 8; 0: floats, or no file that is read. Errors as above.
int integer_range(const fs::path& path);

// Has a PNG three colours a pixel? Of any other file: false.
bool is_colored_png(const fs::path& path);

// By its first bytes, whatever its name says. Of a file that is not there, false.
bool is_jpeg(const fs::path& path);

// Does a PNG, TIFF or WebP have alpha, which read_image() drops? In PNG that is a channel, a
// palette with it, or a colour that counts as transparent. Of any other file: false.
bool has_alpha(const fs::path& path);
// read_image() with what such a picture holds laid on a grey of `background`; other files as there.
Image read_composed(const fs::path& path, int channels, float background);
// The channel itself, [0, 1]; of other files 1.
Image read_alpha(const fs::path& path);
// Are its colours multiplied by alpha already, which PNG does not allow and programs write? So it
// looks where hundreds of half transparent pixels are, and none is brighter than its alpha.
bool looks_premultiplied(const fs::path& path);

// The orientation (1 to 8) that EXIF states in a JPEG, PNG or TIFF. Pixels are read as they are
// stored, whatever it says, as COLMAP and PIL do. 1, which is as stored, where nothing is stated.
int stated_orientation(const fs::path& path);
// "EXIF orientation 6 (to be shown turned by 90 degrees clockwise)"
std::string orientation_words(int orientation);
// For the end of a message on sizes that do not fit: that this is the likely cause; empty: as
// stored.
std::string orientation_hint(const fs::path& path);

// Of a TIFF (library glint_tiff).
inline constinit Service<int(const fs::path&)> tiff_integer_range{
    "reading TIFF", "convert the file to EXR or NPY, or build with libtiff-dev installed"};
inline constinit Service<bool(const fs::path&)> tiff_has_alpha{
    "reading TIFF", "convert the file to PNG, or build with libtiff-dev installed"};

}  // namespace glint

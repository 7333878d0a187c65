// SPDX-License-Identifier: MIT
// What the values of an image file are stored as, which read_image() no longer shows. By the file's
// header: of NPY and TIFF the name does not tell it.
#pragma once

#include "glint/core/files.h"
#include "glint/core/service.h"

namespace glint {

// Are they integers, which read_image() divides by their maximum, so that values are multiples of a
// step? Of a file that is not read, a missing one too, false: its reader has the message. Errors:
// kBadReference (a damaged header of NPY or TIFF), kEnvironment (TIFF without library glint_tiff).
bool stores_integers(const fs::path& path);

// Does the header of a PNG name an alpha channel, which read_image() drops? Of any other file:
// false.
bool has_alpha(const fs::path& path);

// Of a TIFF (library glint_tiff).
inline constinit Service<bool(const fs::path&)> tiff_stores_integers{
    "reading TIFF", "convert the file to EXR or NPY, or build with libtiff-dev installed"};

}  // namespace glint

// SPDX-License-Identifier: MIT
// Pictures of 8 bits a channel in fewer bytes than PNG has, without loss of a pixel
// (glint/scene/sample_codec.h). The PNG that is made of them again may have other bytes.
#pragma once

#include <optional>
#include <string>

#include "glint/core/image.h"

namespace glint {

struct PictureCode {
  int width = 0, height = 0, channels = 0;
  std::string coded;
  std::string pixels;  // what the hash is of: [H][W][C]
};

// Nothing: the file is no such picture, or is smaller as it is.
std::optional<PictureCode> code_picture(const std::string& png);

// The file of a picture, and its pixels. Errors (kBadPrediction, naming `where`): sizes that no
// picture of a parcel has, bytes that are not those of such pixels.
std::string picture_of_code(PictureCode& code, const std::string& where);

}  // namespace glint

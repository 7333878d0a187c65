// SPDX-License-Identifier: MIT
// Where the models and textures of a house lie: a folder for each, named by its jid.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/presence.h"

namespace glint {

// A name that cannot lead anywhere else: letters, digits, '-', '_' and '.', not "." or "..".
inline bool is_plain_name(std::string_view name) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
  return !name.empty() && name != "." && name != ".." && name.size() <= 200 &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

struct FurnitureModel {
  fs::path model, texture;  // texture: empty where there is none for the whole model
};

// <models>/<jid>/raw_model.obj, .glb or .gltf, and texture.png; none: not there, no plain name.
inline std::optional<FurnitureModel> find_model(const fs::path& models, const std::string& jid) {
  if (models.empty() || !is_plain_name(jid)) return std::nullopt;
  for (const char* name : {"raw_model.obj", "raw_model.glb", "raw_model.gltf"}) {
    const fs::path model = models / jid / name, texture = models / jid / "texture.png";
    if (!is_file(model)) continue;
    return FurnitureModel{model, is_file(texture) ? texture : fs::path()};
  }
  return std::nullopt;
}

// <textures>/<jid>/texture.png, of a material; none: not there, no plain name.
inline std::optional<fs::path> find_picture(const fs::path& textures, const std::string& jid) {
  if (textures.empty() || !is_plain_name(jid)) return std::nullopt;
  const fs::path picture = textures / jid / "texture.png";
  return is_file(picture) ? std::optional(picture) : std::nullopt;
}

// Pictures in the folder itself: what their names begin with says for which kind of surface.
inline std::vector<fs::path> surface_pictures(const fs::path& textures) {
  return list_files(textures, {".png", ".jpg", ".jpeg"});
}

}  // namespace glint

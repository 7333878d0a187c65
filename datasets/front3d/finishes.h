// SPDX-License-Identifier: MIT
// What the surfaces of a house look like: pictures of a folder where there are some, else patterns
// of GlassRoom, drawn at random as the paper's generator draws materials.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/front3d/house.h"
#include "datasets/glassroom/furniture.h"
#include "datasets/glassroom/patterns.h"

namespace glint {

class Finishes {
 public:
  // Materials and textures go into `scene`, each when it is first asked for. `textures`: a folder,
  // or empty. Deterministic in the seed.
  Finishes(TraceScene& scene, const fs::path& textures, std::uint64_t seed);

  // Of all surfaces of a kind (surface_kind()), or "fabric", "wood", "metal".
  Finish of(const std::string& kind);
  // A material that shines.
  int emitter(const std::string& name, Vec3f radiance);

  // The picture of the house's own material, <textures>/<jid>/texture.png; its texture coordinates
  // are the file's. None: no such file.
  std::optional<int> own_picture(const HouseMaterial& material);
  // Its colour.
  int own_color(const HouseMaterial& material);

 private:
  std::optional<fs::path> picture_for(const std::string& kind);
  Finish make(const std::string& kind);
  Finish patterned(const std::string& name, PatternSpec spec);
  Finish plain(Material material);

  TraceScene& scene_;
  fs::path textures_;
  Rng rng_;
  std::map<std::string, Finish> known_;
  std::map<std::string, int> own_;  // by what it is and its jid, uid or name
  std::vector<fs::path> pictures_;
};

}  // namespace glint

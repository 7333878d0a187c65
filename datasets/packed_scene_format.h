// SPDX-License-Identifier: MIT
// Names in a packed scene, for the one that writes them and the one that reads them.
#pragma once

#include <string>
#include <vector>

#include "glint/scene/scene.h"

namespace glint::packed {

inline constexpr const char* kFormat = "glint-scene";
// Grows when the meaning of a name changes. Of version 1, which is still read, every map of a view
// is a tensor.
inline constexpr const char *kVersion = "2", *kFirstVersion = "1";

// Either list of views, and the beginning of its tensors' names.
struct Split {
  const char* name;
  std::vector<View> Scene::*views;
};
inline constexpr Split kSplits[] = {{"train", &Scene::train}, {"test", &Scene::test}};

// Maps of so many views after each other are coded together (map_codes.h).
inline constexpr std::size_t kViewsTogether = 8;

// "train.prior.depth.3": of the views that have that map among those from 24 on. Its first byte
// says which those are, the lowest bit the first.
inline std::string maps_name(const std::string& split, const std::string& map, std::size_t group) {
  return split + "." + map + "." + std::to_string(group);
}

// Points, their colours and normals are coded as pictures of one row, of this kind.
inline constexpr MapKind kPointKind = MapKind::kColor;

inline std::string view_prefix(const std::string& split, std::size_t view) {
  return split + "." + std::to_string(view) + ".";
}

// Throws (kBadReference) unless the scene can be trained on and stored: `file` opens the message.
void check_scene(const Scene& scene, const std::string& file);

}  // namespace glint::packed

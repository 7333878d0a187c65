// SPDX-License-Identifier: MIT
// Names in a packed scene, for the one that writes them and the one that reads them.
#pragma once

#include <string>
#include <vector>

#include "glint/scene/scene.h"

namespace glint::packed {

inline constexpr const char* kFormat = "glint-scene";
inline constexpr const char* kVersion = "1";  // grows when the meaning of a name changes

// Either list of views, and the beginning of its tensors' names.
struct Split {
  const char* name;
  std::vector<View> Scene::*views;
};
inline constexpr Split kSplits[] = {{"train", &Scene::train}, {"test", &Scene::test}};

inline std::string view_prefix(const std::string& split, std::size_t view) {
  return split + "." + std::to_string(view) + ".";
}

// Throws (kBadReference) unless the scene can be trained on and stored: `file` opens the message.
void check_scene(const Scene& scene, const std::string& file);

}  // namespace glint::packed

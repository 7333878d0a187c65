// SPDX-License-Identifier: MIT
// What the means of a table are taken over, so that numbers beside each other can be compared: the
// scenes, at one image size, that most of its methods have.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "reports/run/records/records.h"

namespace glint {

struct SizedScene {
  std::string scene, resolution;  // "room_1", "160x90"
  std::string text() const;       // "room_1 at 160x90"
  friend auto operator<=>(const SizedScene&, const SizedScene&) = default;
};
using SizedScenes = std::set<SizedScene>;

SizedScene sized_scene(const Record& record);

// Of the sets that methods have, and what two of them share, the one that compares the most values:
// scenes times methods with all of them. As good: the larger. Empty: no method has a scene.
SizedScenes common_scenes(const std::map<std::string, SizedScenes>& by_method);

// By dataset, from the finished records.
std::map<std::string, SizedScenes> common_scenes(const std::vector<Record>& records);

// "room_1, room_2", or "room_1 at 160x90, room_2 at 160x90".
std::string scenes_text(const SizedScenes& scenes, bool with_sizes);

}  // namespace glint

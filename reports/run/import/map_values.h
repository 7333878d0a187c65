// SPDX-License-Identifier: MIT
// Values of another program's maps that are scored as they are and look like a mistake.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/scene/maps.h"

namespace glint {

// What is odd about a map, in words; empty: nothing. Depth and normals (our conventions) with no
// value where `truth` has some; depth whose median ratio to it is far from 1, as in other units;
// normals not of unit length. `truth` may be empty: then depth is not looked at.
std::string odd_values(MapKind kind, const Image& map, const Image& truth);

// Collects them over views, so that a note a kind of map says what was found, and how often.
class OddValues {
 public:
  void look(const MapRow& row, const std::string& file, const Image& map, const Image& truth);
  std::vector<std::string> notes() const;

 private:
  struct Found {
    std::string first;  // "FILE: what is odd"
    int num_views = 0;
  };
  std::map<std::string, Found> found_;  // by id of the map
};

}  // namespace glint

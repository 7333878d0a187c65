// SPDX-License-Identifier: MIT
// Annotated tuples of points in LayeredDepth's two forms (princeton-vl/LayeredDepth, CC0):
//   NAME.jsonl  a line a tuple: [[x, y, layer], ...], nearest first
//   NAME.json   {"layer_all": {"pairs": [{"p1": [x, y, layer], "p2": ..., "is_real": true}, ...],
//               "trips": [...], "quads": [...]}, ...}
// Layers count from 1. Points of a tuple that is not real are of layers that are not there.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "metrics/orders.h"

namespace glint {

struct AnnotatedTuple {
  LayerTuple points;
  bool is_real = true;
};

struct AnnotatedImage {
  std::string name;
  fs::path path;
  std::vector<AnnotatedTuple> tuples;
};

// Of a file, or of all in a folder and in its folders (pairs_layerall_test/NAME.jsonl, ...), by
// name. `subset`: "layer_all" or "layer_first" of NAME.json. Errors (kBadReference): no such file,
// what is no tuple, by line or place.
std::vector<AnnotatedImage> read_order_tuples(const fs::path& path, const std::string& subset);

}  // namespace glint

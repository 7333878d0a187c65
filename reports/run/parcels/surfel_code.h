// SPDX-License-Identifier: MIT
// Surfels in few bits, for whoever renders depth of them: positions, scales, rotations, opacities
// and chosen extra channels on grids, in Z-order; no colours. What a grid moves is bounded by a
// tolerance in metres, so that walls of large surfels get finer normals than small ones.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"
#include "glint/scene/surfels.h"

namespace glint {

// How fine the grids are.
struct SurfelSteps {
  double position = 1e-4;  // metres, of a cell
  int fineness = 40;       // of normals: see normal_cells()
  int scale_levels = 16;   // of a factor of two
  int angle_steps = 64;    // of half a turn within the plane, for scales a factor of two apart
  double logit = 0.05;     // of opacities and extra channels

  // Those whose errors are alike and in all about `tolerance` (metres) in a depth map.
  static SurfelSteps of(double tolerance);
  template <class V>
  void visit(V&& v) {
    v("position", position, "metres, edge of a cell");
    v("fineness", fineness, "quarters of octaves, of normals of surfels of a metre");
    v("scale_levels", scale_levels, "of a factor of two");
    v("angle_steps", angle_steps, "of half a turn within the plane, for scales 1 : 2");
    v("logit", logit, "step of opacities and extra channels");
  }
};

struct SurfelCode {
  Json about;                                 // counts and grids: what unpack_surfels() is told
  std::map<std::string, std::string> fields;  // name -> packed bytes
  std::vector<std::uint32_t> order;           // of the given surfels those that were kept

  std::size_t num_bytes() const;
};

inline constexpr float kDropNone = -1;

// What is kept of surfels.
struct SurfelPacking {
  double tolerance = 0;             // metres, of the grids; 0: floats as they are
  std::vector<std::string> extras;  // extra channels; others are zero when they are unpacked
  // [N] at how many pixels each is seen, as a sum of weights: those at few may move more, those at
  // no more than `drop_below` are dropped. Empty: all alike.
  std::vector<float> seen;
  float drop_below = kDropNone;
  bool draft = false;  // to be unpacked at once: floats are hardly packed
};

// On grids in Z-order, groups of surfels that are seen at similar numbers of pixels one after the
// other; surfels too faint to be drawn anywhere are left out. Where grids do not reach so far (a
// scene of kilometres): floats as they are, in their order.
SurfelCode pack_surfels(const SurfelCloud& cloud, const SurfelPacking& packing);

// Nothing is believed: counts are compared with the bytes before anything is allocated. Colours are
// zero, and there are no further harmonics. Errors (kBadPrediction, naming `where` and the field):
// something is missing, damaged, or no finite number.
SurfelCloud unpack_surfels(
    const Json& about, const std::map<std::string, std::string>& fields, const std::string& where
);

}  // namespace glint

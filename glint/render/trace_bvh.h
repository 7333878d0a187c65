// SPDX-License-Identifier: MIT
// Finds the surfels that a ray meets, nearest first, on Embree's BVH (library glint_trace_embree)
// or on a tree of our own (glint_trace_tree). Surfels are kept in an order in which neighbours in
// space are neighbours in memory; their place in it is called slot. Eight in a row are one
// primitive of the tree and tested at once, one a lane.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/vec.h"
#include "glint/render/nearest_hits.h"
#include "glint/render/surfel_cluster.h"

namespace glint {

class SurfelBvh {
 public:
  SurfelBvh();
  ~SurfelBvh();
  SurfelBvh(const SurfelBvh&) = delete;
  SurfelBvh& operator=(const SurfelBvh&) = delete;

  // Keeps a reference to `surfels`, in slot order. `refit`: the tree of the last call may be kept;
  // for surfels that are the same ones in the same slots.
  // Errors (kEnvironment): Embree fails.
  void update(const std::vector<TracedSurfel>& surfels, bool refit);
  // Adds the hits behind hits.after(). Returns how many clusters it took.
  std::size_t nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const;
  // All surfels, eight consecutive slots each.
  std::span<const SurfelCluster> clusters() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint

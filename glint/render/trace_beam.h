// SPDX-License-Identifier: MIT
// Beams: rays that start near one point and go in about one direction share one search. Surfels
// that no ray of the beam can meet are left out eight at a time; each ray then looks at the others
// from near to far, and stops where its last hit lies in front of all that follow. This finds what
// the tree of trace_bvh.h finds (but for rays within rounding of lying in a surfel's plane), and
// costs less where surfels are so large that their boxes overlap everywhere.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/vec.h"
#include "glint/render/nearest_hits.h"
#include "glint/render/surfel_cluster.h"
#include "glint/render/trace.h"

namespace glint {

// All rays o + t d with |o - origin| <= origin_radius and |d / |d| - direction| <=
// direction_radius.
struct Beam {
  Vec3f origin, direction;  // direction: unit
  float origin_radius, direction_radius;
};

// Box of some rays' origins and unit directions.
struct RayBounds {
  Vec3f low[2], high[2];
};
RayBounds ray_bounds(const Rays& rays, std::span<const std::uint32_t> chosen);
Beam bounding_beam(
    const Rays& rays, std::span<const std::uint32_t> chosen, const RayBounds& bounds
);
// Reorders `chosen` into two halves of the box, of which the first has so many rays as returned.
// `distance`: at which a turn of a ray weighs as much as moving its origin.
std::size_t split_rays(
    const Rays& rays, const RayBounds& bounds, float distance, std::span<std::uint32_t> chosen
);

// Whether a ray can be part of a beam: neither without direction nor of one whose length overflows.
bool fits_beam(Vec3f origin, Vec3f direction);

// Surfels that rays of a beam may meet, structure of arrays.
class BeamSurfels {
 public:
  // Those of `from` that a ray of the beam may meet.
  void cull(const Beam& beam, std::span<const SurfelCluster> from);
  void cull(const Beam& beam, const BeamSurfels& from);
  std::size_t count() const { return count_; }
  float mean_distance() const { return mean_distance_; }  // of their centres from the beam's origin

  // Those of `from`, nearest first.
  void sort(const BeamSurfels& from);
  // Adds the hits of one of the beam's rays behind hits.after(). Only after sort().
  void nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const;

 private:
  // As in SurfelCluster; then h0 x h1, a lower bound of the distance of a hit, indices.
  enum Column {
    kFields = 0,
    kE3 = SurfelCluster::kFields,
    kNearest = kE3 + 3,
    kSurfel,
    kSlot,
    kColumns
  };

  template <class Source>
  void cull_all(const Beam& beam, std::size_t groups, const Source& source);
  void reserve(std::size_t count);
  float* column(int c) { return floats_.get() + static_cast<std::size_t>(c) * stride_; }
  const float* column(int c) const { return floats_.get() + static_cast<std::size_t>(c) * stride_; }
  EightSurfels load(std::size_t group) const;
  void append(const EightSurfels& s, Float8 nearest, unsigned lanes);
  void pad();

  std::unique_ptr<float[]> floats_;  // [kColumns][stride]; a multiple of eight in use
  std::size_t stride_ = 0, count_ = 0;
  float mean_distance_ = 0;
  std::vector<float> group_nearest_;  // of a group and all behind it
};

}  // namespace glint

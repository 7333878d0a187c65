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

// Slots of the surfels that rays of a beam may meet.
class BeamSurfels {
 public:
  // Those of all clusters, or of `from`, that a ray of the beam may meet. `surfels`: by slot.
  void cull(const Beam& beam, std::span<const SurfelCluster> clusters);
  void cull(const Beam& beam, const BeamSurfels& from, const std::vector<TracedSurfel>& surfels);
  std::size_t groups() const { return (count_ + Float8::kLanes - 1) / Float8::kLanes; }
  float mean_distance() const { return mean_distance_; }  // of their centres from the beam's origin
  // Those of `from`, about nearest first.
  void sort(const BeamSurfels& from);

 private:
  friend class BeamSearch;
  EightSurfels load(std::size_t group, const std::vector<TracedSurfel>& surfels) const;
  template <class Source>
  void cull_all(const Beam& beam, std::size_t groups, const Source& source);
  void start(std::size_t most);
  void append(Mask8::Lanes slots, Float8 nearest, unsigned lanes);
  void pad();

  std::size_t count_ = 0;
  float mean_distance_ = 0;
  std::vector<std::uint32_t> slots_;  // whole groups of eight
  std::vector<float> nearest_;        // lower bounds of the distances of their hits
  std::vector<float> nearest_from_;   // after sort(): of a group and all behind it
};

// The search for the hits of a few rays, a part of those of a wider beam. Surfels of the wider beam
// are looked at as far as some ray needs them.
class BeamSearch {
 public:
  // Keeps references to `from`, which is sorted, and `surfels`.
  void start(const Beam& beam, const BeamSurfels& from, const std::vector<TracedSurfel>& surfels);
  // Adds the hits of one of the rays behind hits.after().
  void nearest(Vec3f origin, Vec3f direction, NearestHits& hits);

 private:
  // The fields of TracedSurfel up to max_rho, h0 x h1, lower bounds of the distances of hits,
  // indices.
  enum Column {
    kMaxRho = SurfelCluster::kFields - 1,
    kE3,
    kNearest = kE3 + 3,
    kSurfel,
    kSlot,
    kColumns
  };
  bool has_group(std::size_t group, float limit);
  void cull_next();
  void append(const EightSurfels& s, Float8 nearest, unsigned lanes);
  EightSurfels load(std::size_t group) const;
  void pad();

  Beam beam_;
  const BeamSurfels* from_ = nullptr;
  const std::vector<TracedSurfel>* surfels_ = nullptr;
  std::size_t next_ = 0;  // group of *from_
  std::size_t count_ = 0, stride_ = 0;
  std::vector<float> columns_;       // [kColumns][stride_]
  std::vector<float> nearest_from_;  // lower bound for a group and all behind it
  std::vector<float> nearest_of_;    // and for that group, once it is complete
};

}  // namespace glint

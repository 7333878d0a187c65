// SPDX-License-Identifier: MIT
// Do depth maps, normal maps and cameras agree? Hypotheses about how they were stored are compared
// by how well they fit, so that the wrong convention names itself.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/scene/camera.h"

namespace glint {

// What a depth map holds: planar z, or the distance along the ray.
enum class DepthKind { kPlanar, kRayLength };

// The surface that the depth of view `from` describes, carried into view `to` and compared with
// what is stored at the pixels there: relative differences, for each reading of both maps. Depth
// [H][W][1], 0 where missing.
class DepthAgreement {
 public:
  void add_pair(const Camera& from, ImageView from_depth, const Camera& to, ImageView to_depth);

  std::size_t num_tested(DepthKind kind) const { return of(kind).num_tested; }
  double median_error(DepthKind kind) const;  // over the samples that agree to 5 %
  // Share of the tested samples that come out more than 5 % in front of what `to` sees. A surface
  // may be hidden from `to`, but nothing can stand in front of what it sees: about 0 when all is
  // well.
  double share_in_front(DepthKind kind) const;
  // The reading that fits. Ray length needs 200 agreeing samples and half the error of planar.
  DepthKind best() const;

 private:
  struct Reading {
    std::vector<double> differences;  // absolute, of the samples that agree
    std::size_t num_in_front = 0;
    std::size_t num_tested = 0;
  };

  const Reading& of(DepthKind kind) const { return readings_[static_cast<std::size_t>(kind)]; }
  void add_reading(
      const Camera& from, ImageView from_depth, const Camera& to, ImageView to_depth, DepthKind kind
  );

  std::array<Reading, 2> readings_;  // by DepthKind
};

// Stored normals against normals of the surface that the depth map describes: mean cosine for each
// of the 8 sign patterns of (x, y, z), and for normals stored in world axes.
class NormalAgreement {
 public:
  void add_view(const Camera& camera, ImageView depth, DepthKind kind, ImageView normal);

  std::size_t num_samples() const { return num_samples_; }
  double mean_cosine(int pattern) const;  // bit 0: x is flipped, bit 1: y, bit 2: z
  double mean_cosine_world() const;
  int best_pattern() const;  // 0 unless another one is better by 0.1

 private:
  std::array<double, 8> cosines_{};
  double world_cosine_ = 0;
  std::size_t num_samples_ = 0;
};

// Unit normal of the depth map at a pixel that is not at the border, facing the camera, by central
// differences; nothing where the surface bends or ends.
std::optional<Vec3d> normal_from_depth(
    const Camera& camera, ImageView depth, int x, int y, DepthKind kind
);

// "x and z" for a pattern; "none" for 0.
std::string flipped_axes(int pattern);

// Share of the non-zero normals that face the camera; 1 when there are none.
double facing_share(const Camera& camera, ImageView normal);

}  // namespace glint

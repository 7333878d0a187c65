// SPDX-License-Identifier: MIT
// In which axes are the normals of priors, and does their depth grow with the distance? Decided by
// what is known of the surfaces: true depth where the scene has some, else the sparse points and
// the planes through neighbouring ones. Where that does not tell, what the format documents stays.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "datasets/scene_index.h"

namespace glint {

// Stored normals against known ones, both in camera space, as each of PriorAxes.
struct NormalEvidence {
  std::string source;  // "true depth", "planes through points"
  std::size_t num_samples = 0;
  std::array<double, kPriorAxes.size()> mean_cosine{}, median_angle_deg{};

  std::size_t best() const;
  double margin() const;  // of the best mean cosine to the next
  // The best fits (mean cosine of at least 0.5), is 0.1 ahead, and there are 100 samples.
  bool decided() const;
};

// Stored depth against known depth z: means over views. Some points are wrong or hidden, so signs
// are told by ranks (Spearman's correlation), and z counts between its 5th and 95th percentiles
// elsewhere.
struct DepthEvidence {
  std::string source;  // "true depth", "points"
  std::size_t num_samples = 0, num_views = 0;
  double rank_correlation = 0;     // with z
  double agreeing_views = 0;       // share whose rank correlation has the mean's sign
  double correlation = 0;          // Pearson's, with z
  double inverse_correlation = 0;  // with 1 / z

  PriorDepth best() const;
  // |rank correlation| of at least 0.4, the same sign in three of four views, and 100 samples.
  bool decided() const;
  // Of the best affine map from z (of disparities: from 1 / z) to the stored depth: root mean
  // square over the spread of the stored values, 0 (all explained) to 1 (nothing).
  double residual(PriorDepth as) const;
};

struct PriorEvidence {
  std::optional<NormalEvidence> normal;  // nothing: no such priors, or nothing known
  std::optional<DepthEvidence> depth;
};

// From at most eight views, evenly spaced, training views first. Files that cannot be read are
// passed over: other checks name them.
PriorEvidence weigh_priors(const SceneIndex& index);

// Sets how the views' priors are read: forced by options or scene.json, else by the evidence, else
// as documented; simulated ones always as documented. Adds what was taken and why to prior_notes.
void settle_readings(const PriorOptions& options, const PriorEvidence& evidence, SceneIndex& index);

// Of `dataset check`: evidence against what is documented or stated. Checks: normal-axes (only
// where there is no true depth, which tells more), depth-polarity.
std::vector<Finding> check_readings(
    const PriorOptions& options, const PriorEvidence& evidence, const SceneIndex& index
);

// "prior normal: 100 % of training views, 98.2 % of their pixels", one for each kind of prior.
std::vector<std::string> prior_coverage(const Scene& scene);

}  // namespace glint

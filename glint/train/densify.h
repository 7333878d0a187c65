// SPDX-License-Identifier: MIT
// Adaptive density control [Kerbl23 Sec. 5.2] for surfels [Huang24]: clone, split, prune, opacity
// reset, driven by the mean screen-space gradient. What PGSR [Chen24] adds is off unless asked for:
// clones at sampled places, splits of large surfels by the gradient's absolute value, trimming of
// surfels that few views see (TrainableSet::trim).
#pragma once

#include <cstdint>
#include <vector>

#include "glint/core/rng.h"
#include "glint/render/rasterize.h"
#include "glint/render/trace.h"
#include "glint/scene/surfels.h"
#include "glint/train/adam.h"
#include "glint/train/densify_kernels.h"

namespace glint {

struct DensifyConfig {
  int from = 500, until = 15000, interval = 100;  // steps; `until` is exclusive
  int reset_interval = 3000;                      // steps
  bool resets = true;                // false: no opacity resets, all else as if there were
  float gradient_threshold = 2e-4f;  // mean norm of the NDC gradient, at reference_rows
  int reference_rows = 540;          // image height that the published threshold is for
  float clone_scale = 0.01f;         // x extent: larger surfels are split, not cloned
  float min_opacity = 0.05f;
  float max_scale = 0.1f;  // x extent: larger surfels go, after the first reset
  float reset_opacity = 0.01f;
  int max_surfels = 1000000;
  bool sample_clones = false;  // clones at places drawn from the surfel, not on it
  int max_abs_splits = 0;      // a densification; 0: none; else with RasterSettings' statistics
  float abs_gradient = 8e-4f;  // mean norm of RasterGradient::screen_abs, at reference_rows
  float abs_radius_px = 20;    // and the largest radius since the last, at reference_rows
  int min_observations = 2;    // views a surfel owns a pixel in, or trim() drops it

  template <class V>
  void visit(V&& v) {
    v("densify_from", from, "first step of densification");
    v("densify_until", until, "last step, exclusive");
    v("densify_interval", interval, "steps between densifications");
    v("opacity_reset_interval", reset_interval, "steps between opacity resets");
    v("opacity_resets", resets, "whether there are opacity resets at all");
    v("densify_gradient", gradient_threshold, "mean NDC gradient that asks for more surfels");
    v("densify_reference_rows", reference_rows, "image height the threshold is meant for");
    v("clone_scale", clone_scale, "of the extent: larger surfels are split, smaller ones cloned");
    v("min_opacity", min_opacity, "surfels below are pruned");
    v("max_scale", max_scale, "of the extent: larger surfels are pruned");
    v("max_surfels", max_surfels, "no growth beyond");
    v("sample_clones", sample_clones, "clones are placed at points drawn from the surfel");
    v("max_abs_splits", max_abs_splits, "splits by absolute gradient a densification; 0: none");
    v("abs_gradient", abs_gradient, "mean absolute NDC gradient that splits large surfels");
    v("abs_radius_px", abs_radius_px, "radius that counts as large, pixels at the reference rows");
    v("min_observations", min_observations, "views that must see a surfel, where sets are trimmed");
  }
};

struct DensifyCounts {
  std::size_t cloned = 0, split = 0, pruned = 0;
};

class Densifier {
 public:
  Densifier(DensifyConfig config, float extent, std::uint64_t seed);

  // Adds one view's statistics; call after every backward pass. Deviation: the NDC gradient of a
  // surfel of a given size in pixels grows with 1/rows (the loss is a mean over pixels), so it is
  // brought to the image height that the published threshold is for; otherwise small images would
  // densify without end.
  // Its radii and absolute gradients, where the call had them, are brought there, too. Errors
  // (kUsage): max_abs_splits without them.
  void observe(const RasterOutput& output, const RasterGradient& gradient);
  // For traced sets, which have no screen: the norm of the summed dL/dmean t / 2 [EnvGS], of the
  // surfels that some ray saw. The same scaling by image height.
  void observe(const TraceGradient& gradient, int rows);
  // Densifies and resets when this step is due. `step` counts from 1, after the optimiser's step.
  DensifyCounts update(int step, SurfelCloud& cloud, SurfelAdam& adam);
  // Drops the surfels with keep[i] == 0, their moments and what was observed of them.
  void prune(const std::vector<std::uint8_t>& keep, SurfelCloud& cloud, SurfelAdam& adam);

 private:
  DensifyCounts densify(SurfelCloud& cloud, SurfelAdam& adam, bool prune_large);
  DensifyStatistics statistics(std::size_t count);
  float scale_of(int rows) const;  // that brings gradients to reference_rows
  void observe_footprints(const RasterOutput& output, const RasterGradient& gradient);
  // Surfels to split by their absolute gradient, at most `room`; not those that `taken` marks.
  std::vector<std::uint32_t> abs_splits(const std::vector<std::uint8_t>& taken, std::size_t room)
      const;
  void move_in_plane(SurfelCloud& cloud, std::size_t i);
  void append_splits(SurfelCloud& cloud, const std::vector<std::uint32_t>& parents);

  DensifyConfig config_;
  float extent_;
  Rng rng_;
  FloatArray gradient_sum_;
  Array<std::uint32_t> views_;
  FloatArray abs_sum_, max_radius_;  // empty unless observed
};

// Rows of every array: appended copies, and only the rows with keep[i] != 0 in their order.
void append_rows(SurfelCloud& cloud, const std::vector<std::uint32_t>& rows);
void keep_rows(SurfelCloud& cloud, const std::vector<std::uint8_t>& keep);

}  // namespace glint

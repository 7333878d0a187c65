// SPDX-License-Identifier: MIT
// Adaptive density control [Kerbl23 Sec. 5.2] for surfels [Huang24]: clone, split, prune, opacity
// reset, driven by the mean screen-space gradient. Off unless asked for: what PGSR [Chen24] adds
// (clones at sampled places, splits of large surfels by the gradient's absolute value, trimming of
// surfels that few views see, TrainableSet::trim), and what EnvGS [Xie25] does by the weights that
// surfels have in pixels.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "glint/core/rng.h"
#include "glint/render/rasterize.h"
#include "glint/render/trace.h"
#include "glint/scene/surfels.h"
#include "glint/train/adam.h"
#include "glint/train/densify_kernels.h"

namespace glint {

// What an opacity reset does to a channel beside the colour: min(value, ceiling), from a step on.
struct ChannelReset {
  std::string channel;
  float ceiling;
  int from = 0;
  bool halfway = false;  // not with the resets but between two of them [RT-Splatting]
};

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
  // Of rasterised sets: views count where a pixel has some of the surfel, not where its box is in
  // the image. For sets that mostly are behind others' limits, as the official code traces them.
  bool only_weighted_views = false;
  bool sample_clones = false;  // clones at places drawn from the surfel, not on it
  int max_abs_splits = 0;      // a densification; 0: none; else with RasterSettings' statistics
  float abs_gradient = 8e-4f;  // mean norm of RasterGradient::screen_abs, at reference_rows
  float abs_radius_px = 20;    // and the largest radius since the last, at reference_rows
  int min_observations = 2;    // views a surfel owns a pixel in, or trim() drops it
  // Deviation: after a reset to 0.01 a surfel has to climb above min_opacity before the next
  // pruning, 100 steps later as published. In a short run that is 50, in which many are not seen
  // once. So none is pruned for its opacity before every view came twice, and not within 200 steps.
  int prune_holiday = kHolidayRule;
  // [Xie25] waits longer between densifications in the middle of a run.
  int slow_interval = 0, slow_from = 3000, slow_until = 18000;
  bool split_large = false, cap_by_visibility = false;
  // As GLINT's second release: a set is never pruned below so many surfels, nor below a share of
  // those it starts with; the threshold is lowered to a quantile of the observed gradients (0: as
  // it is); of large surfels only the lightest tenth and those that no view saw go.
  int min_surfels = 0;
  float min_share = 0, gradient_quantile = 0;
  bool prune_light_large = false;
  float scale_limit = 0;  // x extent: scales are held below after each step; 0: they are not
  std::vector<ChannelReset> channel_resets;  // of the set's own channels; its method's to say

  static constexpr int kHolidayRule = -1, kShortestHoliday = 200;

  template <class V>
  void visit(V&& v) {
    v("densify_from", from, "first step of densification");
    v("densify_until", until, "last step, exclusive");
    v("densify_interval", interval, "steps between densifications");
    v("opacity_reset_interval", reset_interval, "steps between opacity resets");
    v("opacity_resets", resets, "whether there are opacity resets at all");
    v("densify_gradient", gradient_threshold, "mean NDC gradient that asks for more surfels");
    v("min_opacity", min_opacity, "surfels below are pruned");
    v("max_surfels", max_surfels, "no growth beyond");
    v("prune_holiday",
      prune_holiday,
      "steps after an opacity reset in which none is pruned for its opacity; -1: max(200, 2 x "
      "training views)");
  }
  // Published windows to this run's steps; scaled(published, at least).
  template <class F>
  void scale(F&& scaled) {
    for (int* window : {&from, &until, &slow_from, &slow_until}) *window = scaled(*window, 1);
    // Fewer views than this would make the gradient statistic too noisy to grow by.
    interval = scaled(interval, 50);
    if (slow_interval > 0) slow_interval = scaled(slow_interval, 50);
    reset_interval = scaled(reset_interval, 300);
  }
  // Of a set that starts at this step of the same clock: no densification by statistics of less
  // than an interval, however windows and interval were rounded.
  void wait_from(int start) { from = std::max(from, start + interval - 1); }
  // With the rule's holiday for so many training views, and resets as far apart that at least a
  // third of the time between two is open to pruning.
  DensifyConfig for_views(std::size_t training_views) const;
  // With min_share in numbers, for a set that starts with so many surfels.
  DensifyConfig for_surfels(std::size_t count) const;
  // Steps between densifications at this step.
  int interval_at(int step) const {
    const bool slow = slow_interval > 0 && step > slow_from && step <= slow_until;
    return slow ? slow_interval : interval;
  }
};

struct DensifyCounts {
  std::size_t cloned = 0, split = 0, pruned = 0;
  bool reset = false;  // opacities
};

// What a densification says of every surfel, those that it adds included.
struct DensifyRows {
  static constexpr float kUnseen = std::numeric_limits<float>::infinity();  // by any view yet

  std::vector<std::uint8_t> keep;
  std::vector<float> weights;  // mean over the views that saw the surfel, of its weight in all
                               // pixels or rays; 0: seen by none

  std::size_t num_kept() const {
    return keep.size() - static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
  }
  void drop(std::size_t i, DensifyCounts& counts) {
    counts.pruned += keep[i];
    keep[i] = 0;
  }
  void add(std::size_t count) {  // surfels that are new
    keep.resize(keep.size() + count, 1);
    weights.resize(keep.size(), kUnseen);
  }
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
  // `more`: the gradient of a second rasterisation of the view, added to the first.
  void observe(
      const RasterOutput& output,
      const RasterGradient& gradient,
      const RasterGradient* more = nullptr
  );
  // For traced sets, which have no screen: the norm of the summed dL/dmean t / 2 [EnvGS], of the
  // surfels that some ray saw. The same scaling by image height.
  void observe(const TraceGradient& gradient, int rows);
  // Densifies and resets when this step is due. `step` counts from 1, after the optimiser's step.
  // Errors (kUsage): a reset of a channel that the cloud does not have.
  DensifyCounts update(int step, SurfelCloud& cloud, SurfelAdam& adam);
  // Drops the surfels with keep[i] == 0, their moments and what was observed of them.
  void prune(const std::vector<std::uint8_t>& keep, SurfelCloud& cloud, SurfelAdam& adam);
  // Lowers scales above scale_limit to it; the optimiser forgets their moments.
  void limit_scales(SurfelCloud& cloud, SurfelAdam& adam) const;
  // Whether opacities are reset at most `margin` steps before or after this one.
  bool resets_within(int step, int margin) const;

  template <class State>
  void visit_state(State& state) {
    state("rng", rng_);
    state("gradient_sum", gradient_sum_);
    state("weight_sum", weight_sum_);
    state("views", views_);
    state("abs_sum", abs_sum_);
    state("max_radius", max_radius_);
  }

 private:
  struct Shape {  // of a split
    int children;
    float shrink;  // children's scale = parent's / shrink
  };
  DensifyCounts densify(SurfelCloud& cloud, SurfelAdam& adam, int step);
  DensifyRows grow(SurfelCloud& cloud, DensifyCounts& counts);
  float mean_gradient(std::size_t i) const;  // of the views that saw the surfel
  float threshold() const;
  std::vector<std::uint32_t> wanted_parents(std::size_t count) const;
  // How many may go.
  std::size_t room_to_prune(const DensifyRows& rows) const;
  void prune_faint(const SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts) const;
  void prune_large(const SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts) const;
  std::size_t most_split_in_five(const DensifyRows& rows) const;
  void split_large(SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts);
  void reset_opacity(SurfelCloud& cloud, SurfelAdam& adam) const;
  void reset_channels(int step, SurfelCloud& cloud, SurfelAdam& adam) const;
  bool in_holiday(int step) const;
  bool is_large(const SurfelCloud& cloud, std::size_t i) const;
  std::vector<float> mean_weights() const;
  DensifyStatistics statistics(std::size_t count);
  float scale_of(int rows) const;  // that brings gradients to reference_rows
  void observe_footprints(const RasterOutput& output, const RasterGradient& gradient);
  // Surfels to split by their absolute gradient, at most `room`; not those that `taken` marks.
  std::vector<std::uint32_t> abs_splits(
      const SurfelCloud& cloud, const std::vector<std::uint8_t>& taken, std::size_t room
  ) const;
  void move_in_plane(SurfelCloud& cloud, std::size_t i);
  void append_splits(SurfelCloud& cloud, const std::vector<std::uint32_t>& parents, Shape shape);

  DensifyConfig config_;
  float extent_;
  Rng rng_;
  FloatArray gradient_sum_, weight_sum_;
  Array<std::uint32_t> views_;
  FloatArray abs_sum_, max_radius_;  // empty unless observed
};

// Rows of every array: appended copies, and only the rows with keep[i] != 0 in their order.
void append_rows(SurfelCloud& cloud, const std::vector<std::uint32_t>& rows);
void keep_rows(SurfelCloud& cloud, const std::vector<std::uint8_t>& keep);

// Where more than `limit` rows are kept, those of the smallest weights (among equals: the first) go
// until `limit` are left.
void drop_lightest(std::size_t limit, DensifyRows& rows, DensifyCounts& counts);

// Lowers the activated values of a column of [N][width] logits to a ceiling.
void lower_logits(float ceiling, std::size_t column, std::size_t width, FloatArray& logits);

}  // namespace glint

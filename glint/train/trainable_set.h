// SPDX-License-Identifier: MIT
// One trainable set of surfels, rasterised or traced: the building block that methods are composed
// of. A set that was only loaded is rendered by the same calls, and has neither gradients nor an
// optimiser.
#pragma once

#include <limits>
#include <memory>
#include <span>

#include "glint/render/surfel_set.h"
#include "glint/train/adam.h"
#include "glint/train/densify.h"

namespace glint {

struct Scene;
struct StepStats;
class TrainingState;

struct SetTraining {
  SurfelRates rates;
  DensifyConfig densify;
  float extent = 1;                // of the scene, metres
  std::uint64_t seed = 0;          // of density control
  std::size_t training_views = 0;  // of the scene, for the holiday of pruning; 0: not known
};
SetTraining training_on(const Scene& scene, const SurfelRates& rates, const DensifyConfig& densify);

// After an update() that reset opacities: an event of the step, "opacities of environment reset";
// `set` is empty where there is one set.
void note_reset(const DensifyCounts& counts, const std::string& set, StepStats& stats);

class TrainableSet final : public SurfelSet {
 public:
  TrainableSet() = default;
  explicit TrainableSet(SurfelCloud cloud) : SurfelSet(std::move(cloud)) {}  // to be rendered
  TrainableSet(SurfelCloud cloud, const SetTraining& training);
  // New surfels at the points, with the rates of their extra channels.
  TrainableSet(const PointCloud& points, const InitialSurfels& initial, SetTraining training);

  // Other surfels from now on, such as those of a file. A set that trains goes on from them with a
  // new optimiser, all others are only rendered.
  void load(SurfelCloud cloud);

  // Back through the last forward(): adds to the gradient of the parameters, and to the statistics
  // of density control. These and all below throw (kUsage) where the set is only to be rendered.
  void backward(const RasterOutputGradient& dL_doutput);
  // Back through a further rasterisation, whose statistics count only if asked for; returns the
  // gradient of what was rasterised.
  const RasterGradient& backward(
      const RasterOutputGradient& dL_doutput, RasterPass& pass, bool observe = false
  );
  // Statistics of a view that was rasterised twice: of the sum of both gradients.
  void observe(const RasterPass& pass, const RasterGradient& a, const RasterGradient& b);
  // Adds the gradient of weight * (mean opacity of the surfels in view, in_view [N]) and returns
  // the mean; 0 where none is.
  double penalise_opacity(float weight, const Array<std::uint8_t>& in_view);
  // The same of the mean binary entropy of these opacities.
  double penalise_opacity_entropy(float weight, const Array<std::uint8_t>& in_view);
  // The same of the binary entropy of an extra channel, averaged by the surfels' weights in a
  // picture, visibility [N], which are constants; 0 where none has any.
  double penalise_entropy(float weight, std::size_t channel, const FloatArray& visibility);
  // backward() for the last trace(); returns the rays' gradient, valid until the next call.
  // observe: the statistics count it.
  const Rays& trace_backward(const TraceOutputGradient& dL_doutput, bool observe = true) {
    return trace_backward(dL_doutput, trace_pass_, observe);
  }
  const Rays& trace_backward(
      const TraceOutputGradient& dL_doutput, TracePass& pass, bool observe = true
  );
  // Whether an update() to come may add surfels. A set that is only rendered does not.
  bool grows() const;
  // From now on positions, scales, rotations and opacities stay; the optimiser moves the rest.
  void freeze_geometry();
  // Only opacities stay, from now on.
  void freeze_opacity() { pause_opacity(std::numeric_limits<int>::max()); }
  // Opacities stay until this step.
  void pause_opacity(int until_step);
  // Optimiser step and, when due, densification. `step` counts from 1.
  DensifyCounts update(int step);
  // Drops surfels that own a pixel (RasterOutput::owned_pixels) in fewer of the cameras than
  // DensifyConfig::min_observations, or than there are cameras [Chen24, PGSR]; returns how many.
  // Between backward() and the next forward(); methods say when. A set whose geometry is frozen
  // stays as it is.
  std::size_t trim(std::span<const Camera> cameras, const RasterSettings& settings = {});
  // Whether opacities are reset at most `margin` steps before or after this one.
  bool resets_within(int step, int margin) const;
  // For changes of the cloud between steps. Its moments have the cloud's rows after an update().
  SurfelAdam& optimiser() { return training().adam; }

  const SurfelCloud& gradient() const { return training().gradient; }

  // Of a set that trains, between two steps: its gradient is zero.
  void visit_state(TrainingState& state);

 private:
  template <class Of>
  double penalise(float weight, const Array<std::uint8_t>& in_view);

  struct Training {
    SetTraining settings;  // as given
    SurfelCloud gradient;
    SurfelRates rates;  // now
    bool frozen_geometry;
    int opacity_paused_until;
    int last_step;  // of update(); 0: none yet
    SurfelAdam adam;
    Densifier densifier;
    Array<double> num_in_view;  // [1], of the last penalty
  };
  Training& training() const;
  // Errors (kBadReference): a cloud of other channels, moments that are no pair of its kind.
  void check_read(const std::vector<std::string>& channels) const;

  std::unique_ptr<Training> training_;  // null: only to be rendered
};

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/trainable_set.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/core/nearest.h"
#include "glint/method.h"
#include "glint/scene/scene.h"
#include "glint/train/opacity_penalty_kernels.h"
#include "glint/train/training_state.h"

namespace glint {

namespace {

SetTraining with_extra_rates(SetTraining training, const InitialSurfels& initial) {
  for (const ExtraChannel& extra : initial.extra) training.rates.extra.push_back(extra.rate);
  training.seed = initial.seed;
  return training;
}

// In how many of the cameras each surfel owns a pixel.
Array<std::uint32_t> count_observations(
    const SurfelSet& set, std::span<const Camera> cameras, RasterSettings settings
) {
  const SilentStep loud(false);  // there is no step before that made room for these views
  settings.with_statistics = true;
  Array<std::uint32_t> views(set.cloud().size(), 0);
  RasterPass pass;
  for (const Camera& camera : cameras) {
    const RasterOutput& output = set.forward(pass, camera, 0, settings);
    run_kernel(
        views.size(), 4096, CountObservations{output.owned_pixels.on_device(), views.on_device()}
    );
  }
  return views;
}

}  // namespace

SetTraining training_on(
    const Scene& scene, const SurfelRates& rates, const DensifyConfig& densify
) {
  return {
      .rates = rates,
      .densify = densify,
      .extent = scene.spatial_scale,
      .training_views = scene.train.size()};
}

void note_reset(const DensifyCounts& counts, const std::string& set, StepStats& stats) {
  if (!counts.reset) return;
  stats.events.push_back(set.empty() ? "opacities reset" : "opacities of " + set + " reset");
}

TrainableSet::TrainableSet(SurfelCloud cloud, const SetTraining& training)
    : SurfelSet(std::move(cloud)),
      training_(std::make_unique<Training>(Training{
          training,
          {},
          training.rates,
          false,
          0,
          0,
          {},
          Densifier(
              training.densify.for_views(training.training_views).for_surfels(cloud_.size()),
              training.extent,
              training.seed
          ),
          {}})) {
  training_->gradient.extra_names = cloud_.extra_names;
  training_->gradient.resize(cloud_.size());
}

TrainableSet::TrainableSet(
    const PointCloud& points, const InitialSurfels& initial, SetTraining training
)
    : TrainableSet(
          surfels_from_points(points, initial), with_extra_rates(std::move(training), initial)
      ) {}

void TrainableSet::load(SurfelCloud cloud) {
  *this = training_ ? TrainableSet(std::move(cloud), training_->settings)
                    : TrainableSet(std::move(cloud));
}

TrainableSet::Training& TrainableSet::training() const {
  GLINT_CHECK(training_ != nullptr, kUsage, "a set that was loaded to be rendered cannot train");
  return *training_;
}

void TrainableSet::backward(const RasterOutputGradient& dL_doutput) {
  backward(dL_doutput, pass_, true);
}

const RasterGradient& TrainableSet::backward(
    const RasterOutputGradient& dL_doutput, RasterPass& pass, bool observe
) {
  Training& t = training();
  const RasterGradient& gradient = raster_backward(cloud_, pass, dL_doutput, t.gradient);
  if (observe) t.densifier.observe(pass.rasterizer.output(), gradient);
  return gradient;
}

void TrainableSet::observe(
    const RasterPass& pass, const RasterGradient& a, const RasterGradient& b
) {
  training().densifier.observe(pass.rasterizer.output(), a, &b);
}

template <class Of>
double TrainableSet::penalise(float weight, const Array<std::uint8_t>& in_view) {
  const SurfelsInView surfels{{cloud_.size()}, in_view.on_device()};
  const ImageSize layout = surfels.layout();
  Array<double>& count = training().num_in_view;
  sum_kernel_to(layout, CountInView{surfels}, count);
  const PenaltyInView<Of> penalty{
      surfels,
      cloud_.opacity_logits.on_device(),
      count.on_device(),
      weight,
      training().gradient.opacity_logits.on_device()};
  return sum_kernel(layout, penalty) / std::max(told(count), 1.0);
}

double TrainableSet::penalise_opacity(float weight, const Array<std::uint8_t>& in_view) {
  return penalise<OfOpacity>(weight, in_view);
}

double TrainableSet::penalise_opacity_entropy(float weight, const Array<std::uint8_t>& in_view) {
  return penalise<OfEntropy>(weight, in_view);
}

double TrainableSet::penalise_entropy(
    float weight, std::size_t channel, const FloatArray& visibility
) {
  Training& t = training();
  const SumInRows weights{{cloud_.size()}, visibility.device_for_reading()};
  const ImageSize layout = weights.layout();
  sum_kernel_to(layout, weights, t.num_in_view);
  const ChannelEntropy entropy{
      weights,
      cloud_.extra_logits.on_device(),
      channel,
      cloud_.num_extra(),
      t.num_in_view.on_device(),
      weight,
      t.gradient.extra_logits.on_device()};
  const double sum = sum_kernel(layout, entropy), of = told(t.num_in_view);
  return of > 0 ? sum / of : 0;
}

const Rays& TrainableSet::trace_backward(
    const TraceOutputGradient& dL_doutput, TracePass& pass, bool observe
) {
  Training& t = training();
  const TraceGradient& gradient = glint::trace_backward(pass, dL_doutput, t.gradient);
  if (observe) t.densifier.observe(gradient, gradient.rays.origins.height());
  return gradient.rays;
}

bool TrainableSet::grows() const {
  return training_ != nullptr && !training_->frozen_geometry &&
         training_->last_step + 1 < training_->settings.densify.until;
}

void TrainableSet::freeze_geometry() {
  Training& t = training();
  t.frozen_geometry = true;
  t.rates.means = t.rates.means_final = 0;
  t.rates.scale = t.rates.rotation = t.rates.opacity = 0;
}

std::size_t TrainableSet::trim(std::span<const Camera> cameras, const RasterSettings& settings) {
  Training& t = training();
  if (t.frozen_geometry) return 0;
  const auto wanted = static_cast<std::size_t>(std::max(0, t.settings.densify.min_observations));
  const std::size_t least = std::min(wanted, cameras.size());
  const Array<std::uint32_t> views = count_observations(*this, cameras, settings);
  std::vector<std::uint8_t> keep(views.size());
  std::transform(views.begin(), views.end(), keep.begin(), [least](std::uint32_t n) {
    return n >= least ? 1 : 0;
  });
  const std::size_t before = cloud_.size();
  t.densifier.prune(keep, cloud_, t.adam);
  keep_rows(t.gradient, keep);
  return before - cloud_.size();
}

void TrainableSet::pause_opacity(int until_step) { training().opacity_paused_until = until_step; }

bool TrainableSet::resets_within(int step, int margin) const {
  return training().densifier.resets_within(step, margin);
}

DensifyCounts TrainableSet::update(int step) {
  Training& t = training();
  const bool still = t.frozen_geometry || step < t.opacity_paused_until;
  t.rates.opacity = still ? 0 : t.settings.rates.opacity;
  t.last_step = step;
  t.adam.step(cloud_, t.gradient, t.rates, t.settings.extent);
  if (!t.frozen_geometry) t.densifier.limit_scales(cloud_, t.adam);
  const DensifyCounts counts =
      t.frozen_geometry ? DensifyCounts{} : t.densifier.update(step, cloud_, t.adam);
  t.gradient.resize(cloud_.size());  // zero after every step
  return counts;
}

void TrainableSet::check_read(const std::vector<std::string>& channels) const {
  GLINT_CHECK(
      cloud_.extra_names == channels,
      kBadReference,
      "surfels with the channels '{}', expected '{}'",
      comma_list(cloud_.extra_names),
      comma_list(channels)
  );
  SurfelCloud &first = training().adam.first(), &second = training().adam.second();
  const bool same = first.extra_names == channels && second.extra_names == channels;
  GLINT_CHECK(
      first.size() == second.size() && (same || first.size() == 0),
      kBadReference,
      "first moments of {} surfels and second ones of {}, or with other channels",
      first.size(),
      second.size()
  );
}

void TrainableSet::visit_state(TrainingState& state) {
  Training& t = training();
  const std::vector<std::string> channels = cloud_.extra_names;
  state("cloud", cloud_);
  state("adam", t.adam);
  state("densifier", t.densifier);
  state("frozen_geometry", t.frozen_geometry);
  state("opacity_paused_until", t.opacity_paused_until);
  state("last_step", t.last_step);
  if (!state.reading()) return;
  check_read(channels);
  if (t.frozen_geometry) freeze_geometry();
  t.gradient = SurfelCloud();
  t.gradient.extra_names = cloud_.extra_names;
  t.gradient.resize(cloud_.size());
}

}  // namespace glint

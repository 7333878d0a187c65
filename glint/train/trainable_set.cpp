// SPDX-License-Identifier: MIT
#include "glint/train/trainable_set.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/train/opacity_penalty_kernels.h"

namespace glint {

namespace {

SetTraining with_extra_rates(SetTraining training, const InitialSurfels& initial) {
  for (const ExtraChannel& extra : initial.extra) training.rates.extra.push_back(extra.rate);
  training.seed = initial.seed;
  return training;
}

}  // namespace

TrainableSet::TrainableSet(SurfelCloud cloud, const SetTraining& training)
    : SurfelSet(std::move(cloud)),
      training_(std::make_unique<Training>(Training{
          training,
          {},
          training.rates,
          false,
          {},
          Densifier(training.densify, training.extent, training.seed)})) {
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

double TrainableSet::penalise_opacity(float weight) {
  constexpr int kRow = 256;  // surfels that are summed one after the other
  const auto count = static_cast<double>(std::max<std::size_t>(cloud_.size(), 1));
  const OpacityPenalty penalty{
      cloud_.opacity_logits.data(),
      cloud_.size(),
      kRow,
      weight / static_cast<float>(count),
      training().gradient.opacity_logits.data()};
  const int rows = static_cast<int>((cloud_.size() + kRow - 1) / kRow);
  return sum_kernel({kRow, rows}, penalty) / count;
}

const Rays& TrainableSet::trace_backward(const TraceOutputGradient& dL_doutput) {
  Training& t = training();
  const TraceGradient& gradient = glint::trace_backward(trace_pass_, dL_doutput, t.gradient);
  t.densifier.observe(gradient, gradient.rays.origins.height());
  return gradient.rays;
}

void TrainableSet::freeze_geometry() {
  Training& t = training();
  t.frozen_geometry = true;
  t.rates.means = t.rates.means_final = 0;
  t.rates.scale = t.rates.rotation = t.rates.opacity = 0;
}

DensifyCounts TrainableSet::update(int step) {
  Training& t = training();
  t.adam.step(cloud_, t.gradient, t.rates, t.settings.extent);
  const DensifyCounts counts =
      t.frozen_geometry ? DensifyCounts{} : t.densifier.update(step, cloud_, t.adam);
  t.gradient.resize(cloud_.size());  // zero after every step
  return counts;
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/reflection_bootstrap.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/render/activations.h"
#include "glint/render/glass_transport.h"

namespace glint {

namespace {

template <class Select>
void forget(SurfelAdam& optimiser, Select&& array_of) {
  for (SurfelCloud* moments : {&optimiser.first(), &optimiser.second()})
    std::fill(array_of(*moments).begin(), array_of(*moments).end(), 0.0f);
}

bool mirrors_little(const SurfelCloud& cloud, std::size_t i, float below) {
  const std::size_t width = cloud.num_extra();
  const auto first = cloud.extra_logits.begin() + static_cast<std::ptrdiff_t>(i * width);
  return std::all_of(first, first + static_cast<std::ptrdiff_t>(width), [&](float value) {
    return sigmoid(value) <= below;
  });
}

std::size_t specular_column(const SurfelCloud& cloud) {
  const auto& names = cloud.extra_names;
  const auto found = std::find(names.begin(), names.end(), kSpecular);
  GLINT_CHECK(
      found != names.end(), kUsage, "normal propagation: the set has no channel '{}'", kSpecular
  );
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

void sabotage_colors(
    float range, float below, Rng& rng, SurfelCloud& cloud, SurfelAdam& optimiser
) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!mirrors_little(cloud, i, below)) continue;
    for (std::size_t c = 0; c < 3; ++c) cloud.sh_dc[3 * i + c] += rng.uniform(-range, range);
  }
  forget(optimiser, [](SurfelCloud& moments) -> FloatArray& { return moments.sh_dc; });
}

void propagate_normals(
    float opacity, float enlarge, float above, SurfelCloud& cloud, SurfelAdam& optimiser
) {
  const std::size_t column = specular_column(cloud), width = cloud.num_extra();
  const float lowest = logit(opacity), growth = std::log(enlarge);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.opacity_logits[i] = std::max(cloud.opacity_logits[i], lowest);
    if (sigmoid(cloud.extra_logits[i * width + column]) < above) continue;
    for (std::size_t axis = 0; axis < 2; ++axis) cloud.log_scales[2 * i + axis] += growth;
  }
  forget(optimiser, [](SurfelCloud& moments) -> FloatArray& { return moments.opacity_logits; });
  forget(optimiser, [](SurfelCloud& moments) -> FloatArray& { return moments.log_scales; });
}

ReflectionBootstrap::ReflectionBootstrap(const BootstrapConfig& config, std::uint64_t seed)
    : config_(config), rng_(seed, hash_name("bootstrap")) {}

void ReflectionBootstrap::update(int step, TrainableSet& set) {
  const bool due = step > config_.from && step <= config_.until && step % config_.interval == 0;
  const bool wanted = config_.color_sabotage || config_.normal_propagation;
  // Published: not in an iteration with a reset. In a short run the two intervals need not be
  // multiples of each other, and a growth soon after a reset would undo it.
  if (!due || !wanted || set.resets_within(step, config_.interval / 2)) return;
  if (config_.normal_propagation) {
    propagate_normals(
        config_.raised_opacity, config_.enlarge, config_.enlarge_above, set.cloud(), set.optimiser()
    );
    set.pause_opacity(step + config_.opacity_pause);
  }
  if (config_.color_sabotage)
    sabotage_colors(
        config_.sabotage_range, config_.sabotage_below, rng_, set.cloud(), set.optimiser()
    );
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/densify.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/activations.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // surfels a block
constexpr int kChildren = 2;
constexpr float kChildShrink = 1.6f;  // children's scale = parent's / 1.6

float max_scale_of(const SurfelCloud& cloud, std::size_t i) {
  return std::exp(std::max(cloud.log_scales[2 * i], cloud.log_scales[2 * i + 1]));
}

}  // namespace

void append_rows(SurfelCloud& cloud, const std::vector<std::uint32_t>& rows) {
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
    array.reserve(array.size() + rows.size() * width);
    for (const std::uint32_t row : rows)
      for (std::size_t k = 0; k < width; ++k) array.push_back(array[row * width + k]);
  });
}

template <class Values>
static void keep_rows(Values& array, std::size_t width, const std::vector<std::uint8_t>& keep) {
  std::size_t next = 0;
  for (std::size_t row = 0; row < keep.size(); ++row) {
    if (keep[row] == 0) continue;
    std::copy_n(array.begin() + row * width, width, array.begin() + next * width);
    ++next;
  }
  array.resize(next * width);
}

void keep_rows(SurfelCloud& cloud, const std::vector<std::uint8_t>& keep) {
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
    keep_rows(array, width, keep);
  });
}

// Rows of the cloud and of its moments; new ones have no moments yet.
static void keep_surfels(
    const std::vector<std::uint8_t>& keep, SurfelCloud& cloud, SurfelAdam& adam
) {
  for (SurfelCloud* moments : {&adam.first(), &adam.second()}) {
    moments->resize(keep.size());
    keep_rows(*moments, keep);
  }
  keep_rows(cloud, keep);
}

Densifier::Densifier(DensifyConfig config, float extent, std::uint64_t seed)
    : config_(config), extent_(extent), rng_(seed, hash_name("densify")) {}

DensifyStatistics Densifier::statistics(std::size_t count) {
  gradient_sum_.resize(count, 0.0f);
  views_.resize(count, 0);
  return {gradient_sum_.data(), views_.data()};
}

float Densifier::scale_of(int rows) const {
  return static_cast<float>(rows) / static_cast<float>(config_.reference_rows);
}

void Densifier::observe(const RasterOutput& output, const RasterGradient& gradient) {
  const std::size_t count = output.in_view.size();
  const float scale = scale_of(output.alpha.height());
  run_kernel(
      count,
      kGrain,
      ObserveRaster{statistics(count), output.in_view.data(), gradient.screen.data(), scale}
  );
  const bool has_footprints = !gradient.screen_abs.empty() && !output.radii.empty();
  GLINT_CHECK(
      has_footprints || config_.max_abs_splits == 0 || count == 0,
      kUsage,
      "densify: max_abs_splits {} needs RasterSettings::with_statistics; set it, or the field to 0",
      config_.max_abs_splits
  );
  if (has_footprints) observe_footprints(output, gradient);
}

void Densifier::observe_footprints(const RasterOutput& output, const RasterGradient& gradient) {
  const std::size_t count = output.in_view.size();
  abs_sum_.resize(count, 0.0f);
  max_radius_.resize(count, 0.0f);
  run_kernel(
      count,
      kGrain,
      ObserveFootprint{
          output.in_view.data(),
          gradient.screen_abs.data(),
          output.radii.data(),
          scale_of(output.alpha.height()),
          abs_sum_.data(),
          max_radius_.data()}
  );
}

void Densifier::observe(const TraceGradient& gradient, int rows) {
  const std::size_t count = gradient.visibility.size();
  run_kernel(
      count,
      kGrain,
      ObserveTrace{
          statistics(count),
          gradient.visibility.data(),
          gradient.half_depths.data(),
          scale_of(rows)}
  );
}

// By an offset drawn from the surfel's Gaussian in its plane.
void Densifier::move_in_plane(SurfelCloud& cloud, std::size_t i) {
  const float *s = &cloud.log_scales[2 * i], *q = &cloud.rotations[4 * i];
  const Mat3f rotation = rotation_matrix(Vec4f{q[0], q[1], q[2], q[3]});
  const Vec3f offset =
      rotation * Vec3f{rng_.normal() * std::exp(s[0]), rng_.normal() * std::exp(s[1]), 0};
  for (int axis = 0; axis < 3; ++axis) cloud.means[3 * i + axis] += offset[axis];
}

// Children are drawn from the parent's Gaussian in its plane.
void Densifier::append_splits(SurfelCloud& cloud, const std::vector<std::uint32_t>& parents) {
  for (int child = 0; child < kChildren; ++child) {
    const std::size_t first = cloud.size();
    append_rows(cloud, parents);
    for (std::size_t i = first; i < cloud.size(); ++i) {
      move_in_plane(cloud, i);
      for (int axis = 0; axis < 2; ++axis) cloud.log_scales[2 * i + axis] -= std::log(kChildShrink);
    }
  }
}

std::vector<std::uint32_t> Densifier::abs_splits(
    const std::vector<std::uint8_t>& taken, std::size_t room
) const {
  std::vector<std::uint32_t> result;
  if (config_.max_abs_splits == 0) return result;
  const auto mean = [&](std::uint32_t i) { return abs_sum_[i] / static_cast<float>(views_[i]); };
  for (std::uint32_t i = 0; i < abs_sum_.size(); ++i)
    if (taken[i] == 0 && views_[i] > 0 && mean(i) >= config_.abs_gradient &&
        max_radius_[i] > config_.abs_radius_px)
      result.push_back(i);
  // The largest gradients where there are too many.
  std::stable_sort(result.begin(), result.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mean(a) > mean(b);
  });
  room = std::min(room, static_cast<std::size_t>(config_.max_abs_splits));
  result.resize(std::min(result.size(), room));
  return result;
}

DensifyCounts Densifier::densify(SurfelCloud& cloud, SurfelAdam& adam, bool prune_large) {
  const std::size_t count = cloud.size();
  std::vector<std::uint32_t> clones, splits;
  std::vector<std::uint8_t> taken(count, 0);
  for (std::uint32_t i = 0; i < count; ++i) {
    const float mean = views_[i] > 0 ? gradient_sum_[i] / static_cast<float>(views_[i]) : 0.0f;
    const bool room =
        count + clones.size() + splits.size() < static_cast<std::size_t>(config_.max_surfels);
    if (mean < config_.gradient_threshold || !room) continue;
    (max_scale_of(cloud, i) > config_.clone_scale * extent_ ? splits : clones).push_back(i);
    taken[i] = 1;
  }
  const std::size_t grown = count + clones.size() + splits.size();
  const auto cap = static_cast<std::size_t>(config_.max_surfels);
  for (const std::uint32_t i : abs_splits(taken, cap - std::min(cap, grown))) splits.push_back(i);
  append_rows(cloud, clones);
  for (std::size_t i = count; config_.sample_clones && i < cloud.size(); ++i)
    move_in_plane(cloud, i);
  append_splits(cloud, splits);

  std::vector<std::uint8_t> keep(cloud.size(), 1);
  for (const std::uint32_t parent : splits) keep[parent] = 0;
  const float min_logit = logit(config_.min_opacity);
  DensifyCounts counts{clones.size(), splits.size(), 0};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const bool faint = cloud.opacity_logits[i] < min_logit;
    const bool large = prune_large && max_scale_of(cloud, i) > config_.max_scale * extent_;
    if (keep[i] == 0 || !(faint || large)) continue;
    keep[i] = 0;
    ++counts.pruned;
  }
  keep_surfels(keep, cloud, adam);
  return counts;
}

void Densifier::prune(const std::vector<std::uint8_t>& keep, SurfelCloud& cloud, SurfelAdam& adam) {
  synchronize();
  keep_surfels(keep, cloud, adam);
  const auto keep_observed = [&](auto& values) {
    if (values.empty()) return;
    values.resize(keep.size());
    keep_rows(values, 1, keep);
  };
  keep_observed(gradient_sum_);
  keep_observed(views_);
  keep_observed(abs_sum_);
  keep_observed(max_radius_);
}

DensifyCounts Densifier::update(int step, SurfelCloud& cloud, SurfelAdam& adam) {
  DensifyCounts counts;
  if (step >= config_.until) return counts;
  if (step > config_.from && step % config_.interval == 0) {
    synchronize();
    counts = densify(cloud, adam, step > config_.reset_interval);
    gradient_sum_.assign(cloud.size(), 0.0f);
    views_.assign(cloud.size(), 0);
    if (!abs_sum_.empty()) abs_sum_.assign(cloud.size(), 0.0f);
    if (!max_radius_.empty()) max_radius_.assign(cloud.size(), 0.0f);
  }
  if (config_.resets && step % config_.reset_interval == 0) {
    synchronize();
    const float ceiling = logit(config_.reset_opacity);
    for (float& value : cloud.opacity_logits) value = std::min(value, ceiling);
    std::fill(adam.first().opacity_logits.begin(), adam.first().opacity_logits.end(), 0.0f);
    std::fill(adam.second().opacity_logits.begin(), adam.second().opacity_logits.end(), 0.0f);
  }
  return counts;
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/densify.h"

#include <algorithm>
#include <cmath>

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

void keep_rows(SurfelCloud& cloud, const std::vector<std::uint8_t>& keep) {
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
    std::size_t next = 0;
    for (std::size_t row = 0; row < keep.size(); ++row) {
      if (keep[row] == 0) continue;
      std::copy_n(array.begin() + row * width, width, array.begin() + next * width);
      ++next;
    }
    array.resize(next * width);
  });
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

// Children are drawn from the parent's Gaussian in its plane.
void Densifier::append_splits(SurfelCloud& cloud, const std::vector<std::uint32_t>& parents) {
  for (int child = 0; child < kChildren; ++child) {
    const std::size_t first = cloud.size();
    append_rows(cloud, parents);
    for (std::size_t i = first; i < cloud.size(); ++i) {
      const float *s = &cloud.log_scales[2 * i], *q = &cloud.rotations[4 * i];
      const Mat3f rotation = rotation_matrix(Vec4f{q[0], q[1], q[2], q[3]});
      const Vec3f offset =
          rotation * Vec3f{rng_.normal() * std::exp(s[0]), rng_.normal() * std::exp(s[1]), 0};
      for (int axis = 0; axis < 3; ++axis) cloud.means[3 * i + axis] += offset[axis];
      for (int axis = 0; axis < 2; ++axis) cloud.log_scales[2 * i + axis] -= std::log(kChildShrink);
    }
  }
}

DensifyCounts Densifier::densify(SurfelCloud& cloud, SurfelAdam& adam, bool prune_large) {
  const std::size_t count = cloud.size();
  std::vector<std::uint32_t> clones, splits;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float mean = views_[i] > 0 ? gradient_sum_[i] / static_cast<float>(views_[i]) : 0.0f;
    const bool room =
        count + clones.size() + splits.size() < static_cast<std::size_t>(config_.max_surfels);
    if (mean < config_.gradient_threshold || !room) continue;
    (max_scale_of(cloud, i) > config_.clone_scale * extent_ ? splits : clones).push_back(i);
  }
  append_rows(cloud, clones);
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
  for (SurfelCloud* moments : {&adam.first(), &adam.second()}) {
    moments->resize(keep.size());
    keep_rows(*moments, keep);
  }
  keep_rows(cloud, keep);
  return counts;
}

DensifyCounts Densifier::update(int step, SurfelCloud& cloud, SurfelAdam& adam) {
  DensifyCounts counts;
  if (step >= config_.until) return counts;
  if (step > config_.from && step % config_.interval == 0) {
    synchronize();
    counts = densify(cloud, adam, step > config_.reset_interval);
    gradient_sum_.assign(cloud.size(), 0.0f);
    views_.assign(cloud.size(), 0);
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

// SPDX-License-Identifier: MIT
#include "glint/train/densify.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/activations.h"
#include "glint/render/void_steps.h"
#include "glint/train/row_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // surfels a block
constexpr float kLightest = 0.1f;     // share of surfels that are pruned rather than split in five
constexpr float kUnderCap = 0.9f;     // share of the cap that is left by it
constexpr int kChildrenOfLarge = 5;

float max_scale_of(const SurfelCloud& cloud, std::size_t i) {
  return std::exp(std::max(cloud.log_scales[2 * i], cloud.log_scales[2 * i + 1]));
}

// The weight below which `share` of those lie that are kept and not new.
float light_quantile(const DensifyRows& rows, float share) {
  std::vector<float> weights;
  for (std::size_t i = 0; i < rows.keep.size(); ++i)
    if (rows.keep[i] != 0 && rows.weights[i] < DensifyRows::kUnseen)
      weights.push_back(rows.weights[i]);
  if (weights.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<float>(weights.size()));
  std::nth_element(weights.begin(), weights.begin() + rank, weights.end());
  return weights[static_cast<std::size_t>(rank)];
}

// Column and number of columns of an extra channel.
std::pair<std::size_t, std::size_t> column_of(const SurfelCloud& cloud, const std::string& name) {
  const auto& names = cloud.extra_names;
  const auto found = std::find(names.begin(), names.end(), name);
  GLINT_CHECK(
      found != names.end(), kUsage, "density control: the set has no channel '{}' to reset", name
  );
  return {static_cast<std::size_t>(found - names.begin()), names.size()};
}

void forget(std::size_t column, std::size_t width, FloatArray& moments) {
  run_kernel(moments.size() / width, kGrain, ClearColumn{column, width, moments.on_device()});
}

Array<std::uint32_t> kept_rows(const std::vector<std::uint8_t>& keep) {
  Array<std::uint32_t> rows;
  rows.reserve(keep.size());
  for (std::uint32_t row = 0; row < keep.size(); ++row)
    if (keep[row] != 0) rows.push_back(row);
  return rows;
}

// Rows of an array whose values are on the device alone stay there.
void append_on_device(const Array<std::uint32_t>& rows, std::size_t width, FloatArray& array) {
  const std::size_t first = array.size(), count = rows.size() * width;
  array.resize(first + count);
  float* values = array.on_device();
  run_kernel(count, kGrain, GatherRows{values, rows.on_device(), width, values + first});
}
void keep_on_device(const Array<std::uint32_t>& rows, std::size_t width, FloatArray& array) {
  FloatArray kept(rows.size() * width);
  if (!kept.empty())
    run_kernel(
        kept.size(),
        kGrain,
        GatherRows{std::as_const(array).on_device(), rows.on_device(), width, kept.on_device()}
    );
  array = std::move(kept);
}

}  // namespace

DensifyConfig DensifyConfig::for_views(std::size_t training_views) const {
  DensifyConfig config = *this;
  if (prune_holiday < 0)
    config.prune_holiday = std::max(kShortestHoliday, 2 * static_cast<int>(training_views));
  if (resets) config.reset_interval = std::max(reset_interval, (3 * config.prune_holiday + 1) / 2);
  return config;
}

DensifyConfig DensifyConfig::for_surfels(std::size_t count) const {
  DensifyConfig config = *this;
  const auto share = static_cast<int>(std::ceil(min_share * static_cast<float>(count)));
  config.min_surfels = std::max(min_surfels, share);
  return config;
}

void drop_lightest(std::size_t limit, DensifyRows& rows, DensifyCounts& counts) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < rows.keep.size(); ++i)
    if (rows.keep[i] != 0) kept.push_back(i);
  if (kept.size() <= limit) return;
  std::stable_sort(kept.begin(), kept.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rows.weights[a] < rows.weights[b];
  });
  kept.resize(kept.size() - limit);
  for (const std::uint32_t i : kept) rows.drop(i, counts);
}

void lower_logits(float ceiling, std::size_t column, std::size_t width, FloatArray& logits) {
  run_kernel(
      logits.size() / width, kGrain, LowerColumn{column, width, logit(ceiling), logits.on_device()}
  );
}

void append_rows(SurfelCloud& cloud, const std::vector<std::uint32_t>& rows) {
  const Array<std::uint32_t> list(rows.begin(), rows.end());
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
    if (array.is_on_device_alone()) return append_on_device(list, width, array);
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
  const Array<std::uint32_t> rows = kept_rows(keep);
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t width) {
    if (array.is_on_device_alone())
      keep_on_device(rows, width, array);
    else
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
  weight_sum_.resize(count, 0.0f);
  views_.resize(count, 0);
  return {gradient_sum_.on_device(), weight_sum_.on_device(), views_.on_device(), void_word()};
}

float Densifier::scale_of(int rows) const {
  return static_cast<float>(rows) / static_cast<float>(config_.reference_rows);
}

void Densifier::observe(
    const RasterOutput& output, const RasterGradient& gradient, const RasterGradient* more
) {
  const std::size_t count = output.in_view.size();
  const float scale = scale_of(output.alpha.height());
  const float* second = more != nullptr ? more->screen.device_for_reading() : nullptr;
  const float* visibility =
      output.visibility.size() == count ? output.visibility.device_for_reading() : nullptr;
  run_kernel(
      count,
      kGrain,
      ObserveRaster{
          statistics(count),
          output.in_view.on_device(),
          gradient.screen.on_device(),
          second,
          visibility,
          scale,
          config_.only_weighted_views}
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
          output.in_view.on_device(),
          gradient.screen_abs.on_device(),
          output.radii.on_device(),
          output.owned_pixels.on_device(),
          scale_of(output.alpha.height()),
          abs_sum_.on_device(),
          max_radius_.on_device(),
          void_word()}
  );
}

void Densifier::observe(const TraceGradient& gradient, int rows) {
  const std::size_t count = gradient.visibility.size();
  run_kernel(
      count,
      kGrain,
      ObserveTrace{
          statistics(count),
          gradient.visibility.on_device(),
          gradient.half_depths.on_device(),
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
void Densifier::append_splits(
    SurfelCloud& cloud, const std::vector<std::uint32_t>& parents, Shape shape
) {
  for (int child = 0; child < shape.children; ++child) {
    const std::size_t first = cloud.size();
    append_rows(cloud, parents);
    for (std::size_t i = first; i < cloud.size(); ++i) {
      move_in_plane(cloud, i);
      for (int axis = 0; axis < 2; ++axis) cloud.log_scales[2 * i + axis] -= std::log(shape.shrink);
    }
  }
}

std::vector<std::uint32_t> Densifier::abs_splits(
    const SurfelCloud& cloud, const std::vector<std::uint8_t>& taken, std::size_t room
) const {
  std::vector<std::uint32_t> result;
  if (config_.max_abs_splits == 0) return result;
  const auto mean = [&](std::uint32_t i) { return abs_sum_[i] / static_cast<float>(views_[i]); };
  for (std::uint32_t i = 0; i < abs_sum_.size(); ++i)
    if (taken[i] == 0 && views_[i] > 0 && mean(i) >= config_.abs_gradient &&
        max_radius_[i] > config_.abs_radius_px &&
        max_scale_of(cloud, i) > config_.clone_scale * extent_)
      result.push_back(i);
  // The largest gradients where there are too many.
  std::stable_sort(result.begin(), result.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mean(a) > mean(b);
  });
  room = std::min(room, static_cast<std::size_t>(config_.max_abs_splits));
  result.resize(std::min(result.size(), room));
  return result;
}

std::vector<float> Densifier::mean_weights() const {
  std::vector<float> weights(views_.size(), 0.0f);
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (views_[i] > 0) weights[i] = weight_sum_[i] / static_cast<float>(views_[i]);
  return weights;
}

float Densifier::mean_gradient(std::size_t i) const {
  return views_[i] > 0 ? gradient_sum_[i] / static_cast<float>(views_[i]) : 0.0f;
}

float Densifier::threshold() const {
  std::vector<float> seen;
  if (config_.gradient_quantile > 0)
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (views_[i] > 0) seen.push_back(mean_gradient(i));
  if (seen.empty()) return config_.gradient_threshold;
  const auto rank =
      static_cast<std::ptrdiff_t>(config_.gradient_quantile * static_cast<float>(seen.size() - 1));
  std::nth_element(seen.begin(), seen.begin() + rank, seen.end());
  return std::min(config_.gradient_threshold, seen[static_cast<std::size_t>(rank)]);
}

// Those whose mean gradient asks for more surfels, in their order; where there is no room for all,
// those of the largest gradients (among equals: the first).
std::vector<std::uint32_t> Densifier::wanted_parents(std::size_t count) const {
  const float least = threshold();
  std::vector<std::uint32_t> parents;
  for (std::uint32_t i = 0; i < count; ++i)
    if (mean_gradient(i) >= least) parents.push_back(i);
  const auto most = static_cast<std::size_t>(config_.max_surfels);
  const std::size_t room = most - std::min(most, count);
  if (config_.cap_by_visibility || parents.size() <= room) return parents;
  std::stable_sort(parents.begin(), parents.end(), [&](std::uint32_t a, std::uint32_t b) {
    return mean_gradient(a) > mean_gradient(b);
  });
  parents.resize(room);
  std::sort(parents.begin(), parents.end());
  return parents;
}

// Clones and splits where the mean gradient asks for more surfels.
DensifyRows Densifier::grow(SurfelCloud& cloud, DensifyCounts& counts) {
  constexpr Shape kSplit{2, 1.6f};
  const std::size_t count = cloud.size();
  statistics(count);
  std::vector<std::uint32_t> clones, splits;
  std::vector<std::uint8_t> taken(count, 0);
  for (const std::uint32_t i : wanted_parents(count)) {
    (max_scale_of(cloud, i) > config_.clone_scale * extent_ ? splits : clones).push_back(i);
    taken[i] = 1;
  }
  const std::size_t grown = count + clones.size() + splits.size();
  const auto cap = static_cast<std::size_t>(config_.max_surfels);
  for (const std::uint32_t i : abs_splits(cloud, taken, cap - std::min(cap, grown)))
    splits.push_back(i);
  append_rows(cloud, clones);
  for (std::size_t i = count; config_.sample_clones && i < cloud.size(); ++i)
    move_in_plane(cloud, i);
  append_splits(cloud, splits, kSplit);
  DensifyRows rows{std::vector<std::uint8_t>(count, 1), mean_weights()};
  rows.add(cloud.size() - count);
  for (const std::uint32_t parent : splits) rows.keep[parent] = 0;
  counts.cloned = clones.size();
  counts.split = splits.size();
  return rows;
}

std::size_t Densifier::room_to_prune(const DensifyRows& rows) const {
  const auto least = static_cast<std::size_t>(config_.min_surfels);
  const std::size_t kept = rows.num_kept();
  return kept - std::min(kept, least);
}

// Where not all may go, the faintest (among equals: the first).
void Densifier::prune_faint(const SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts)
    const {
  const float min_logit = logit(config_.min_opacity);
  std::vector<std::uint32_t> faint;
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (rows.keep[i] != 0 && cloud.opacity_logits[i] < min_logit) faint.push_back(i);
  const std::size_t room = room_to_prune(rows);
  if (faint.size() > room) {
    std::stable_sort(faint.begin(), faint.end(), [&](std::uint32_t a, std::uint32_t b) {
      return cloud.opacity_logits[a] < cloud.opacity_logits[b];
    });
    faint.resize(room);
  }
  for (const std::uint32_t i : faint) rows.drop(i, counts);
}

bool Densifier::is_large(const SurfelCloud& cloud, std::size_t i) const {
  return max_scale_of(cloud, i) > config_.max_scale * extent_;
}

void Densifier::prune_large(const SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts)
    const {
  const bool light_only = config_.prune_light_large;
  const float light = light_only ? light_quantile(rows, kLightest) : 0;
  std::size_t room = room_to_prune(rows);
  for (std::size_t i = 0; i < cloud.size() && room > 0; ++i) {
    if (rows.keep[i] == 0 || !is_large(cloud, i)) continue;
    if (light_only && rows.weights[i] >= light && rows.weights[i] > 0) continue;
    rows.drop(i, counts);
    --room;
  }
}

// Caps by visibility drop what is too much afterwards.
std::size_t Densifier::most_split_in_five(const DensifyRows& rows) const {
  if (config_.cap_by_visibility) return rows.keep.size();
  const auto cap = static_cast<std::size_t>(config_.max_surfels);
  const std::size_t kept = rows.num_kept();
  return (cap - std::min(cap, kept)) / (kChildrenOfLarge - 1);
}

// A large surfel goes where it is among those of the least weight; others become five of 1/2.5 of
// its size [Xie25]: 1 / (ratio 0.5 x 5). Where there is no room for the five, it stays.
void Densifier::split_large(SurfelCloud& cloud, DensifyRows& rows, DensifyCounts& counts) {
  constexpr Shape kFive{kChildrenOfLarge, 2.5f};
  const float light = light_quantile(rows, kLightest);
  const std::size_t most = most_split_in_five(rows);
  std::vector<std::uint32_t> parents;
  for (std::uint32_t i = 0; i < rows.keep.size(); ++i) {
    if (rows.keep[i] == 0 || !is_large(cloud, i)) continue;
    if (rows.weights[i] < light) {
      rows.drop(i, counts);
    } else if (parents.size() < most) {
      parents.push_back(i);
      rows.keep[i] = 0;
    }
  }
  counts.split += parents.size();
  append_splits(cloud, parents, kFive);
  rows.add(cloud.size() - rows.keep.size());
}

DensifyCounts Densifier::densify(SurfelCloud& cloud, SurfelAdam& adam, int step) {
  DensifyCounts counts;
  DensifyRows rows = grow(cloud, counts);
  if (!in_holiday(step)) prune_faint(cloud, rows, counts);
  if (config_.split_large)
    split_large(cloud, rows, counts);
  else if (step > config_.reset_interval)
    prune_large(cloud, rows, counts);
  if (config_.cap_by_visibility) {
    const float limit = kUnderCap * static_cast<float>(config_.max_surfels);
    drop_lightest(static_cast<std::size_t>(limit), rows, counts);
  }
  keep_surfels(rows.keep, cloud, adam);
  return counts;
}

void Densifier::prune(const std::vector<std::uint8_t>& keep, SurfelCloud& cloud, SurfelAdam& adam) {
  keep_surfels(keep, cloud, adam);
  const auto keep_observed = [&](auto& values) {
    if (values.empty()) return;
    values.resize(keep.size());
    keep_rows(values, 1, keep);
  };
  keep_observed(gradient_sum_);
  keep_observed(weight_sum_);
  keep_observed(views_);
  keep_observed(abs_sum_);
  keep_observed(max_radius_);
}

// Steps count from the last reset, which a step that resets densifies before.
bool Densifier::in_holiday(int step) const {
  if (!config_.resets || step <= config_.reset_interval) return false;
  return (step - 1) % config_.reset_interval + 1 < config_.prune_holiday;
}

bool Densifier::resets_within(int step, int margin) const {
  if (!config_.resets) return false;
  const int since = step % config_.reset_interval;
  const int last = step - since, next = last + config_.reset_interval;
  const bool after = last > 0 && last < config_.until && since <= margin;
  return after || (next < config_.until && next - step <= margin);
}

void Densifier::limit_scales(SurfelCloud& cloud, SurfelAdam& adam) const {
  if (config_.scale_limit <= 0) return;
  constexpr float kBelow =
      4e-6f;  // so that rounding makes none larger than a max_scale of the same
  run_kernel(
      cloud.log_scales.size(),
      kGrain,
      LimitScales{
          std::log(config_.scale_limit * extent_) - kBelow,
          cloud.log_scales.on_device(),
          adam.first().log_scales.on_device(),
          adam.second().log_scales.on_device()}
  );
}

void Densifier::reset_opacity(SurfelCloud& cloud, SurfelAdam& adam) const {
  lower_logits(config_.reset_opacity, 0, 1, cloud.opacity_logits);
  forget(0, 1, adam.first().opacity_logits);
  forget(0, 1, adam.second().opacity_logits);
}

void Densifier::reset_channels(int step, SurfelCloud& cloud, SurfelAdam& adam) const {
  const int since = step % config_.reset_interval;
  for (const ChannelReset& channel : config_.channel_resets) {
    const bool due = since == (channel.halfway ? config_.reset_interval / 2 : 0);
    if (!due || step < std::max(channel.from, config_.reset_interval)) continue;
    const auto [column, width] = column_of(cloud, channel.channel);
    lower_logits(channel.ceiling, column, width, cloud.extra_logits);
    forget(column, width, adam.first().extra_logits);
    forget(column, width, adam.second().extra_logits);
  }
}

DensifyCounts Densifier::update(int step, SurfelCloud& cloud, SurfelAdam& adam) {
  DensifyCounts counts;
  if (step >= config_.until) return counts;
  if (step > config_.from && step % config_.interval_at(step) == 0) {
    counts = densify(cloud, adam, step);
    gradient_sum_.assign(cloud.size(), 0.0f);
    weight_sum_.assign(cloud.size(), 0.0f);
    views_.assign(cloud.size(), 0);
    if (!abs_sum_.empty()) abs_sum_.assign(cloud.size(), 0.0f);
    if (!max_radius_.empty()) max_radius_.assign(cloud.size(), 0.0f);
  }
  if (!config_.resets) return counts;
  counts.reset = step % config_.reset_interval == 0;
  if (counts.reset) reset_opacity(cloud, adam);
  reset_channels(step, cloud, adam);
  return counts;
}

}  // namespace glint

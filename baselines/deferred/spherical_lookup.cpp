// SPDX-License-Identifier: MIT
#include "baselines/deferred/spherical_lookup.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/op_backends.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 256;         // pixels or texels a block
constexpr std::size_t kValueGrain = 16384;  // values a block

}  // namespace

SphericalLookup::SphericalLookup(int height, int channels)
    : shape_{height, channels, MapShape::levels_of(height)} {
  GLINT_CHECK(
      height >= 2 && channels >= 1,
      kUsage,
      "a map over directions has {} rows of {} channels, expected at least 2 and 1",
      height,
      channels
  );
  texels_.resize(shape_.first_texel(shape_.levels) * static_cast<std::size_t>(channels));
}

std::size_t SphericalLookup::num_values() const {
  return shape_.num_texels(0) * static_cast<std::size_t>(shape_.channels);
}

void SphericalLookup::set_texels(const FloatArray& level0) {
  GLINT_CHECK(
      level0.size() == num_values(),
      kUsage,
      "a map of {} values, expected {}",
      level0.size(),
      num_values()
  );
  run_kernel(level0.size(), kValueGrain, CopyValues{level0.on_device(), texels_.on_device()});
  const auto channels = static_cast<std::size_t>(shape_.channels);
  for (int level = 1; level < shape_.levels; ++level)
    run_kernel(
        shape_.num_texels(level) * channels,
        kValueGrain,
        BuildMapLevel{shape_, level, texels_.on_device()}
    );
}

const Image& SphericalLookup::look_up(const Image& directions, const Image& roughness) {
  directions_ = &directions;
  roughness_ = &roughness;
  fit(values_, directions.size(), shape_.channels);
  run_kernel(
      values_.num_pixels(),
      kGrain,
      LookUpMap{
          shape_,
          texels_.on_device(),
          directions.on_device(),
          roughness.on_device(),
          values_.on_device()}
  );
  return values_;
}

void SphericalLookup::look_up_vjp(
    const Image& dL_dvalues, Image& dL_ddirections, Image& dL_droughness, FloatArray& dL_dlevel0
) {
  GLINT_CHECK(directions_ != nullptr, kUsage, "a map over directions: nothing was looked up");
  fit(dL_ddirections, values_.size(), 3);
  fit(dL_droughness, values_.size(), 1);
  run_kernel(
      values_.num_pixels(),
      kGrain,
      LookUpMapVjp{
          shape_,
          texels_.on_device(),
          directions_->on_device(),
          roughness_->on_device(),
          dL_dvalues.on_device(),
          dL_ddirections.on_device(),
          dL_droughness.on_device()}
  );
  texels_vjp(dL_dvalues, dL_dlevel0);
}

// In the order of the pixels within a key; on the CPU a counting sort.
void SphericalLookup::sort_taps() {
  if (on_gpu()) return sort_taps_on_gpu();
  begins_.assign(shape_.first_texel(shape_.levels) + 1, 0);
  for (const std::uint32_t key : keys_)
    if (key != kNoTexel) ++begins_[key + 1];
  for (std::size_t k = 1; k < begins_.size(); ++k) begins_[k] += begins_[k - 1];
  taps_.resize(keys_.size());
  std::vector<std::uint32_t> next(begins_.begin(), begins_.end());
  for (std::size_t i = 0; i < keys_.size(); ++i)
    if (keys_[i] != kNoTexel) taps_[next[keys_[i]]++] = static_cast<std::uint32_t>(i);
}

void SphericalLookup::sort_taps_on_gpu() {
  gpu_ops.sort(keys_, taps_);
  begins_.resize(shape_.first_texel(shape_.levels) + 1);
  run_kernel(
      begins_.size(),
      kValueGrain,
      FindTapBegins{std::as_const(keys_).on_device(), keys_.size(), begins_.on_device()}
  );
}

void SphericalLookup::texels_vjp(const Image& dL_dvalues, FloatArray& dL_dlevel0) {
  const std::size_t pixels = values_.num_pixels();
  keys_.resize(2 * pixels);
  weights_.resize(2 * pixels);
  run_kernel(
      pixels,
      kGrain,
      MapTaps{
          shape_,
          directions_->on_device(),
          roughness_->on_device(),
          keys_.on_device(),
          weights_.on_device()}
  );
  sort_taps();
  dL_dtexels_.resize(texels_.size());
  dL_dtexels_.fill(0.0f);
  gather_texels(dL_dvalues);
  const auto channels = static_cast<std::size_t>(shape_.channels);
  for (int level = shape_.levels - 1; level > 0; --level)
    run_kernel(
        shape_.num_texels(level - 1) * channels,
        kValueGrain,
        BuildMapLevelVjp{shape_, level, dL_dtexels_.on_device()}
    );
  run_kernel(num_values(), kValueGrain, AddValues{dL_dtexels_.on_device(), dL_dlevel0.on_device()});
}

// On a GPU a thread has one channel of a texel, and long runs of taps are added up before.
void SphericalLookup::gather_texels(const Image& dL_dvalues) {
  const auto channels = static_cast<std::size_t>(shape_.channels);
  GatherMapTexels gather{
      shape_,
      dL_dvalues.on_device(),
      weights_.on_device(),
      begins_.on_device(),
      taps_.on_device(),
      dL_dtexels_.on_device()};
  const std::size_t texels = shape_.first_texel(shape_.levels);
  if (!on_gpu()) return run_kernel(texels, kGrain, gather);
  const std::size_t num_windows = keys_.size() / kTapWindow;
  windows_.resize(std::max<std::size_t>(4 * num_windows * channels, 1));
  run_kernel(
      num_windows * channels,
      kGrain,
      SumTapWindows{
          gather.dL_dvalues,
          gather.weights,
          std::as_const(keys_).on_device(),
          gather.taps,
          channels,
          windows_.on_device()}
  );
  gather.windows = windows_.on_device();
  run_kernel(texels * channels, kGrain, gather);
}

}  // namespace glint

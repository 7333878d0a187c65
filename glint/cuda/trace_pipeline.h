// SPDX-License-Identifier: MIT
// The order of kernels that traces rays, forward and backward, for an executor (raster_pipeline.h).
#pragma once

#include <numeric>
#include <vector>

#include "glint/cuda/trace_bodies.h"

namespace glint::gpu {

template <class Exec>
class TracePipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  explicit TracePipeline(Exec& exec) : exec_(exec) {}

  void forward(
      const DeviceTraceInput& input,
      const DeviceRays& rays,
      std::size_t num_rays,
      const TraceCutoffs& cutoffs,
      const DeviceTraceOutput& out
  ) {
    update_tree(input, cutoffs);
    num_rays_ = num_rays;
    counts_.resize(num_rays);
    hits_.resize(num_rays * static_cast<std::size_t>(cutoffs.max_hits));
    exec_.for_each(num_rays, ForwardRays{tree(), input, rays, cutoffs, out, saved()});
  }
  // Of the last forward call.
  void backward(
      const DeviceTraceInput& input,
      const DeviceRays& rays,
      const TraceCutoffs& cutoffs,
      const DeviceTraceOutput& out,
      const DeviceTraceOutput& dL_dout,
      float* dL_dorigins,
      float* dL_ddirections,
      const DeviceTraceGradients& gradients
  ) {
    sums_.resize(input.count * kTraceSums);
    exec_.fill_zero(sums_);
    exec_.for_each(
        num_rays_,
        BackwardRays{
            discs_.data(),
            input,
            rays,
            cutoffs,
            out,
            dL_dout,
            saved(),
            sums_.data(),
            dL_dorigins,
            dL_ddirections}
    );
    exec_.for_each(input.count, DiscVjp{input, sums_.data(), gradients});
  }

  // Contributors of all rays of the last forward call. Waits for the device.
  std::size_t num_hits() {
    std::vector<std::uint32_t> counts(num_rays_);
    exec_.download(counts_, num_rays_, counts.data());
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  }

 private:
  static constexpr int kRebuildInterval = 16;  // updates; boxes loosen as surfels move

  void update_tree(const DeviceTraceInput& input, const TraceCutoffs& cutoffs) {
    const std::size_t n = input.count;
    const bool refit = order_.size() == n && ++updates_ % kRebuildInterval != 0;
    discs_.resize(n);
    exec_.for_each(n, MakeDiscs{input, cutoffs, discs_.data()});
    if (n == 0) return;
    if (!refit) build(n);
    arrived_.resize(n);
    exec_.fill_zero(arrived_);
    exec_.for_each(n, FitBoxes{discs_.data(), order_.data(), n, nodes_.data(), arrived_.data()});
  }
  void build(std::size_t n) {
    constexpr std::size_t kThreads = BoundCenters::kThreads;
    const std::size_t blocks = (n + kThreads - 1) / kThreads;
    updates_ = 0;
    partial_bounds_.resize(blocks);
    bounds_.resize(1);
    keys_.resize(n);
    order_.resize(n);
    nodes_.resize(2 * n - 1);
    exec_.launch(blocks, BoundCenters{discs_.data(), n, partial_bounds_.data()});
    exec_.launch(1, UniteBoxes{partial_bounds_.data(), blocks, bounds_.data()});
    exec_.for_each(n, MortonKeys{discs_.data(), bounds_.data(), keys_.data(), order_.data()});
    exec_.sort_pairs(n, 64, keys_, order_);
    exec_.for_each(n - 1, BuildNodes{keys_.data(), static_cast<int>(n), nodes_.data()});
  }
  Tree tree() {
    return {nodes_.data(), order_.data(), discs_.data(), static_cast<std::uint32_t>(discs_.size())};
  }
  DeviceHits saved() { return {counts_.data(), hits_.data()}; }

  Exec& exec_;
  int updates_ = 0;
  std::size_t num_rays_ = 0;
  Buffer<DiscSurfel> discs_;
  Buffer<Box> partial_bounds_, bounds_;
  Buffer<std::uint64_t> keys_;
  Buffer<std::uint32_t> order_, arrived_, counts_, hits_;
  Buffer<TreeNode> nodes_;
  Buffer<float> sums_;
};

}  // namespace glint::gpu

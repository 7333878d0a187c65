// SPDX-License-Identifier: MIT
// The order of kernels that traces rays, forward and backward, for an executor (raster_pipeline.h).
#pragma once

#include <numeric>
#include <vector>

#include "glint/cuda/trace_bodies.h"

namespace glint::gpu {

// A call in device memory; shapes of TraceCall and TraceOutput.
struct DeviceTraceCall {
  DeviceTraceInput input;
  DeviceRays rays;
  std::size_t num_rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput out;
};

template <class Exec>
class TracePipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  explicit TracePipeline(Exec& exec) : exec_(exec) {}

  void forward(const DeviceTraceCall& call) { walk<NoCounts>(call, nullptr); }
  // The same, and what each ray costs: counts [rays].
  void forward(const DeviceTraceCall& call, WalkCounts* counts) { walk(call, counts); }
  // Of the last forward call.
  void backward(const DeviceTraceOutput& dL_dout, const DeviceTraceGradients& gradients) {
    sums_.resize(call_.input.count * kTraceSums);
    exec_.fill_zero(sums_);
    exec_.for_each(
        call_.num_rays,
        BackwardRays{
            discs_.data(),
            call_.input,
            call_.rays,
            call_.cutoffs,
            call_.out,
            dL_dout,
            saved(),
            sums_.data(),
            gradients.origins,
            gradients.directions}
    );
    exec_.for_each(call_.input.count, DiscVjp{call_.input, sums_.data(), gradients});
  }

  // Contributors of all rays of the last forward call. Waits for the device.
  std::size_t num_hits() {
    std::vector<std::uint32_t> counts(call_.num_rays);
    exec_.download(counts_, call_.num_rays, counts.data());
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  }

 private:
  static constexpr int kRebuildInterval = 16;  // updates; boxes loosen as surfels move

  template <class Counts>
  void walk(const DeviceTraceCall& call, Counts* counts) {
    call_ = call;
    update_tree(call.input, call.cutoffs);
    counts_.resize(call.num_rays);
    hits_.resize(call.num_rays * static_cast<std::size_t>(call.cutoffs.max_hits));
    exec_.for_each(
        call.num_rays,
        ForwardRays<Counts>{tree(), call.input, call.rays, call.cutoffs, call.out, saved(), counts}
    );
  }
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
  DeviceTraceCall call_{};
  int updates_ = 0;
  Buffer<DiscSurfel> discs_;
  Buffer<Box> partial_bounds_, bounds_;
  Buffer<std::uint64_t> keys_;
  Buffer<std::uint32_t> order_, arrived_, counts_, hits_;
  Buffer<TreeNode> nodes_;
  Buffer<float> sums_;
};

}  // namespace glint::gpu

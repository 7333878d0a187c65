// SPDX-License-Identifier: MIT
// The tree over a set's surfels, kept from call to call, for an executor (raster_pipeline.h).
#pragma once

#include <algorithm>

#include "glint/cuda/geometry_revision.h"
#include "glint/cuda/trace_walk.h"

namespace glint::gpu {

// In all that discs depend on.
inline bool same(const TraceCutoffs& a, const TraceCutoffs& b) {
  return a.max_rho == b.max_rho && a.min_alpha == b.min_alpha;
}
inline bool same(const DeviceTraceInput& a, const DeviceTraceInput& b) {
  return a.count == b.count && a.means == b.means && a.scales == b.scales &&
         a.rotations == b.rotations && a.opacities == b.opacities;
}

template <class Exec>
class TraceTree {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  explicit TraceTree(Exec& exec) : exec_(exec) {}

  // Where the revision is known and that of the call before, nothing has moved.
  void update(
      const DeviceTraceInput& input, const TraceCutoffs& cutoffs, const GeometryRevision& revision
  ) {
    const bool moved = !revision.known() || revision != revision_ || !same(input, input_) ||
                       !same(cutoffs, cutoffs_);
    input_ = input;
    cutoffs_ = cutoffs;
    revision_ = revision;
    if (!moved || input.count == 0) return;
    if (order_.size() != input.count || ++updates_ % kRebuildInterval == 0) build();
    fit();
  }
  Tree tree() const { return {wide_.data(), nodes_.data(), discs_.data(), slot_of_.data()}; }

 private:
  // Updates; boxes grow into each other as surfels move. Not by how much: the answer would have to
  // come to the host, and a sixteenth of a build, one sort of all surfels and five small kernels,
  // is little beside the refit of every call.
  static constexpr int kRebuildInterval = 16;

  void build() {
    constexpr std::size_t kThreads = BoundCenters::kThreads;
    const std::size_t n = input_.count, blocks = (n + kThreads - 1) / kThreads;
    updates_ = 0;
    partial_bounds_.resize(blocks);
    bounds_.resize(1);
    keys_.resize(n);
    order_.resize(n);
    nodes_.resize(2 * n - 1);
    exec_.launch(blocks, BoundCenters{input_, cutoffs_, partial_bounds_.data()});
    exec_.launch(1, UniteBoxes{partial_bounds_.data(), blocks, bounds_.data()});
    exec_.for_each(n, MortonKeys{input_, cutoffs_, bounds_.data(), keys_.data(), order_.data()});
    exec_.sort_pairs(n, 64, keys_, order_);
    exec_.for_each(n - 1, BuildNodes{keys_.data(), static_cast<int>(n), nodes_.data()});
  }
  void fit() {
    const std::size_t n = input_.count, inner = std::max<std::size_t>(n - 1, 1);
    discs_.resize(n);
    slot_of_.resize(n);
    arrived_.resize(n);
    wide_.resize(inner);
    exec_.for_each(n, PlaceDiscs{input_, cutoffs_, order_.data(), discs_.data(), slot_of_.data()});
    exec_.fill_zero(arrived_);
    exec_.for_each(n, FitBoxes{discs_.data(), n, nodes_.data(), arrived_.data()});
    exec_.for_each(inner, MakeWideNodes{nodes_.data(), n, wide_.data()});
  }

  Exec& exec_;
  DeviceTraceInput input_{};
  TraceCutoffs cutoffs_{};
  GeometryRevision revision_;
  int updates_ = 0;
  Buffer<Box> partial_bounds_, bounds_;
  Buffer<std::uint64_t> keys_;
  Buffer<std::uint32_t> order_, arrived_, slot_of_;
  Buffer<TreeNode> nodes_;
  Buffer<WideNode> wide_;
  Buffer<Disc> discs_;
};

}  // namespace glint::gpu

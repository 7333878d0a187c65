// SPDX-License-Identifier: MIT
// The order of kernels that traces rays, forward and backward, for an executor (raster_pipeline.h).
#pragma once

#include <bit>
#include <numeric>
#include <vector>

#include "glint/core/device.h"
#include "glint/cuda/trace_gather_bodies.h"
#include "glint/cuda/trace_tree.h"

namespace glint::gpu {

// A call in device memory; shapes of TraceCall and TraceOutput.
struct DeviceTraceCall {
  DeviceTraceInput input;
  DeviceRays rays;
  std::size_t num_rays;
  TraceCutoffs cutoffs;
  DeviceTraceOutput out;
  std::size_t width = 0;           // of the image that rays are, or 0
  GeometryRevision revision = {};  // where known, and as in the call before, the tree stays
  // A word on the device that becomes 1 where a silent call dropped hits; others need none.
  std::uint32_t* overflow = nullptr;
};

// Memory for hits is of a size that the host knows: as many as the last calls had, with a margin.
// Calls that may wait look whether they fit and make room. Silent ones (SilentStep) drop what does
// not fit, the same hits each time, and say so in a word on the device.
template <class Exec, int kHits = 16>
class TracePipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  explicit TracePipeline(Exec& exec) : exec_(exec), tree_(exec) { overflow_.resize(1); }

  void forward(const DeviceTraceCall& call) { trace<NoCounts>(call, nullptr); }
  // The same, and what each ray costs: counts [rays].
  void forward(const DeviceTraceCall& call, WalkCounts* counts) { trace(call, counts); }
  // Of the last forward call.
  void backward(const DeviceTraceOutput& dL_dout, const DeviceTraceGradients& gradients) {
    const HitGradients hits = make_room();
    with_sh_degree(call_.input.sh_degree, [&]<int kDegree>() {
      exec_.for_each(
          saved_.places,
          BackwardRays<kDegree>{
              tree_.tree().discs,
              call_.input,
              call_.rays,
              call_.cutoffs,
              call_.out,
              dL_dout,
              saved_,
              hits,
              gradients.origins,
              gradients.directions}
      );
      if (call_.input.count > 0) gather<kDegree>(hits, dL_dout, gradients);
    });
  }

  // Contributors of all rays of the last forward call. Waits for the device.
  std::size_t num_hits() {
    std::vector<std::uint32_t> counts(saved_.places);
    exec_.download(counts_, saved_.places, counts.data());
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  }

 private:
  static constexpr int kFirstRows = 64;   // hits of a ray for which there is room at first
  static constexpr float kMargin = 1.5f;  // above what a call had; views differ
  static constexpr float kKept = 0.9f;    // of the room that there was, at least

  // ---- forward

  template <class Counts>
  void trace(const DeviceTraceCall& call, Counts* counts) {
    call_ = call;
    call_.rays.count = call.num_rays;
    call_.rays.width = call.width;
    tree_.update(call.input, call.cutoffs, call.revision);
    saved_.places = call_.rays.places();
    counts_.resize(saved_.places);
    find(counts);
    while (saved_.rows < call.cutoffs.max_hits && !is_silent() && read(overflow_) != 0) {
      rows_ = 2 * saved_.rows;
      find(counts);
    }
    found_ = true;
    with_sh_degree(call.input.sh_degree, [&]<int kDegree>() {
      exec_.for_each(
          saved_.places,
          CompositeRays<kDegree>{
              tree_.tree().discs, call_.input, call_.rays, call_.cutoffs, saved_, call_.out}
      );
    });
  }
  template <class Counts>
  void find(Counts* counts) {
    saved_.rows = std::min(rows_, call_.cutoffs.max_hits);
    slots_.resize(saved_.places * static_cast<std::size_t>(saved_.rows));
    saved_.counts = counts_.data();
    saved_.slots = slots_.data();
    if (!is_silent()) exec_.fill_zero(overflow_);
    constexpr std::size_t kThreads = FindHits<kHits, Counts>::kThreads;
    exec_.launch(
        (saved_.places + kThreads - 1) / kThreads,
        FindHits<kHits, Counts>{
            tree_.tree(),
            call_.input.count,
            call_.rays,
            call_.cutoffs,
            saved_,
            overflow_word(),
            counts}
    );
  }
  // The first call waits, even in a silent step: nobody knows yet how many hits there are.
  bool is_silent() const { return SilentStep::now() && found_; }
  std::uint32_t* overflow_word() { return is_silent() ? call_.overflow : overflow_.data(); }
  // Waits for the device.
  std::uint32_t read(const Buffer<std::uint32_t>& word) {
    std::uint32_t value = 0;
    exec_.download(word, 1, &value);
    return value;
  }

  // ---- backward

  // Places of the hits, and memory for what is known of each.
  HitGradients make_room() {
    exec_.exclusive_sum_on_device(counts_, saved_.places, first_hits_);
    const auto places = static_cast<float>(saved_.places);
    if (!SilentStep::now() || !known_) {
      exec_.for_each(1, CopyWord{first_hits_.data() + saved_.places, overflow_.data()});
      const auto hits = static_cast<float>(read(overflow_));
      const float room = 1 + kMargin * hits / std::max(places, 1.0f);
      hits_a_place_ = std::max(room, known_ ? kKept * hits_a_place_ : 0.0f);
      known_ = true;
    }
    const auto capacity = static_cast<std::uint32_t>(hits_a_place_ * places);
    hits_.resize_exactly(capacity);
    keys_.resize_exactly(capacity);
    order_.resize_exactly(capacity);
    return {first_hits_.data(), capacity, hits_.data(), keys_.data(), order_.data()};
  }
  template <int kDegree>
  void gather(
      const HitGradients& hits,
      const DeviceTraceOutput& dL_dout,
      const DeviceTraceGradients& gradients
  ) {
    const std::size_t n = call_.input.count, windows = (hits.capacity + kLongRun - 1) / kLongRun;
    sort(hits);
    windows_.resize(2 * windows * kTraceSums<kDegree>);
    const SortedHits sorted{
        tree_.tree().discs,
        call_.input,
        call_.rays,
        call_.cutoffs,
        dL_dout,
        hits.hits,
        keys_.data(),
        order_.data(),
        runs_.data(),
        hits.capacity};
    exec_.launch(windows, SumWindows<kDegree>{sorted, windows_.data()});
    exec_.launch(n, GatherSurfels<kDegree>{sorted, windows_.data(), gradients});
  }
  // By slot, those of a slot in the order of the places.
  void sort(const HitGradients& hits) {
    const std::size_t n = call_.input.count;
    const auto last = static_cast<std::uint32_t>(n);
    exec_.for_each(
        hits.capacity,
        PadKeys{
            hits.first + saved_.places, last, hits.keys, hits.order, overflow_word(), hits.capacity}
    );
    exec_.sort_pairs(hits.capacity, static_cast<int>(std::bit_width(n)), keys_, order_);
    runs_.resize(n);
    exec_.fill_zero(runs_);
    exec_.for_each(hits.capacity, FindRuns{keys_.data(), n, hits.capacity, runs_.data()});
  }

  Exec& exec_;
  TraceTree<Exec> tree_;
  DeviceTraceCall call_{};
  DeviceHits saved_{};
  int rows_ = kFirstRows;
  float hits_a_place_ = 0;              // for which backward() has room
  bool found_ = false, known_ = false;  // there was a call forth, one back
  Buffer<std::uint32_t> counts_, slots_, first_hits_, keys_, order_, overflow_;
  Buffer<HitGradient> hits_;
  Buffer<HitRun> runs_;
  Buffer<float> windows_;
};

}  // namespace glint::gpu

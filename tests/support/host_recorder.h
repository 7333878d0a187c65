// SPDX-License-Identifier: MIT
// The counterpart of glint/cuda/step_graph.h: what kernels on the host do is kept and done in the
// end, so that whatever needs a result before that shows.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "glint/core/recorded_step.h"

namespace glint::test {

class HostRecorder final : public StepRecorder {
 public:
  void begin() override { recording_ = true; }
  void end() override {
    recording_ = false;
    for (const auto& op : std::exchange(ops_, {})) op();
  }
  void drop() noexcept override {
    recording_ = false;
    ops_.clear();
  }
  template <class F>
  void now_or_later(F&& op) {
    if (!recording_) return op();
    ++kept;
    ops_.push_back(std::forward<F>(op));
  }
  // The host needs something.
  void interrupt() {
    if (!recording_) return;
    ++interrupted;
    end();
  }
  std::uint64_t kept = 0, interrupted = 0;

 private:
  bool recording_ = false;
  std::vector<std::function<void()>> ops_;
};
// Never destroyed: static arrays of tests end later.
inline HostRecorder& host_recorder() {
  static HostRecorder& recorder = *new HostRecorder;
  return recorder;
}

}  // namespace glint::test

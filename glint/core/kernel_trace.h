// SPDX-License-Identifier: MIT
// Who wants to know how long each kernel takes (`glint-bench perf --kernels`). Nobody does by
// default: then a launch costs one look at a pointer more.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <typeinfo>

namespace glint {

struct KernelTime {
  std::uint64_t launches = 0;
  double ms = 0;
};

class KernelTrace {
 public:
  virtual ~KernelTrace() = default;
  // Around a launch; `stream`: the device's, null on the host.
  virtual void begin(const std::type_info& kernel, void* stream) = 0;
  virtual void end(void* stream) = 0;
  // By kernel_name(), since the last call. Waits for the device.
  virtual std::map<std::string, KernelTime> take() = 0;
};
inline KernelTrace* kernel_trace = nullptr;

class TracedKernel {
 public:
  explicit TracedKernel(const std::type_info& kernel, void* stream = nullptr)
      : trace_(kernel_trace), stream_(stream) {
    if (trace_ != nullptr) trace_->begin(kernel, stream_);
  }
  ~TracedKernel() {
    if (trace_ != nullptr) trace_->end(stream_);
  }
  TracedKernel(const TracedKernel&) = delete;
  TracedKernel& operator=(const TracedKernel&) = delete;

 private:
  KernelTrace* trace_;
  void* stream_;
};

// In C++'s words, without our namespaces: "SumRuns<PhotometricTerm>".
std::string kernel_name(const std::type_info& kernel);

// By the host's clock, where launches wait for their end. Kernels in kernels and those of other
// threads than this one's are not counted.
std::unique_ptr<KernelTrace> trace_by_clock();

}  // namespace glint

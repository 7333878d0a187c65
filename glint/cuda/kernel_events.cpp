// SPDX-License-Identifier: MIT
#include "glint/cuda/kernel_events.h"

#include <cuda_runtime_api.h>

#include <vector>

#include "glint/cuda/cuda_error.h"

namespace glint::gpu {

namespace {

void check(cudaError_t status, const char* what) {
  if (status != cudaSuccess) throw_cuda_error(what, status, cudaGetErrorString(status));
}

struct Launch {
  const std::type_info* kernel;
  cudaEvent_t begin, end;
};

// Events are made once and used again after take(). Launches in launches belong to the outer one.
class EventTrace final : public KernelTrace {
 public:
  ~EventTrace() override {
    for (const Launch& launch : launches_) {
      cudaEventDestroy(launch.begin);
      cudaEventDestroy(launch.end);
    }
  }
  void begin(const std::type_info& kernel, void* stream) override {
    if (depth_++ > 0) return;
    if (used_ == launches_.size()) launches_.push_back(new_launch());
    launches_[used_].kernel = &kernel;
    check(cudaEventRecord(launches_[used_].begin, static_cast<cudaStream_t>(stream)), "timing");
  }
  void end(void* stream) override {
    if (--depth_ > 0) return;
    cudaEventRecord(launches_[used_++].end, static_cast<cudaStream_t>(stream));
  }
  std::map<std::string, KernelTime> take() override {
    check(cudaDeviceSynchronize(), "waiting for the device");
    std::map<std::string, KernelTime> times;
    for (std::size_t i = 0; i < used_; ++i) {
      float ms = 0;
      check(cudaEventElapsedTime(&ms, launches_[i].begin, launches_[i].end), "timing a kernel");
      KernelTime& time = times[kernel_name(*launches_[i].kernel)];
      ++time.launches;
      time.ms += static_cast<double>(ms);
    }
    used_ = 0;
    return times;
  }

 private:
  static Launch new_launch() {
    Launch launch{};
    check(cudaEventCreate(&launch.begin), "making an event");
    check(cudaEventCreate(&launch.end), "making an event");
    return launch;
  }
  std::vector<Launch> launches_;
  std::size_t used_ = 0;
  int depth_ = 0;
};

}  // namespace

std::unique_ptr<KernelTrace> trace_by_events() { return std::make_unique<EventTrace>(); }

}  // namespace glint::gpu

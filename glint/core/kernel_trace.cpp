// SPDX-License-Identifier: MIT
#include "glint/core/kernel_trace.h"

#include <cxxabi.h>

#include <chrono>
#include <cstdlib>
#include <string_view>
#include <thread>

namespace glint {

namespace {

using Clock = std::chrono::steady_clock;

void erase_all(std::string& text, std::string_view part) {
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at))
    text.erase(at, part.size());
}

class ClockTrace final : public KernelTrace {
 public:
  void begin(const std::type_info& kernel, void*) override {
    if (std::this_thread::get_id() != thread_ || depth_++ > 0) return;
    now_ = &kernel;
    start_ = Clock::now();
  }
  void end(void*) override {
    if (std::this_thread::get_id() != thread_ || --depth_ > 0) return;
    KernelTime& time = times_[now_];
    ++time.launches;
    time.ms += std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }
  std::map<std::string, KernelTime> take() override {
    std::map<std::string, KernelTime> named;
    for (const auto& [kernel, time] : times_) {
      KernelTime& sum = named[kernel_name(*kernel)];
      sum.launches += time.launches;
      sum.ms += time.ms;
    }
    times_.clear();
    return named;
  }

 private:
  std::thread::id thread_ = std::this_thread::get_id();
  int depth_ = 0;
  const std::type_info* now_ = nullptr;
  Clock::time_point start_;
  std::map<const std::type_info*, KernelTime> times_;
};

}  // namespace

std::string kernel_name(const std::type_info& kernel) {
  int status = 0;
  char* demangled = abi::__cxa_demangle(kernel.name(), nullptr, nullptr, &status);
  std::string name = status == 0 ? demangled : kernel.name();
  std::free(demangled);
  for (const char* part : {"glint::", "gpu::", "(anonymous namespace)::"}) erase_all(name, part);
  return name;
}

std::unique_ptr<KernelTrace> trace_by_clock() { return std::make_unique<ClockTrace>(); }

}  // namespace glint

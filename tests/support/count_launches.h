// SPDX-License-Identifier: MIT
// How often a kernel is launched.
#pragma once

#include <typeinfo>

#include "glint/core/kernel_trace.h"

namespace glint::test {

// While this lives.
class CountedLaunches final : public KernelTrace {
 public:
  explicit CountedLaunches(const std::type_info& kernel) : kernel_(kernel) { kernel_trace = this; }
  ~CountedLaunches() override { kernel_trace = nullptr; }
  void begin(const std::type_info& kernel, void*) override { count += kernel == kernel_; }
  void end(void*) override {}
  std::map<std::string, KernelTime> take() override { return {}; }
  int count = 0;

 private:
  const std::type_info& kernel_;
};

}  // namespace glint::test

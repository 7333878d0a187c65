// SPDX-License-Identifier: MIT
// The GPU backends that tests compare with the CPU: its kernels run on the host, always, and the
// CUDA device where there is one, or has to be (GLINT_REQUIRE_GPU=1).
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/require_gpu.h"
#include "tests/support/difference_list.h"
#include "tests/support/host_exec.h"
#include "tests/support/relative_difference.h"

namespace glint::test {

// Kernels are compiled once, in host_kernels.cpp.
void use_host_kernels();

// While this lives, ops run on them.
struct OnHost {
  OnHost() { use_host_kernels(); }
  ~OnHost() { use_cpu(); }
  OnHost(const OnHost&) = delete;
  OnHost& operator=(const OnHost&) = delete;
};

// Calls f(name) with each backend in use, and the CPU afterwards.
template <class F>
void for_each_gpu_backend(F&& f) {
  use_host_kernels();
  f("kernels on the host");
  use_cpu();
  if (!gpu::cuda_device().usable) {
    if (gpu::gpu_required()) FAIL("no CUDA device: " << gpu::cuda_device().why_not);
    WARN("no CUDA device: " << gpu::cuda_device().why_not);
    return;
  }
  gpu::use_cuda();
  f(gpu::cuda_device().name);
  use_cpu();
}

// What ops wrote, once they are done.
template <class Values>
std::vector<float> read(const Values& values) {
  synchronize();
  return {values.begin(), values.end()};
}
inline std::vector<float> read(const Image& image) { return read(image.values()); }

// run(): makes its arrays, runs ops and returns what they wrote, by name. On every GPU backend it
// gives what it gives on the CPU, whatever the order of the host's loops.
template <class Run>
void check_same_as_cpu(double tolerance, Run&& run) {
  const auto expected = run();
  for_each_gpu_backend([&](const std::string& backend) {
    for (const std::uint64_t order : {1, 2}) {
      INFO(backend << ", order " << order << " of its loops where it is the host");
      const HostOrder in_order(order);
      const auto found = run();
      for (const auto& [name, values] : expected) {
        INFO(name);
        REQUIRE(std::ranges::all_of(values, [](float v) { return std::isfinite(v); }));
        const double difference = relative_difference(found.at(name), values);
        list_difference(
            Catch::getResultCapture().getCurrentTestName(), backend, name, difference, tolerance
        );
        CHECK(difference < tolerance);
      }
    }
  });
}

}  // namespace glint::test

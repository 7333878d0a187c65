// SPDX-License-Identifier: MIT
#include "glint/core/kernel_trace.h"

#include <catch2/catch.hpp>

#include "glint/core/kernel.h"

using namespace glint;

namespace {

struct Doubles {
  std::vector<float>* values;
  void operator()(std::size_t i) const { (*values)[i] *= 2; }
};
struct Ones {
  double operator()(int, int) const { return 1; }
};
struct Outer {
  std::vector<float>* values;
  void operator()(std::size_t) const { run_kernel(values->size(), 1, Doubles{values}); }
};

}  // namespace

TEST_CASE("Kernels are counted by name while a trace is in use, and only then") {
  std::vector<float> values(8, 1);
  const auto trace = trace_by_clock();
  run_kernel(values.size(), 4, Doubles{&values});
  kernel_trace = trace.get();
  run_kernel(values.size(), 4, Doubles{&values});
  run_kernel(values.size(), 4, Doubles{&values});
  CHECK(sum_kernel({3, 2}, Ones{}) == 6);
  kernel_trace = nullptr;
  auto times = trace->take();
  CHECK(times.size() == 2);
  CHECK(times["Doubles"].launches == 2);
  CHECK(times["Doubles"].ms > 0);
  CHECK(times["Ones"].launches == 1);
  CHECK(trace->take().empty());
  CHECK(values[0] == 8);
}

TEST_CASE("A kernel inside a kernel counts to the outer one") {
  std::vector<float> values(8, 1);
  const auto trace = trace_by_clock();
  kernel_trace = trace.get();
  run_kernel(1, 1, Outer{&values});
  kernel_trace = nullptr;
  const auto times = trace->take();
  CHECK(times.size() == 1);
  CHECK(times.count("Outer") == 1);
}

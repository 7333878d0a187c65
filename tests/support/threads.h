// SPDX-License-Identifier: MIT
#pragma once

#include "glint/core/parallel.h"

namespace glint::test {

// While this lives, so many threads.
struct ThreadCount {
  explicit ThreadCount(int n) { set_num_threads(n); }
  ~ThreadCount() { set_num_threads(0); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;
};

// What f() gives with so many threads.
template <class F>
auto with_threads(int n, F&& f) {
  const ThreadCount threads(n);
  return f();
}

}  // namespace glint::test

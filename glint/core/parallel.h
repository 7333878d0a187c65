// SPDX-License-Identifier: MIT
// Parallel loops over [0, n). Bodies write to places of their own, so results never depend on the
// number of threads. Backend: oneTBB, or std::thread in builds for ThreadSanitizer (which does not
// understand TBB).
#pragma once

#include <cstddef>
#include <functional>

namespace glint {

// 0 restores the default (all cores). Affects loops started later.
void set_num_threads(int num_threads);
int num_threads();

namespace detail {
void parallel_blocks(
    std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body
);
}

// body(begin, end) over the blocks [0, grain), [grain, 2 grain), ... of [0, n): the same blocks for
// any number of threads.
template <class F>
void parallel_for_blocks(std::size_t n, std::size_t grain, F&& body) {
  detail::parallel_blocks(n, grain, body);
}

// body(i) for every i in [0, n).
template <class F>
void parallel_for(std::size_t n, std::size_t grain, F&& body) {
  detail::parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace glint

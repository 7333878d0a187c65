// SPDX-License-Identifier: MIT
#include "glint/core/parallel.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <stdexcept>
#include <vector>

#include "tests/support/threads.h"

using namespace glint;
using test::ThreadCount;

TEST_CASE("A parallel loop visits every index once, for any length, grain and number of threads") {
  for (const int threads : {1, 2, 5}) {
    const ThreadCount guard(threads);
    CHECK(num_threads() == threads);
    for (const std::size_t n : {0u, 1u, 7u, 1000u})
      for (const std::size_t grain : {0u, 1u, 3u, 64u, 5000u}) {
        std::vector<int> visits(n, 0);
        parallel_for(n, grain, [&](std::size_t i) { ++visits[i]; });
        CHECK(visits == std::vector<int>(n, 1));
      }
  }
}

TEST_CASE("Blocks are disjoint, not empty and cover the range") {
  const ThreadCount guard(2);
  std::vector<std::atomic<int>> visits(997);
  std::atomic<int> empty_blocks = 0;
  parallel_for_blocks(visits.size(), 10, [&](std::size_t begin, std::size_t end) {
    if (begin >= end) ++empty_blocks;
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  CHECK(empty_blocks == 0);
  for (const auto& count : visits) CHECK(count == 1);
}

TEST_CASE("An exception of the body reaches the caller and the next loop runs") {
  for (const int threads : {1, 2}) {
    const ThreadCount guard(threads);
    const auto failing = [] {
      parallel_for(1000, 1, [](std::size_t i) {
        if (i == 500) throw std::runtime_error("at 500");
      });
    };
    CHECK_THROWS_WITH(failing(), "at 500");
    std::atomic<int> count = 0;
    parallel_for(100, 1, [&](std::size_t) { ++count; });
    CHECK(count == 100);
  }
}

TEST_CASE("Loops nest") {
  const ThreadCount guard(2);
  std::atomic<int> count = 0;
  parallel_for(10, 1, [&](std::size_t) { parallel_for(20, 1, [&](std::size_t) { ++count; }); });
  CHECK(count == 200);
}

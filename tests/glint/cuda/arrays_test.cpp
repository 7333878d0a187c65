// SPDX-License-Identifier: MIT
// Arrays with a side on the host and one on the device, and the pool of the device's memory.
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <numeric>

#include "glint/core/kernel.h"
#include "glint/core/rng.h"
#include "glint/render/op_backends.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;

namespace {

struct AddOne {
  float* values;
  GLINT_HD void operator()(std::size_t i) const { values[i] += 1; }
};

void add_one(FloatArray& array) { HostExec().for_each(array.size(), AddOne{array.on_device()}); }

std::vector<float> values_of(const FloatArray& array) { return {array.begin(), array.end()}; }
using Values = std::vector<float>;

// Downloads and uploads of f.
template <class F>
std::pair<std::uint64_t, std::uint64_t> copies_of(F&& f) {
  const DeviceCounters before = device_counters;
  f();
  return {device_counters.downloads - before.downloads, device_counters.uploads - before.uploads};
}

// Whether f ends the process that runs it.
template <class F>
bool is_deadly(F&& f) {
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGSEGV, SIG_DFL);
    f();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status);
}

}  // namespace

TEST_CASE("A pointer to the wrong side of an array ends a test") {
  const OnHost gpu;
  FloatArray array = {1, 2, 3};
  float* host = array.data();
  CHECK(!is_deadly([&] { host[0] = 5; }));
  CHECK(is_deadly([&] { HostExec().for_each(3, AddOne{host}); }));
  float* device = array.on_device();
  CHECK(is_deadly([&] { device[0] = 5; }));
  CHECK(!is_deadly([&] { HostExec().for_each(3, AddOne{device}); }));
}

TEST_CASE("An array is brought to the side that is asked for, once") {
  const OnHost gpu;
  FloatArray array = {1, 2, 3};
  CHECK(copies_of([&] { add_one(array); }) == std::pair<std::uint64_t, std::uint64_t>{0, 1});
  CHECK(copies_of([&] { add_one(array); }) == std::pair<std::uint64_t, std::uint64_t>{0, 0});
  CHECK(copies_of([&] { CHECK(values_of(array) == Values{3, 4, 5}); }).first == 1);
  CHECK(copies_of([&] { CHECK(values_of(array) == Values{3, 4, 5}); }).first == 0);
  // The host only looked, so the device still has it.
  CHECK(copies_of([&] { add_one(array); }).second == 0);
  array[1] = 7;
  CHECK(copies_of([&] { add_one(array); }).second == 1);
  CHECK(values_of(array) == Values{5, 8, 7});
}

TEST_CASE("New values are zero on whichever side they are first") {
  const OnHost gpu;
  FloatArray a(3), b(3, 0.0f), c;
  add_one(a);
  CHECK(values_of(a) == Values{1, 1, 1});
  CHECK(values_of(b) == Values{0, 0, 0});
  c.resize(2);
  c.resize(4);
  add_one(c);
  CHECK(values_of(c) == Values{1, 1, 1, 1});
}

TEST_CASE("What is on the device grows, shrinks and is copied there") {
  const OnHost gpu;
  FloatArray array = {1, 2};
  add_one(array);
  const auto copies = copies_of([&] {
    array.resize(5);
    add_one(array);
    array.resize(3);
    FloatArray copy = array;
    add_one(copy);
    array = copy;
    array.fill(4);
    add_one(array);
    std::swap(array, copy);
    add_one(array);
  });
  CHECK(copies == std::pair<std::uint64_t, std::uint64_t>{0, 0});
  CHECK(values_of(array) == Values{5, 6, 3});
  array.resize(4, 9);
  CHECK(values_of(array) == Values{5, 6, 3, 9});
}

TEST_CASE("An array leaves the device only where the host has it, and outlives its device") {
  FloatArray array = {1, 2};
  {
    const OnHost gpu;
    add_one(array);
    array.leave_device();
    CHECK(array.is_on_device_alone());
    CHECK(values_of(array) == Values{2, 3});
    array.leave_device();
    CHECK(copies_of([&] { add_one(array); }).second == 1);
  }
  CHECK(values_of(array) == Values{3, 4});
  array[0] = 1;
  const OnHost gpu;
  add_one(array);
  CHECK(values_of(array) == Values{2, 5});
}

TEST_CASE("An image is looked at where ops run") {
  const OnHost gpu;
  Image image(2, 1, 1, 3.0f);
  const ImageRef ref = image.on_device();
  HostExec().for_each(2, AddOne{ref.data});
  CHECK(ref.width == 2);
  CHECK(std::as_const(image).at(1, 0) == 4);
}

TEST_CASE("Keys are sorted by all of their 32 bits, those that are the same in their order") {
  for_each_gpu_backend([](const std::string& backend) {
    INFO(backend);
    Rng rng(3);
    Array<std::uint32_t> keys(1000), order;
    for (std::uint32_t& key : keys)
      key = static_cast<std::uint32_t>(rng.uniform(0, 40)) * 0x06666666u;  // up to the highest bit
    const std::vector<std::uint32_t> before(keys.begin(), keys.end());
    std::vector<std::uint32_t> expected(keys.size());
    std::iota(expected.begin(), expected.end(), 0u);
    std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
      return before[a] < before[b];
    });
    gpu_ops.sort(keys, order);
    CHECK(std::vector<std::uint32_t>(order.begin(), order.end()) == expected);
    CHECK(std::is_sorted(keys.begin(), keys.end()));
  });
}

TEST_CASE("Blocks of a pool are used again, and given back before there is no room") {
  static std::vector<std::size_t> got;
  static int given = 0;
  static std::size_t room = 4096;
  gpu::MemoryPool pool(
      {[](std::size_t bytes) -> void* {
         if (bytes > room) return nullptr;
         room -= bytes;
         got.push_back(bytes);
         return ::operator new(bytes);
       },
       [](void* block) {
         ::operator delete(block);
         ++given;
         room += 1024;
       },
       [] {}}
  );
  void* first = pool.allocate(1000);
  pool.release(first);
  CHECK(pool.allocate(1020) == first);  // as large when rounded
  CHECK(got == std::vector<std::size_t>{1024});
  pool.release(first);
  CHECK(pool.bytes_held() == 1024);
  CHECK(pool.bytes_in_use() == 0);
  CHECK(pool.peak_bytes() == 1024);
  pool.reset_peak();
  CHECK(pool.peak_bytes() == 0);
  void* large = pool.allocate(4096);
  CHECK(large != nullptr);  // in place of the first
  CHECK(given == 1);
  CHECK(pool.allocate(512) == nullptr);
  pool.release(large);
  CHECK(pool.peak_bytes() == 4096);  // what was released counts
  room = 0;
  pool.trim();
}

TEST_CASE("A pool rounds sizes up by at most an eighth") {
  for (std::size_t bytes = 1; bytes < 100000; bytes += 37) {
    const std::size_t rounded = gpu::MemoryPool::rounded(bytes);
    REQUIRE(rounded >= bytes);
    REQUIRE((bytes < 512 || rounded <= bytes + bytes / 8 + 1));
    REQUIRE(gpu::MemoryPool::rounded(rounded) == rounded);
  }
}

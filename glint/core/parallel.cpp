// SPDX-License-Identifier: MIT
#include "glint/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "glint/core/stoppable.h"

#if !defined(GLINT_STD_THREADS)
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <memory>
#endif

namespace glint {

namespace {
int hardware_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}
int requested_threads = 0;  // 0: all cores
thread_local const std::function<bool()>* asked_first = nullptr;

void ask_first() {
  if (asked_first != nullptr && (*asked_first)()) throw LoopsStopped();
}
}  // namespace

StoppableLoops::StoppableLoops(const std::function<bool()>& stop) { asked_first = &stop; }
StoppableLoops::~StoppableLoops() { asked_first = nullptr; }

int num_threads() { return requested_threads > 0 ? requested_threads : hardware_threads(); }

#if !defined(GLINT_STD_THREADS)

void set_num_threads(int n) {
  static std::unique_ptr<tbb::global_control> control;
  requested_threads = n;
  control.reset();
  control = std::make_unique<tbb::global_control>(
      tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(num_threads())
  );
}

namespace detail {
void parallel_blocks(
    std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body
) {
  ask_first();
  grain = std::max<std::size_t>(1, grain);
  const std::size_t num_blocks = (n + grain - 1) / grain;
  const auto run_block = [&](std::size_t i) { body(i * grain, std::min(n, (i + 1) * grain)); };
  if (num_blocks <= 1 || num_threads() == 1) {
    for (std::size_t i = 0; i < num_blocks; ++i) run_block(i);
  } else {
    tbb::parallel_for(std::size_t{0}, num_blocks, run_block);
  }
}
}  // namespace detail

#else

void set_num_threads(int n) { requested_threads = n; }

namespace detail {
void parallel_blocks(
    std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body
) {
  ask_first();
  grain = std::max<std::size_t>(1, grain);
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::atomic_flag failed = ATOMIC_FLAG_INIT;
  const auto work = [&] {
    for (std::size_t begin; (begin = next.fetch_add(grain)) < n;) try {
        body(begin, std::min(n, begin + grain));
      } catch (...) {
        if (!failed.test_and_set()) failure = std::current_exception();
        next = n;
      }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < num_threads(); ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}
}  // namespace detail

#endif

}  // namespace glint

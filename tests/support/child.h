// SPDX-License-Identifier: MIT
// Code in a process of its own: what it took, or what it left when it was killed. A test that uses
// it starts no threads itself: a fork has none of them.
#pragma once

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <catch2/catch.hpp>
#include <functional>

namespace glint::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kMemoryIsOurs = false;  // a sanitizer's shadow counts, too
#else
inline constexpr bool kMemoryIsOurs = true;
#endif

inline pid_t start_child(const std::function<int()>& body) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) ::_exit(body());
  return child;
}

// Bytes that `body` held at most; its result has to be 0.
inline double peak_bytes(const std::function<int()>& body) {
  const pid_t child = start_child(body);
  int status = 0;
  rusage usage{};
  REQUIRE(::wait4(child, &status, 0, &usage) == child);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// Killed so many microseconds after `has_begun` says so; however loaded the machine is, it is
// killed at its work.
inline void kill_after(
    useconds_t time, const std::function<bool()>& has_begun, const std::function<int()>& body
) {
  constexpr useconds_t kPoll = 1000, kLongest = 60'000'000;
  const pid_t child = start_child(body);
  for (useconds_t waited = 0; waited < kLongest && !has_begun(); waited += kPoll) ::usleep(kPoll);
  ::usleep(time);
  ::kill(child, SIGKILL);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
}

}  // namespace glint::test

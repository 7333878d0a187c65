// SPDX-License-Identifier: MIT
#include "glint/core/process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "glint/core/arrays.h"

using namespace glint;
using Catch::Contains;

TEST_CASE("what is out of memory says how much was asked for, where that is known") {
#ifndef __SANITIZE_ADDRESS__  // which ends the program there
  CHECK_THROWS_AS(Array<float>(std::size_t{1} << 60), HostMemoryFull);
#endif
  CHECK_THAT(
      *out_of_memory_message(HostMemoryFull(4611686018427387904)),
      Contains("out of memory: 4.61e+12 MB were asked for")
  );
  CHECK_THAT(*out_of_memory_message(std::bad_alloc()), Contains("out of memory; use"));
  CHECK_THAT(
      *out_of_memory_message(std::length_error("vector::x")),
      Contains("more memory was asked for than there can be (vector::x)")
  );
  CHECK_FALSE(out_of_memory_message(std::runtime_error("x")));
}

TEST_CASE("a program without standard output gives its number to no file of its own") {
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(STDIN_FILENO);
    ::close(STDOUT_FILENO);
    fill_standard_streams();
    const int next = ::open("/dev/null", O_WRONLY);
    const bool refuses = ::write(STDOUT_FILENO, "x", 1) < 0;
    ::_exit(next > STDERR_FILENO && refuses ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  CHECK(status == 0);
}

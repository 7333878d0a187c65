// SPDX-License-Identifier: MIT
#include "glint/core/progress.h"

#include <fcntl.h>
#include <unistd.h>
#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("standard error that cannot be written to stops no work") {
  const int full = ::open("/dev/full", O_WRONLY | O_CLOEXEC);
  if (full < 0) {
    WARN("no /dev/full: not tested");
    return;
  }
  const int kept = ::dup(STDERR_FILENO);
  ::dup2(full, STDERR_FILENO);
  CHECK_NOTHROW(log::warn("no room for this"));
  CHECK_NOTHROW(log::info("nor for this"));
  {
    Progress progress("work", 2);  // its end writes, too
    CHECK_NOTHROW(progress.advance(2));
  }
  ::dup2(kept, STDERR_FILENO);
  ::close(kept);
  ::close(full);
}

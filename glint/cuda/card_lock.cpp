// SPDX-License-Identifier: MIT
#include "glint/cuda/card_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

#include "glint/core/files.h"
#include "glint/core/progress.h"

namespace glint::gpu {

bool take_card(const std::string& card, const std::string& folder, bool one_of_several) {
  const fs::path file = fs::path(folder) / ("glint-card-" + card);
  const int opened = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (opened < 0) return true;
  // Not closed: the lock goes with the process, however it ends.
  if (::flock(opened, (one_of_several ? LOCK_SH : LOCK_EX) | LOCK_NB) == 0) return true;
  const bool taken = errno == EWOULDBLOCK;
  ::close(opened);
  return !taken;
}

void warn_of_sharing(const std::string& card) {
  const bool one_of_several = std::getenv(kCardJobs) != nullptr;
  static const bool alone = take_card(card, fs::temp_directory_path().string(), one_of_several);
  static bool told = false;
  if (alone || told) return;
  told = true;
  log::warn(
      "another glint-bench uses this card (" + card +
      "): both are slower, times mean little, and each has the memory that the other leaves"
  );
}

}  // namespace glint::gpu

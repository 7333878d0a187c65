// SPDX-License-Identifier: MIT
#include "glint/core/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

namespace glint {

void ignore_file_size_signal() { std::signal(SIGXFSZ, SIG_IGN); }

void fill_standard_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);  // takes the lowest number
}

HostMemoryFull::HostMemoryFull(std::size_t bytes)
    : what_(fmt::format(
          "out of memory: {:.3g} MB were asked for at once; use smaller images, fewer surfels or "
          "fewer threads",
          static_cast<double>(bytes) / 1e6
      )) {}

std::optional<std::string> out_of_memory_message(const std::exception& error) {
  if (dynamic_cast<const HostMemoryFull*>(&error)) return error.what();
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return "out of memory; use smaller images or fewer threads";
  if (dynamic_cast<const std::length_error*>(&error))
    return fmt::format(
        "more memory was asked for than there can be ({}); a number among the settings or options "
        "is too large",
        error.what()
    );
  return std::nullopt;
}

}  // namespace glint

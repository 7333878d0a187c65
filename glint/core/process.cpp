// SPDX-License-Identifier: MIT
#include "glint/core/process.h"

#include <csignal>

namespace glint {

void ignore_file_size_signal() { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace glint

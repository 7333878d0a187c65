// SPDX-License-Identifier: MIT
// Ctrl-C: the first one lets the running cell stop at its next step and the tables be written, the
// second one ends the program at once.
#pragma once

#include <exception>

namespace glint {

inline constexpr int kInterruptedExit = 130;  // 128 + SIGINT, the shells' convention

struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

void install_interrupt_handler();  // SIGINT and SIGTERM
bool is_interrupted();
void throw_if_interrupted();  // Interrupted

}  // namespace glint

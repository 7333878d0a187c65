// SPDX-License-Identifier: MIT
// Ctrl-C: the first one lets the running cell stop at its next step and the tables be written, the
// second one ends the program at once.
#pragma once

#include <exception>

namespace glint {

struct Interrupted : std::exception {
  const char* what() const noexcept override { return "interrupted"; }
};

// SIGINT, SIGTERM, and SIGUSR1, which clusters send before they take a machine back. The first one
// prints what happens now; `told` lives as long as the program.
void install_interrupt_handler(const char* told = "stopping after this step");
bool is_interrupted();
// 128 + the signal that was seen, the shells' convention: 130 after Ctrl-C, 143 after SIGTERM.
int interrupted_exit();
void throw_if_interrupted();  // Interrupted

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/core/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <cstring>

namespace glint {

namespace {
volatile std::sig_atomic_t interrupt_seen = 0;
const char* what_happens = "";  // printed by the first signal

void note_interrupt(int signal) {
  interrupt_seen = signal;
  // Only write() may be called in a handler; nothing can be done about a failure.
  for (const char* text : {"\n", what_happens, "; once more to stop at once\n"})
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text, std::strlen(text));
}
}  // namespace

void install_interrupt_handler(const char* told) {
  what_happens = told;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGUSR1, &action, nullptr);
}

bool is_interrupted() { return interrupt_seen != 0; }

int interrupted_exit() { return 128 + (is_interrupted() ? interrupt_seen : SIGINT); }

void throw_if_interrupted() {
  if (is_interrupted()) throw Interrupted();
}

}  // namespace glint

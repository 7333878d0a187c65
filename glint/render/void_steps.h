// SPDX-License-Identifier: MIT
// Silent steps (glint/core/device.h) have no more room than the steps before them needed. One that
// needs more is void: the op that finds it out says so in a word on the device, the optimisers and
// the statistics of density control that come after see the word and leave everything as it is, and
// the next step that is not silent makes room. What came before in the step stays: statistics of
// another set.
#pragma once

#include <cstddef>
#include <cstdint>

namespace glint {

// Where ops write 1, and kernels that change a state look; null when steps are not silent.
std::uint32_t* void_word();

struct VoidSteps {
  std::size_t count = 0;
  int last = -1;  // iteration of the last one; -1: there was none

  template <class State>
  void visit_state(State& state) {
    state("count", count);
    state("last", last);
  }
};

// Behind each silent step: counts it if it was void, and clears the word.
void end_silent_step(int iteration = 0);
// Void steps since the last call; waits for the device. On the CPU there are none.
VoidSteps take_void_steps();

}  // namespace glint

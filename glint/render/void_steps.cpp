// SPDX-License-Identifier: MIT
#include "glint/render/void_steps.h"

#include <utility>

#include "glint/render/void_steps_kernels.h"

namespace glint {

namespace {
// Of the process, as the device is; never destroyed, since the device may end before.
Array<std::uint32_t>& words() {
  static Array<std::uint32_t>& words = *new Array<std::uint32_t>(3, 0u);
  return words;
}
}  // namespace

std::uint32_t* void_word() { return SilentStep::now() ? words().device_for_writing() : nullptr; }

void end_silent_step(int iteration) {
  if (!SilentStep::now()) return;
  run_kernel(1, 1, CountVoidStep{words().on_device(), static_cast<std::uint32_t>(iteration)});
}

VoidSteps take_void_steps() {
  if (!on_gpu()) return {};
  const auto& found = std::as_const(words());  // the device's side stays valid
  if (found[1] == 0) return {};
  const VoidSteps steps{found[1], static_cast<int>(found[2])};
  words().assign(3, 0u);
  return steps;
}

}  // namespace glint

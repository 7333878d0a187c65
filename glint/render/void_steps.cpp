// SPDX-License-Identifier: MIT
#include "glint/render/void_steps.h"

#include <utility>

#include "glint/render/void_steps_kernels.h"

namespace glint {

namespace {
// Of the process, as the device is; never destroyed, since the device may end before.
Array<std::uint32_t>& words() {
  static Array<std::uint32_t>& words = *new Array<std::uint32_t>(2, 0u);
  return words;
}
}  // namespace

std::uint32_t* void_word() { return SilentStep::now() ? words().device_for_writing() : nullptr; }

void end_silent_step() {
  if (SilentStep::now()) run_kernel(1, 1, CountVoidStep{words().on_device()});
}

std::size_t take_void_steps() {
  if (!on_gpu()) return 0;
  const std::size_t count = std::as_const(words())[1];  // the device's side stays valid
  if (count > 0) words().assign(2, 0u);
  return count;
}

}  // namespace glint

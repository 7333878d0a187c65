// SPDX-License-Identifier: MIT
// Work that gives way to something more urgent: between its parallel loops.
#pragma once

#include <exception>
#include <functional>

namespace glint {

struct LoopsStopped : std::exception {
  const char* what() const noexcept override { return "stopped for something else"; }
};

// While it lives, each parallel loop that this thread starts asks first whether to stop, and then
// throws LoopsStopped instead. What was being computed is lost; the next call of the same op
// computes all of it. One at a time; launches on a GPU do not ask.
class StoppableLoops {
 public:
  explicit StoppableLoops(const std::function<bool()>& stop);  // borrowed
  ~StoppableLoops();
  StoppableLoops(const StoppableLoops&) = delete;
  StoppableLoops& operator=(const StoppableLoops&) = delete;
};

}  // namespace glint

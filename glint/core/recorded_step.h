// SPDX-License-Identifier: MIT
// A silent step of which a device gets all ops at once, in the order in which they were asked for:
// as one graph, whose kernels follow one another without the host.
#pragma once

#include "glint/core/device.h"

namespace glint {

class StepRecorder {
 public:
  virtual ~StepRecorder() = default;
  // From now on ops are kept.
  virtual void begin() = 0;
  // Begins what was kept, if anything is; also called when the host needs something of the device,
  // from where on ops begin when they are asked for.
  virtual void end() = 0;
  // Forgets it: the step failed.
  virtual void drop() noexcept = 0;
};

// Of the device in use; null: ops begin when they are asked for.
inline StepRecorder* step_recorder = nullptr;

// Outside of silent steps there is no difference.
class RecordedStep {
 public:
  RecordedStep() : recorder_(SilentStep::now() ? step_recorder : nullptr) {
    if (recorder_ != nullptr) recorder_->begin();
  }
  ~RecordedStep() {
    if (recorder_ != nullptr) recorder_->drop();
  }
  RecordedStep(const RecordedStep&) = delete;
  RecordedStep& operator=(const RecordedStep&) = delete;
  void end() {
    if (recorder_ != nullptr) recorder_->end();
    recorder_ = nullptr;
  }

 private:
  StepRecorder* recorder_;
};

}  // namespace glint

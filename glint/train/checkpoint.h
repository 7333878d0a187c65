// SPDX-License-Identifier: MIT
// The state of a training in a file, from which it goes on as if it had never stopped: on the CPU
// the same bytes come out. A safetensors file: arrays as tensors, numbers in its metadata
// (docs/reference/records.md).
#pragma once

#include <string>

#include "glint/core/files.h"
#include "glint/render/void_steps.h"
#include "glint/train/training_state.h"

namespace glint {

class Method;

// Of a run folder.
inline constexpr const char* kCheckpointFile = "checkpoint/state.safetensors";
// For people and scripts: how far a training was when it last wrote a checkpoint, or that it has
// ended. JSON: "iterations", "of", "seconds", "ended".
inline constexpr const char* kProgressFile = "checkpoint/progress.json";

// What the trainer has beside the method's state.
struct TrainingProgress {
  int iterations = 0;  // done
  double seconds = 0, saving_seconds = 0;
  double peak_memory_mb = 0, device_memory_mb = 0;
  VoidSteps void_steps;
  std::string events = "[]";  // JSON: since the last line of the log

  void visit_state(TrainingState& state);
};

// Writes the file anew; the one before stays until the new one is whole. False: the method says
// nothing of its state. Errors: write_file's.
bool write_checkpoint(
    const fs::path& file, const std::string& identity, Method& method, TrainingProgress progress
);
// Whether there is one of this identity: what the run's result depends on (its train key).
bool is_checkpoint_of(const fs::path& file, const std::string& identity);
// Brings a method that was initialised for this run to where the checkpoint was written. Errors
// (kBadReference): it is damaged, or not of such a run.
void read_checkpoint(const fs::path& file, Method& method, TrainingProgress& progress);

}  // namespace glint

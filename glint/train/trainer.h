// SPDX-License-Identifier: MIT
// The training loop: order of the views is the method's business; progress, log, checkpoints and
// the stop on non-finite values are here. It knows no method by name.
#pragma once

#include <functional>

#include "glint/core/files.h"
#include "glint/method.h"
#include "glint/render/void_steps.h"

namespace glint {

struct TrainOptions {
  RunOptions run;
  fs::path folder;                  // log.jsonl and the checkpoint go here; empty: neither
  int log_interval = 100;           // iterations between lines of log.jsonl
  int test_psnr_every = 0;          // steps between lines with the PSNR of test views; 0: none
  double checkpoint_seconds = 300;  // between checkpoints, at least; 0: one after every step
  std::string identity;             // of the run: only its own checkpoint is gone on from
  std::string title = "train";      // of the progress line
  // Called after each step and before the checkpoint, where the method may be rendered; in silent
  // steps of a GPU the numbers are NaN. What it throws ends the training, with a checkpoint.
  std::function<void(Method&, const StepStats&)> after_step;
};

struct TrainReport {
  int iterations = 0;
  double seconds = 0;           // of steps only: no loading, logging or saving
  double saving_seconds = 0;    // of checkpoints: at most 2 % of the time
  double peak_memory_mb = 0;    // of the host
  double device_memory_mb = 0;  // in use on the GPU at most; 0 on the CPU
  std::size_t num_surfels = 0;
  VoidSteps void_steps;  // that did nothing, since a GPU had no room for them
  StepStats last;
};

// Initialises and trains, or goes on from the folder's checkpoint (checkpoint.h), which it leaves
// there. One that cannot be written is a warning, one that cannot be read, too. Errors: what the
// method throws; kBadPrediction when the loss or a parameter stops being finite (names the term or
// parameter and the iteration, and where the last checkpoint is); DeviceLost, likewise; Interrupted
// before the next step after a signal, with a new checkpoint; what after_step throws, likewise.
TrainReport train(Method& method, const Scene& scene, const TrainOptions& options);

// Random order of the training views without replacement, reshuffled when all were seen.
class ViewSampler {
 public:
  ViewSampler() = default;
  ViewSampler(std::size_t num_views, std::uint64_t seed);
  std::size_t next();

  template <class State>
  void visit_state(State& state) {
    state("epoch", epoch_);
    state("remaining", remaining_);
    if (state.reading()) check_views();
  }

 private:
  void check_views() const;  // errors (kBadReference): one that is not there

  std::size_t num_views_ = 0;
  std::uint64_t seed_ = 0, epoch_ = 0;
  std::vector<std::size_t> remaining_;
};

// A published schedule for `of` iterations, scaled to this run: round(n * iterations / of), at
// least `at_least`.
int scaled_step(int published, int iterations, int at_least = 1, int of = 30000);

}  // namespace glint

// SPDX-License-Identifier: MIT
// A training step as a CUDA graph, and the one stream of the process. The graph of a step is
// captured while the step is asked for, since counts, views and times are new in each; it takes the
// place of the one before (cudaGraphExecUpdate), which costs no more than its launches would have.
#pragma once

#include <cuda_runtime_api.h>

#include "glint/core/recorded_step.h"

namespace glint::gpu {

// That all ops run in; never destroyed.
cudaStream_t device_stream();

class StepGraph final : public StepRecorder {
 public:
  void begin() override;
  void end() override;
  void drop() noexcept override;

 private:
  void launch(cudaGraph_t graph);
  void instantiate(cudaGraph_t graph);
  bool recording_ = false;
  cudaGraphExec_t ready_ = nullptr;  // of a step before
};
StepGraph& step_graph();

// GLINT_CUDA_GRAPHS=1: steps are captured. Off by default until it was measured on a card.
bool graphs_wanted();

}  // namespace glint::gpu

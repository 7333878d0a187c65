// SPDX-License-Identifier: MIT
#include "glint/cuda/step_graph.h"

#include <cstdlib>
#include <string_view>

#include "glint/cuda/cuda_error.h"

namespace glint::gpu {

namespace {

void check_graph(cudaError_t status, const char* what) {
  if (status != cudaSuccess) throw_cuda_error(what, status, cudaGetErrorString(status));
}

}  // namespace

// A blocking one: what a library begins in the legacy stream keeps its order.
cudaStream_t device_stream() {
  static const cudaStream_t stream = [] {
    cudaStream_t made = nullptr;
    check_graph(cudaStreamCreate(&made), "making a stream");
    return made;
  }();
  return stream;
}

// Relaxed: what grows in the middle of a step may ask for memory.
void StepGraph::begin() {
  check_graph(
      cudaStreamBeginCapture(device_stream(), cudaStreamCaptureModeRelaxed), "capturing a step"
  );
  recording_ = true;
}

void StepGraph::end() {
  if (!recording_) return;
  recording_ = false;
  cudaGraph_t graph = nullptr;
  check_graph(
      cudaStreamEndCapture(device_stream(), &graph),
      "capturing a step (GLINT_CUDA_GRAPHS=0 goes without)"
  );
  launch(graph);
  cudaGraphDestroy(graph);
}

void StepGraph::drop() noexcept {
  if (!recording_) return;
  recording_ = false;
  cudaGraph_t graph = nullptr;
  if (cudaStreamEndCapture(device_stream(), &graph) == cudaSuccess) cudaGraphDestroy(graph);
  cudaGetLastError();  // forgotten: the step's own error is on its way
}

void StepGraph::launch(cudaGraph_t graph) {
  cudaGraphExecUpdateResultInfo how{};
  if (ready_ == nullptr || cudaGraphExecUpdate(ready_, graph, &how) != cudaSuccess) {
    cudaGetLastError();  // another shape: a step with other losses
    instantiate(graph);
  }
  check_graph(cudaGraphLaunch(ready_, device_stream()), "launching a step");
}

void StepGraph::instantiate(cudaGraph_t graph) {
  if (ready_ != nullptr) cudaGraphExecDestroy(ready_);
  ready_ = nullptr;
  check_graph(cudaGraphInstantiate(&ready_, graph, 0), "making the graph of a step");
}

StepGraph& step_graph() {
  static StepGraph& graph = *new StepGraph;
  return graph;
}

bool graphs_wanted() {
  const char* value = std::getenv("GLINT_CUDA_GRAPHS");
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace glint::gpu

// SPDX-License-Identifier: MIT
// A small fully connected network for every pixel or surfel, ReLU between its layers and none
// behind the last: y = W_n^T relu(... relu(W_1^T x + b_1) ...) + b_n. On the CPU products of
// matrices by Eigen on fixed blocks of rows, on a GPU kernels (mlp_kernels.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "baselines/deferred/trainable_array.h"
#include "glint/scene/safetensors.h"

namespace glint {

class Mlp {
 public:
  Mlp() = default;
  // widths: of the input, of each hidden layer, of the output; at least two, all positive. Weights
  // and biases are uniform in +-1/sqrt(fan in), as PyTorch's Linear starts. Errors (kUsage):
  // widths.
  Mlp(std::vector<int> widths, std::uint64_t seed);

  const std::vector<int>& widths() const { return widths_; }
  // Layer after layer: weights [in][out], biases [out].
  TrainableArray& parameters() { return parameters_; }
  const TrainableArray& parameters() const { return parameters_; }
  std::span<float> weights(std::size_t layer);
  std::span<float> biases(std::size_t layer);

  // inputs: [rows][widths.front()]; they must stay as they are until backward(). Returns
  // [rows][widths.back()], valid until the next call.
  const FloatArray& forward(const FloatArray& inputs);
  // Back through the last forward(): adds to the parameters' gradient, and fills dL_dinputs
  // [rows][widths.front()] unless it is empty. dL_doutputs: [rows][widths.back()]. On the CPU the
  // same bytes for any number of threads.
  void backward(const FloatArray& dL_doutputs, FloatArray* dL_dinputs);

  // As tensors "name.0.weight" [in][out], "name.0.bias" [out], ... that borrow the parameters.
  std::vector<TensorToWrite> tensors(const std::string& name) const;
  // The same back, of these widths. Errors (kBadReference): SafetensorsFile::read()'s.
  void read(SafetensorsFile& file, const std::string& name);
  void visit_state(TrainingState& state) { parameters_.visit_state(state); }

 private:
  struct Layer {
    std::size_t in, out, weights, biases;  // the last two: where they begin in the parameters
  };
  Layer layer(std::size_t index) const { return layers_[index]; }
  void forward_rows(std::size_t begin, std::size_t end);
  void backward_rows(
      std::size_t begin,
      std::size_t end,
      const float* dL_doutputs,
      float* dL_dinputs,
      float* dL_dparameters
  ) const;
  void forward_on_gpu();
  void backward_on_gpu(const FloatArray& dL_doutputs, FloatArray* dL_dinputs);

  std::vector<int> widths_;
  std::vector<Layer> layers_;
  TrainableArray parameters_;
  const FloatArray* inputs_ = nullptr;
  std::size_t rows_ = 0;
  std::vector<FloatArray> outputs_;     // [rows][out] of each layer, behind its ReLU
  std::vector<FloatArray> dL_doutput_;  // on a GPU: the same for gradients
  FloatArray partials_;                 // [chunks of rows][parameters]
};

}  // namespace glint

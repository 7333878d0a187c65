// SPDX-License-Identifier: MIT
// A layer y = relu(W^T x + b) of an Mlp on a GPU: one thread an output, an input's gradient or a
// weight. Forward, neighbouring threads read neighbouring weights; rows are shared by the caches.
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/real.h"

namespace glint {

// Index of (row, output).
struct MlpLayerForward {
  const float *inputs, *weights, *biases;  // [rows][in], [in][out], [out]
  std::size_t in, out;
  bool relu;
  float* outputs;  // [rows][out]

  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t row = i / out, o = i % out;
    float sum = biases[o];
    for (std::size_t k = 0; k < in; ++k)
      sum = fma_of(inputs[row * in + k], weights[k * out + o], sum);
    outputs[i] = relu ? max_of(sum, 0.0f) : sum;
  }
};

// dL/d(inputs) of a layer, index of (row, input); zero where the layer before cut its output off.
struct MlpLayerInputVjp {
  const float *weights, *dL_doutputs;
  const float* inputs;  // null: they come from no ReLU
  std::size_t in, out;
  float* dL_dinputs;

  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t row = i / in, k = i % in;
    float sum = 0;
    for (std::size_t o = 0; o < out; ++o)
      sum = fma_of(weights[k * out + o], dL_doutputs[row * out + o], sum);
    dL_dinputs[i] = inputs == nullptr || inputs[i] > 0 ? sum : 0.0f;
  }
};

// dL/d(weights and biases) of a layer over a chunk of rows: index of (chunk, input, output), where
// the input behind the last is the bias.
struct MlpLayerWeightVjp {
  const float *inputs, *dL_doutputs;
  std::size_t rows, rows_a_chunk, in, out;
  float* partials;     // the layer's first weight in the first chunk
  std::size_t stride;  // of chunks

  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t size = (in + 1) * out, chunk = i / size, k = i % size / out, o = i % out;
    const std::size_t begin = chunk * rows_a_chunk;
    const std::size_t end = begin + rows_a_chunk < rows ? begin + rows_a_chunk : rows;
    float sum = 0;
    for (std::size_t row = begin; row < end; ++row) {
      const float x = k < in ? inputs[row * in + k] : 1.0f;
      sum = fma_of(x, dL_doutputs[row * out + o], sum);
    }
    partials[chunk * stride + k * out + o] = sum;
  }
};

// Adds a parameter's partial sums to its gradient, in order.
struct MlpSumPartials {
  const float* partials;  // [chunks][parameters]
  std::size_t chunks, parameters;
  float* gradient;

  GLINT_HD void operator()(std::size_t i) const {
    float sum = 0;
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) sum += partials[chunk * parameters + i];
    gradient[i] += sum;
  }
};

using MlpKernels = KernelList<MlpLayerForward, MlpLayerInputVjp, MlpLayerWeightVjp, MlpSumPartials>;

}  // namespace glint

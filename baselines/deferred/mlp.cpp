// SPDX-License-Identifier: MIT
#include "baselines/deferred/mlp.h"

#define EIGEN_DONT_PARALLELIZE  // rows are shared out among threads here

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "baselines/deferred/mlp_kernels.h"
#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/core/rng.h"

namespace glint {

namespace {

constexpr std::size_t kBlock = 256;     // rows that are multiplied at once
constexpr std::size_t kMaxChunks = 64;  // of rows, each with a sum of its own of weight gradients
constexpr std::size_t kGrain = 4096;    // values a block

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Row = Eigen::Matrix<float, 1, Eigen::Dynamic>;

Eigen::Map<Matrix> matrix(float* data, std::size_t rows, std::size_t columns) {
  return {data, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}
Eigen::Map<const Matrix> matrix(const float* data, std::size_t rows, std::size_t columns) {
  return {data, static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns)};
}
Eigen::Map<Row> row(float* data, std::size_t columns) {
  return {data, static_cast<Eigen::Index>(columns)};
}
Eigen::Map<const Row> row(const float* data, std::size_t columns) {
  return {data, static_cast<Eigen::Index>(columns)};
}

// Whole blocks, so that the chunks depend on the number of rows alone.
std::size_t rows_a_chunk(std::size_t rows) {
  const std::size_t blocks = (rows + kBlock - 1) / kBlock;
  return kBlock * std::max<std::size_t>((blocks + kMaxChunks - 1) / kMaxChunks, 1);
}

std::string tensor_name(const std::string& name, std::size_t layer, const char* what) {
  return fmt::format("{}.{}.{}", name, layer, what);
}

}  // namespace

Mlp::Mlp(std::vector<int> widths, std::uint64_t seed) : widths_(std::move(widths)) {
  GLINT_CHECK(
      widths_.size() >= 2 && *std::min_element(widths_.begin(), widths_.end()) > 0,
      kUsage,
      "a network needs the widths of its input and its output, all positive, found [{}]",
      fmt::join(widths_, ", ")
  );
  std::size_t count = 0;
  for (std::size_t l = 0; l + 1 < widths_.size(); ++l) {
    const auto in = static_cast<std::size_t>(widths_[l]);
    const auto out = static_cast<std::size_t>(widths_[l + 1]);
    layers_.push_back({in, out, count, count + in * out});
    count += (in + 1) * out;
  }
  outputs_.resize(layers_.size());
  dL_doutput_.resize(layers_.size());
  parameters_ = TrainableArray(count);
  Rng rng(seed, hash_name("mlp"));
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const float bound = 1 / std::sqrt(static_cast<float>(layers_[l].in));
    for (float& value : weights(l)) value = rng.uniform(-bound, bound);
    for (float& value : biases(l)) value = rng.uniform(-bound, bound);
  }
}

std::span<float> Mlp::weights(std::size_t index) {
  const Layer l = layer(index);
  return {parameters_.values.data() + l.weights, l.in * l.out};
}
std::span<float> Mlp::biases(std::size_t index) {
  const Layer l = layer(index);
  return {parameters_.values.data() + l.biases, l.out};
}

const FloatArray& Mlp::forward(const FloatArray& inputs) {
  const std::size_t in = layers_.front().in;
  GLINT_CHECK(
      inputs.size() % in == 0, kUsage, "network: {} inputs are no rows of {}", inputs.size(), in
  );
  inputs_ = &inputs;
  rows_ = inputs.size() / in;
  for (std::size_t l = 0; l < layers_.size(); ++l) outputs_[l].resize(rows_ * layers_[l].out);
  if (on_gpu())
    forward_on_gpu();
  else
    parallel_for_blocks(rows_, kBlock, [&](std::size_t begin, std::size_t end) {
      forward_rows(begin, end);
    });
  return outputs_.back();
}

void Mlp::forward_rows(std::size_t begin, std::size_t end) {
  const float* x = inputs_->data() + begin * layers_.front().in;
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const Layer& at = layers_[l];
    const float* parameters = parameters_.values.data();
    auto y = matrix(outputs_[l].data() + begin * at.out, end - begin, at.out);
    y.noalias() = matrix(x, end - begin, at.in) * matrix(parameters + at.weights, at.in, at.out);
    y.rowwise() += row(parameters + at.biases, at.out);
    if (l + 1 < layers_.size()) y = y.cwiseMax(0.0f);
    x = y.data();
  }
}

void Mlp::backward_rows(
    std::size_t begin,
    std::size_t end,
    const float* dL_doutputs,
    float* dL_dinputs,
    float* dL_dparameters
) const {
  const std::size_t rows = end - begin;
  const std::size_t last = layers_.size() - 1;
  Matrix g = matrix(dL_doutputs + begin * layers_[last].out, rows, layers_[last].out);
  for (std::size_t l = last;; --l) {
    const Layer& at = layers_[l];
    const float* x = (l == 0 ? inputs_->data() : outputs_[l - 1].data()) + begin * at.in;
    const auto inputs = matrix(x, rows, at.in);
    matrix(dL_dparameters + at.weights, at.in, at.out).noalias() += inputs.transpose() * g;
    row(dL_dparameters + at.biases, at.out) += g.colwise().sum();
    if (l == 0 && dL_dinputs == nullptr) return;
    const auto weights = matrix(parameters_.values.data() + at.weights, at.in, at.out);
    Matrix dL_dx = g * weights.transpose();
    if (l == 0) {
      matrix(dL_dinputs + begin * at.in, rows, at.in) = dL_dx;
      return;
    }
    g = (inputs.array() > 0).select(dL_dx, 0.0f);
  }
}

void Mlp::backward(const FloatArray& dL_doutputs, FloatArray* dL_dinputs) {
  const std::size_t in = layers_.front().in, out = layers_.back().out;
  GLINT_CHECK(
      dL_doutputs.size() == rows_ * out &&
          (dL_dinputs == nullptr || dL_dinputs->size() == rows_ * in),
      kUsage,
      "network: gradients of {} outputs and {} inputs for {} rows of {} and {}",
      dL_doutputs.size(),
      dL_dinputs == nullptr ? 0 : dL_dinputs->size(),
      rows_,
      out,
      in
  );
  if (rows_ == 0) return;
  const std::size_t a_chunk = rows_a_chunk(rows_), chunks = (rows_ + a_chunk - 1) / a_chunk;
  partials_.resize(chunks * parameters_.size());
  if (on_gpu()) {
    backward_on_gpu(dL_doutputs, dL_dinputs);
  } else {
    const float* g = dL_doutputs.data();
    float* g_inputs = dL_dinputs == nullptr ? nullptr : dL_dinputs->data();
    parallel_for(chunks, 1, [&](std::size_t chunk) {
      float* sums = partials_.data() + chunk * parameters_.size();
      std::fill_n(sums, parameters_.size(), 0.0f);
      const std::size_t end = std::min((chunk + 1) * a_chunk, rows_);
      for (std::size_t begin = chunk * a_chunk; begin < end; begin += kBlock)
        backward_rows(begin, std::min(begin + kBlock, end), g, g_inputs, sums);
    });
  }
  const std::size_t count = parameters_.size();
  run_kernel(
      count,
      kGrain,
      MlpSumPartials{partials_.on_device(), chunks, count, parameters_.gradient.on_device()}
  );
}

void Mlp::forward_on_gpu() {
  const float* x = inputs_->on_device();
  const float* parameters = parameters_.values.on_device();
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const Layer& at = layers_[l];
    run_kernel(
        rows_ * at.out,
        kGrain,
        MlpLayerForward{
            x,
            parameters + at.weights,
            parameters + at.biases,
            at.in,
            at.out,
            l + 1 < layers_.size(),
            outputs_[l].on_device()}
    );
    x = outputs_[l].on_device();
  }
}

void Mlp::backward_on_gpu(const FloatArray& dL_doutputs, FloatArray* dL_dinputs) {
  const std::size_t a_chunk = rows_a_chunk(rows_), chunks = (rows_ + a_chunk - 1) / a_chunk;
  const float* g = dL_doutputs.on_device();
  const float* parameters = std::as_const(parameters_.values).on_device();
  for (std::size_t l = layers_.size(); l-- > 0;) {
    const Layer& at = layers_[l];
    const float* x = (l == 0 ? *inputs_ : outputs_[l - 1]).device_for_reading();
    float* sums = partials_.device_for_writing() + at.weights;
    run_kernel(
        chunks * (at.in + 1) * at.out,
        kGrain,
        MlpLayerWeightVjp{x, g, rows_, a_chunk, at.in, at.out, sums, parameters_.size()}
    );
    if (l == 0 && dL_dinputs == nullptr) return;
    if (l > 0) dL_doutput_[l - 1].resize(rows_ * at.in);
    float* dL_dx = (l == 0 ? *dL_dinputs : dL_doutput_[l - 1]).device_for_writing();
    run_kernel(
        rows_ * at.in,
        kGrain,
        MlpLayerInputVjp{parameters + at.weights, g, l == 0 ? nullptr : x, at.in, at.out, dL_dx}
    );
    g = dL_dx;
  }
}

std::vector<TensorToWrite> Mlp::tensors(const std::string& name) const {
  std::vector<TensorToWrite> tensors;
  const float* p = parameters_.values.data();
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const auto [in, out, weights, biases] = layers_[l];
    tensors.push_back(
        float_tensor(tensor_name(name, l, "weight"), {in, out}, {p + weights, in * out})
    );
    tensors.push_back(float_tensor(tensor_name(name, l, "bias"), {out}, {p + biases, out}));
  }
  return tensors;
}

void Mlp::read(SafetensorsFile& file, const std::string& name) {
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const std::size_t in = layers_[l].in, out = layers_[l].out;
    read_floats(file, tensor_name(name, l, "weight"), {in, out}, weights(l));
    read_floats(file, tensor_name(name, l, "bias"), {out}, biases(l));
  }
}

}  // namespace glint

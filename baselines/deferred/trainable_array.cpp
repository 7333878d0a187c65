// SPDX-License-Identifier: MIT
#include "baselines/deferred/trainable_array.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/surfel_set.h"
#include "glint/render/void_steps.h"
#include "glint/train/adam_kernels.h"
#include "glint/train/training_state.h"

namespace glint {

namespace {
constexpr std::size_t kGrain = 1u << 15;  // values a block
}

void TrainableArray::step(float rate) {
  if (first_.size() != values.size()) {
    first_.assign(values.size(), 0.0f);
    second_.assign(values.size(), 0.0f);
    steps_ = 0;
  }
  ++steps_;
  using Kernel = AdamKernel<true>;
  Kernel kernel{
      values.on_device(), gradient.on_device(), first_.on_device(), second_.on_device(), {}, 1, 0};
  kernel.rates[0] = rate / (1 - std::pow(Kernel::kBeta1, static_cast<float>(steps_)));
  kernel.scale_v = 1 / (1 - std::pow(Kernel::kBeta2, static_cast<float>(steps_)));
  kernel.is_void = void_word();
  run_kernel(values.size(), kGrain, kernel);
}

void TrainableArray::check_finite(const std::string& name) const {
  if (on_gpu() && is_finite(values)) return;
  for (std::size_t i = 0; i < values.size(); ++i)
    GLINT_CHECK(
        std::isfinite(values[i]),
        kBadPrediction,
        "{}: value {} of {} is {}; lower its learning rate",
        name,
        i,
        values.size(),
        values[i]
    );
}

void TrainableArray::visit_state(TrainingState& state) {
  const std::size_t count = size();
  state("values", values);
  state("first", first_);
  state("second", second_);
  state("steps", steps_);
  GLINT_CHECK(
      size() == count && first_.size() == second_.size(),
      kBadReference,
      "{} values of a trained array, expected {}",
      size(),
      count
  );
}

TensorToWrite float_tensor(
    std::string name, std::vector<std::size_t> shape, std::span<const float> values
) {
  TensorToWrite tensor;
  tensor.name = std::move(name);
  tensor.info = {TensorType::kF32, std::move(shape)};
  tensor.fill = [values](std::byte* to) { std::memcpy(to, values.data(), values.size_bytes()); };
  return tensor;
}

void read_floats(
    SafetensorsFile& file,
    const std::string& name,
    const std::vector<std::size_t>& shape,
    std::span<float> values
) {
  const std::vector<float> read = file.read<float>(name, shape);
  GLINT_CHECK(
      read.size() == values.size(),
      kUsage,
      "{}: {} values for an array of {}",
      name,
      read.size(),
      values.size()
  );
  std::copy(read.begin(), read.end(), values.begin());
}

}  // namespace glint

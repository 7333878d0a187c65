// SPDX-License-Identifier: MIT
// Parameters that are no surfels' raw parameters (weights of a network, texels of a map, features
// of surfels): one array with its gradient and Adam's moments [Kingma15].
#pragma once

#include <string>

#include "glint/core/arrays.h"
#include "glint/scene/safetensors.h"

namespace glint {

class TrainingState;

class TrainableArray {
 public:
  FloatArray values, gradient;  // of one size

  TrainableArray() = default;
  explicit TrainableArray(std::size_t count) : values(count), gradient(count) {}
  std::size_t size() const { return values.size(); }

  // One step of Adam; sets the gradient back to zero. The moments start at zero when the size has
  // changed since the last step.
  void step(float rate);
  // Errors (kBadPrediction): a value is not finite; names it by its place in the array.
  void check_finite(const std::string& name) const;

  // Errors (kBadReference): other sizes than these.
  void visit_state(TrainingState& state);

 private:
  FloatArray first_, second_;
  int steps_ = 0;
};

// A tensor of a file that borrows these values; and its values back into an array of that size.
// Errors of the latter (kBadReference): SafetensorsFile::read()'s.
TensorToWrite float_tensor(
    std::string name, std::vector<std::size_t> shape, std::span<const float> values
);
void read_floats(
    SafetensorsFile& file,
    const std::string& name,
    const std::vector<std::size_t>& shape,
    std::span<float> values
);

}  // namespace glint

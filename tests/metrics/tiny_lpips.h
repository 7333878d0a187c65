// SPDX-License-Identifier: MIT
// A small network of every kind of layer with random weights, and LPIPS by plain loops in double.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "glint/core/rng.h"
#include "glint/scene/safetensors.h"
#include "metrics/lpips.h"
#include "metrics/lpips_formula.h"

namespace glint::test {

inline LpipsNetwork tiny_network() {
  return {
      "tiny",
      "Tiny",
      {convolution("features.0", 6, 5, 2, 2).tapped(),
       max_pool(3, 2),
       convolution("features.3", 10, 3, 1, 1).tapped(),
       max_pool(2, 2),
       convolution("features.5", 7, 3, 1, 1),
       convolution("features.7", 8, 3, 1, 0).tapped()}};
}

inline LpipsArray random_array(const std::vector<int>& shape, float low, float high) {
  static Rng rng(2024);
  LpipsArray array{{shape.begin(), shape.end()}, {}};
  std::size_t count = 1;
  for (const std::size_t extent : array.shape) count *= extent;
  array.values.resize(count);
  for (float& value : array.values) value = rng.uniform(low, high);
  return array;
}

// Weights that neither let features grow nor die out on the way.
inline void add_random_convolution(
    LpipsArrays& arrays, const std::string& name, int out, int in, int kernel
) {
  const float bound = std::sqrt(6.0f / static_cast<float>(in * kernel * kernel));
  arrays[name + ".weight"] = random_array({out, in, kernel, kernel}, -bound, bound);
  arrays[name + ".bias"] = random_array({out}, -0.1f, 0.3f);
}

inline LpipsArrays random_arrays(const LpipsNetwork& network) {
  LpipsArrays arrays;
  int channels = 3, num_taps = 0;
  for (const LpipsLayer& layer : network.layers) {
    const int in = channels;
    if (layer.channels > 0) channels = layer.channels;
    if (!layer.pools()) add_random_convolution(arrays, layer.name, channels, in, layer.kernel);
    if (layer.tap)
      arrays[fmt::format("lin{}.weight", num_taps++)] = random_array({channels}, 0.0f, 1.0f);
  }
  return arrays;
}

inline void write_weights(const fs::path& path, const LpipsArrays& arrays) {
  std::vector<TensorToWrite> tensors;
  for (const auto& [name, array] : arrays)
    tensors
        .push_back({name, {TensorType::kF32, array.shape}, [&values = array.values](std::byte* to) {
                      std::memcpy(to, values.data(), values.size() * sizeof(float));
                    }});
  write_safetensors(path, {}, tensors);
}

// [H][W][channels] in double.
using Features = BasicImage<double>;

class PlainLpips {
 public:
  PlainLpips(const LpipsNetwork& network, const LpipsArrays& arrays)
      : network_(network), arrays_(arrays) {}

  // Images in [0, 1], fed as [-1, 1]. The sum over the taps of their means.
  double distance(const Features& prediction, const Features& reference) const {
    const std::vector<Features> a = taps(prediction), b = taps(reference);
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += tap_mean(a[i], b[i], arrays_.at(fmt::format("lin{}.weight", i)).values);
    return sum;
  }

 private:
  static double tap_mean(const Features& a, const Features& b, const std::vector<float>& lin) {
    const std::vector<double> weights(lin.begin(), lin.end());
    double sum = 0;
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x)
        sum += lpips_tap<double>(a.pixel(x, y), b.pixel(x, y), weights.data(), a.channels());
    return sum / static_cast<double>(a.num_pixels());
  }

  std::vector<Features> taps(const Features& image) const {
    Features features(image.width(), image.height(), 3);
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        for (int c = 0; c < 3; ++c)
          features.at(x, y, c) = (2 * image.at(x, y, c) - 1 - kLpipsShift[c]) / kLpipsScale[c];
    std::vector<Features> taps;
    for (const LpipsLayer& layer : network_.layers) {
      features = apply(layer, features);
      if (layer.tap) taps.push_back(features);
    }
    return taps;
  }

  Features apply(const LpipsLayer& layer, const Features& in) const {
    if (layer.pools()) return pooled(layer, in);
    return convolved(layer.name, layer.stride, layer.padding, in);
  }

  Features convolved(const std::string& name, int stride, int padding, const Features& in) const {
    const LpipsArray& weight = arrays_.at(name + ".weight");
    const int out_channels = static_cast<int>(weight.shape[0]);
    const int kernel = static_cast<int>(weight.shape[2]);
    const auto extent = [&](int size) { return (size + 2 * padding - kernel) / stride + 1; };
    Features out(extent(in.width()), extent(in.height()), out_channels);
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x)
        for (int o = 0; o < out_channels; ++o) {
          double sum = static_cast<double>(arrays_.at(name + ".bias").values[o]);
          for (int c = 0; c < in.channels(); ++c)
            for (int j = 0; j < kernel; ++j)
              for (int i = 0; i < kernel; ++i) {
                const int u = x * stride + i - padding, v = y * stride + j - padding;
                if (u < 0 || v < 0 || u >= in.width() || v >= in.height()) continue;
                const int at = ((o * in.channels() + c) * kernel + j) * kernel + i;
                sum += static_cast<double>(weight.values[at]) * in.at(u, v, c);
              }
          out.at(x, y, o) = std::max(0.0, sum);
        }
    return out;
  }

  // Windows that fit.
  static Features pooled(const LpipsLayer& layer, const Features& in) {
    const auto extent = [&](int size) { return (size - layer.kernel) / layer.stride + 1; };
    Features out(extent(in.width()), extent(in.height()), in.channels());
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x)
        for (int c = 0; c < in.channels(); ++c) {
          double largest = -std::numeric_limits<double>::infinity();
          for (int j = 0; j < layer.kernel; ++j)
            for (int i = 0; i < layer.kernel; ++i)
              largest = std::max(largest, in.at(x * layer.stride + i, y * layer.stride + j, c));
          out.at(x, y, c) = largest;
        }
    return out;
  }

  LpipsNetwork network_;
  LpipsArrays arrays_;
};

}  // namespace glint::test

// SPDX-License-Identifier: MIT
// A small network of every kind of layer with random weights, and LPIPS by plain loops in double.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "glint/core/rng.h"
#include "metrics/lpips.h"
#include "metrics/lpips_formula.h"

namespace glint::test {

inline LpipsNetwork tiny_network() {
  return {
      "tiny",
      "Tiny",
      {convolution("features.0", 6, 5, 2, 2).tapped(),
       max_pool(3, 2, true),
       fire("features.3", 4, 5).tapped(),
       max_pool(2, 2),
       convolution("features.5", 7, 3, 1, 1),
       convolution("features.7", 8, 3, 1, 0).tapped()}};
}

inline NpzArray random_array(const std::vector<std::int64_t>& shape, float low, float high) {
  static Rng rng(2024);
  std::size_t count = 1;
  for (const std::int64_t extent : shape) count *= static_cast<std::size_t>(extent);
  NpzArray array{shape, std::vector<float>(count)};
  for (float& value : array.values) value = rng.uniform(low, high);
  return array;
}

// Weights that neither let features grow nor die out on the way.
inline void add_random_convolution(
    NpzArrays& arrays, const std::string& name, int out, int in, int kernel
) {
  const float bound = std::sqrt(6.0f / static_cast<float>(in * kernel * kernel));
  arrays[name + ".weight"] = random_array({out, in, kernel, kernel}, -bound, bound);
  arrays[name + ".bias"] = random_array({out}, -0.1f, 0.3f);
}

inline NpzArrays random_arrays(const LpipsNetwork& network) {
  NpzArrays arrays;
  int channels = 3, num_taps = 0;
  for (const LpipsLayer& layer : network.layers) {
    const int in = channels;
    if (layer.channels > 0) channels = layer.channels;
    if (layer.kind == LpipsLayer::Kind::kConvolution) {
      add_random_convolution(arrays, layer.name, channels, in, layer.kernel);
    } else if (layer.kind == LpipsLayer::Kind::kFire) {
      add_random_convolution(arrays, layer.name + ".squeeze", layer.squeeze, in, 1);
      add_random_convolution(arrays, layer.name + ".expand1x1", channels / 2, layer.squeeze, 1);
      add_random_convolution(arrays, layer.name + ".expand3x3", channels / 2, layer.squeeze, 3);
    }
    if (layer.tap)
      arrays[fmt::format("lin{}.weight", num_taps++)] = random_array({channels}, 0.0f, 1.0f);
  }
  return arrays;
}

// [H][W][channels] in double.
using Features = BasicImage<double>;

class PlainLpips {
 public:
  PlainLpips(const LpipsNetwork& network, const NpzArrays& arrays)
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
    if (layer.kind == LpipsLayer::Kind::kMaxPool) return pooled(layer, in);
    if (layer.kind == LpipsLayer::Kind::kConvolution)
      return convolved(layer.name, layer.stride, layer.padding, in);
    const Features squeezed = convolved(layer.name + ".squeeze", 1, 0, in);
    return side_by_side(
        convolved(layer.name + ".expand1x1", 1, 0, squeezed),
        convolved(layer.name + ".expand3x3", 1, 1, squeezed)
    );
  }

  Features convolved(const std::string& name, int stride, int padding, const Features& in) const {
    const NpzArray& weight = arrays_.at(name + ".weight");
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

  // Rounded up: windows until the end of the image is covered. Otherwise: while they fit.
  static Features pooled(const LpipsLayer& layer, const Features& in) {
    const auto extent = [&](int size) {
      const int limit = layer.round_up ? size + layer.stride - 1 : size;
      int count = 1;
      while (count * layer.stride + layer.kernel <= limit) ++count;
      return count;
    };
    Features out(extent(in.width()), extent(in.height()), in.channels());
    for (int y = 0; y < out.height(); ++y)
      for (int x = 0; x < out.width(); ++x)
        for (int c = 0; c < in.channels(); ++c) {
          double largest = -std::numeric_limits<double>::infinity();
          for (int v = y * layer.stride; v < std::min(y * layer.stride + layer.kernel, in.height());
               ++v)
            for (int u = x * layer.stride;
                 u < std::min(x * layer.stride + layer.kernel, in.width());
                 ++u)
              largest = std::max(largest, in.at(u, v, c));
          out.at(x, y, c) = largest;
        }
    return out;
  }

  static Features side_by_side(const Features& a, const Features& b) {
    Features out(a.width(), a.height(), a.channels() + b.channels());
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) {
        std::copy_n(a.pixel(x, y), a.channels(), out.pixel(x, y));
        std::copy_n(b.pixel(x, y), b.channels(), out.pixel(x, y) + a.channels());
      }
    return out;
  }

  LpipsNetwork network_;
  NpzArrays arrays_;
};

}  // namespace glint::test

// SPDX-License-Identifier: MIT
#include "metrics/lpips_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "glint/core/error.h"
#include "glint/core/sha256.h"

namespace glint {
namespace {

struct KnownWeights {
  const char *network, *version, *arrays_sha256;
};
// The published networks (LPIPS 0.1, torchvision's features).
constexpr std::array<KnownWeights, 2> kKnownWeights{{
    {"alex", "0.1", "0ef71af41cc957e07f0eaf349e2ec748453cce1a8f60ed9a6c878328338496a7"},
    {"squeeze", "0.1", "2ca1ac118a52387307bd9d1c829d83b8f5c2214a4e6569e89b1a149ef5a2c533"},
}};

using Shape = std::vector<std::int64_t>;

// Hands out arrays by name and remembers which were asked for.
class ArrayReader {
 public:
  ArrayReader(const NpzArrays& arrays, std::string where)
      : arrays_(arrays), where_(std::move(where)) {}

  const std::vector<float>& take(const std::string& name, const Shape& shape) {
    const auto found = arrays_.find(name);
    GLINT_CHECK(found != arrays_.end(), kBadReference, "{}: no array '{}'", where_, name);
    const NpzArray& array = found->second;
    GLINT_CHECK(
        array.shape == shape,
        kBadReference,
        "{}: {} has shape ({}), expected ({})",
        where_,
        name,
        fmt::join(array.shape, ", "),
        fmt::join(shape, ", ")
    );
    const bool finite = std::all_of(array.values.begin(), array.values.end(), [](float value) {
      return std::isfinite(value);
    });
    GLINT_CHECK(finite, kBadReference, "{}: {} has values that are not finite", where_, name);
    taken_.insert(name);
    return array.values;
  }

  void check_all_taken() const {
    for (const auto& [name, array] : arrays_)
      GLINT_CHECK(
          taken_.contains(name),
          kBadReference,
          "{}: array '{}' belongs to no layer that LPIPS uses",
          where_,
          name
      );
  }

  const std::string& where() const { return where_; }

 private:
  const NpzArrays& arrays_;
  std::string where_;
  std::set<std::string> taken_;
};

FeatureStep read_convolution(
    ArrayReader& reader, const std::string& name, const LpipsLayer& layer, int in_channels
) {
  FeatureStep step{false, in_channels, layer.channels, layer.kernel, layer.stride, layer.padding};
  step.tap = layer.tap;
  step.weight =
      reader.take(name + ".weight", {layer.channels, in_channels, layer.kernel, layer.kernel});
  step.bias = reader.take(name + ".bias", {layer.channels});
  return step;
}

// The two expansions as one 3x3 convolution: a 1x1 kernel is a 3x3 one that is zero but for its
// centre. So every network is a chain of two kinds of steps.
FeatureStep read_expansions(ArrayReader& reader, const LpipsLayer& layer) {
  const int half = layer.channels / 2;
  const LpipsLayer one = convolution({}, half, 1, 1, 0), three = convolution({}, half, 3, 1, 1);
  const FeatureStep centre =
      read_convolution(reader, layer.name + ".expand1x1", one, layer.squeeze);
  FeatureStep step = read_convolution(reader, layer.name + ".expand3x3", three, layer.squeeze);
  std::vector<float> widened(centre.weight.size() * 9, 0.0f);
  for (std::size_t i = 0; i < centre.weight.size(); ++i) widened[9 * i + 4] = centre.weight[i];
  step.weight.insert(step.weight.begin(), widened.begin(), widened.end());
  step.bias.insert(step.bias.begin(), centre.bias.begin(), centre.bias.end());
  step.out_channels = layer.channels;
  step.tap = layer.tap;
  return step;
}

FeatureStep pooling(const LpipsLayer& layer, int channels) {
  FeatureStep step{true, channels, channels, layer.kernel, layer.stride, layer.padding};
  step.round_up = layer.round_up;
  step.tap = layer.tap;
  return step;
}

void append_layer(ArrayReader& reader, const LpipsLayer& layer, std::vector<FeatureStep>& steps) {
  const int in_channels = steps.empty() ? 3 : steps.back().out_channels;
  if (layer.kind == LpipsLayer::Kind::kMaxPool) {
    steps.push_back(pooling(layer, in_channels));
  } else if (layer.kind == LpipsLayer::Kind::kConvolution) {
    steps.push_back(read_convolution(reader, layer.name, layer, in_channels));
  } else {
    const LpipsLayer squeeze = convolution({}, layer.squeeze, 1, 1, 0);
    steps.push_back(read_convolution(reader, layer.name + ".squeeze", squeeze, in_channels));
    steps.push_back(read_expansions(reader, layer));
  }
}

std::vector<std::vector<float>> read_lin(
    ArrayReader& reader, const std::vector<FeatureStep>& steps
) {
  std::vector<std::vector<float>> lin;
  for (const FeatureStep& step : steps) {
    if (!step.tap) continue;
    const std::string name = fmt::format("lin{}.weight", lin.size());
    lin.push_back(reader.take(name, {step.out_channels}));
    const bool distance = *std::min_element(lin.back().begin(), lin.back().end()) >= 0;
    GLINT_CHECK(
        distance,
        kBadReference,
        "{}: {} has negative weights; LPIPS is then no distance",
        reader.where(),
        name
    );
  }
  return lin;
}

std::string checksum(const NpzArrays& arrays) {
  std::string bytes;
  for (const auto& [name, array] : arrays) {
    bytes.append(name).push_back('\0');
    bytes.append(
        reinterpret_cast<const char*>(array.values.data()), array.values.size() * sizeof(float)
    );
  }
  return sha256(bytes);
}

std::string known_version(const LpipsWeights& weights) {
  for (const KnownWeights& known : kKnownWeights)
    if (weights.network == known.network && weights.arrays_sha256 == known.arrays_sha256)
      return known.version;
  return {};
}

}  // namespace

LpipsWeights make_lpips_weights(
    const LpipsNetwork& network, const NpzArrays& arrays, const std::string& where
) {
  LpipsWeights weights;
  weights.network = network.name;
  ArrayReader reader(arrays, where);
  for (const LpipsLayer& layer : network.layers) append_layer(reader, layer, weights.steps);
  weights.lin = read_lin(reader, weights.steps);
  reader.check_all_taken();
  weights.arrays_sha256 = checksum(arrays);
  weights.version = known_version(weights);
  return weights;
}

}  // namespace glint

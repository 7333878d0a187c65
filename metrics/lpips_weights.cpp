// SPDX-License-Identifier: MIT
#include "metrics/lpips_weights.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "glint/core/error.h"
#include "glint/core/sha256.h"
#include "glint/scene/safetensors.h"

namespace glint {
namespace {

struct KnownWeights {
  const char *network, *version, *arrays_sha256;
};
// The published networks (LPIPS 0.1, torchvision's features).
constexpr KnownWeights kKnownWeights[] = {
    {"alex", "0.1", "0ef71af41cc957e07f0eaf349e2ec748453cce1a8f60ed9a6c878328338496a7"}};

// Hands out arrays by name and remembers which were asked for.
class ArrayReader {
 public:
  ArrayReader(const LpipsArrays& arrays, std::string where)
      : arrays_(arrays), where_(std::move(where)) {}

  const std::vector<float>& take(const std::string& name, const std::vector<int>& extents) {
    const std::vector<std::size_t> shape(extents.begin(), extents.end());
    const auto found = arrays_.find(name);
    GLINT_CHECK(found != arrays_.end(), kBadReference, "{}: no array '{}'", where_, name);
    const LpipsArray& array = found->second;
    GLINT_CHECK(
        array.shape == shape,
        kBadReference,
        "{}: {} has shape {}, expected {}",
        where_,
        name,
        shape_text(array.shape),
        shape_text(shape)
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
  const LpipsArrays& arrays_;
  std::string where_;
  std::set<std::string> taken_;
};

FeatureStep read_step(ArrayReader& reader, const LpipsLayer& layer, int in_channels) {
  FeatureStep step{layer.pools(), in_channels, layer.pools() ? in_channels : layer.channels};
  step.kernel = layer.kernel, step.stride = layer.stride, step.padding = layer.padding;
  step.tap = layer.tap;
  if (step.pools) return step;
  step.weight = reader.take(
      layer.name + ".weight", {layer.channels, in_channels, layer.kernel, layer.kernel}
  );
  step.bias = reader.take(layer.name + ".bias", {layer.channels});
  return step;
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

std::string checksum(const LpipsArrays& arrays) {
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
    const LpipsNetwork& network, const LpipsArrays& arrays, const std::string& where
) {
  LpipsWeights weights;
  weights.network = network.name;
  ArrayReader reader(arrays, where);
  for (const LpipsLayer& layer : network.layers) {
    const int in_channels = weights.steps.empty() ? 3 : weights.steps.back().out_channels;
    weights.steps.push_back(read_step(reader, layer, in_channels));
  }
  weights.lin = read_lin(reader, weights.steps);
  reader.check_all_taken();
  weights.arrays_sha256 = checksum(arrays);
  weights.version = known_version(weights);
  return weights;
}

}  // namespace glint

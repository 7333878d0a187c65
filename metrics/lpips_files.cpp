// SPDX-License-Identifier: MIT
// Files of LPIPS weights: which network one holds, where they lie.
#include <algorithm>
#include <cstdlib>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/sha256.h"
#include "glint/scene/safetensors.h"
#include "metrics/lpips_weights.h"

namespace glint {
namespace {

std::size_t num_known_names(const LpipsNetwork& network, const LpipsArrays& arrays) {
  std::size_t count = 0;
  for (const LpipsLayer& layer : network.layers) count += arrays.contains(layer.name + ".weight");
  return count;
}

// The network most of whose layers have arrays.
const LpipsNetwork& recognise(const LpipsArrays& arrays, const fs::path& path) {
  const auto& networks = lpips_networks();
  const auto best = std::max_element(
      networks.begin(),
      networks.end(),
      [&](const LpipsNetwork& a, const LpipsNetwork& b) {
        return num_known_names(a, arrays) < num_known_names(b, arrays);
      }
  );
  GLINT_CHECK(
      num_known_names(*best, arrays) > 0,
      kBadReference,
      "{}: no array of an LPIPS network ('features.0.weight', ...); make the file with "
      "scripts/convert_lpips_weights.py",
      path.string()
  );
  return *best;
}

LpipsArrays read_arrays(const fs::path& path) {
  GLINT_CHECK(
      path.extension() != ".npz",
      kBadReference,
      "{0}: weights are .safetensors files now; make one of this one by "
      "scripts/convert_lpips_weights.py --npz {0}, or run scripts/fetch_lpips_weights.sh again, "
      "which takes what it has downloaded",
      path.string()
  );
  SafetensorsFile file(path);
  LpipsArrays arrays;
  for (const std::string& name : file.names()) {
    const std::vector<std::size_t> shape = file.find(name)->shape;
    arrays[name] = {shape, file.read<float>(name, shape)};
  }
  return arrays;
}

}  // namespace

LpipsWeights load_lpips_weights(const fs::path& path) {
  const LpipsArrays arrays = read_arrays(path);
  const std::string where = path.string();
  LpipsWeights weights = make_lpips_weights(recognise(arrays, path), arrays, where);
  weights.sha256 = sha256(read_file(path));
  if (weights.version.empty())
    log::warn(fmt::format(
        "{}: LPIPS ({}) with weights that are not known (arrays {}...); values may not be "
        "comparable "
        "with published ones (docs/reference/metrics.md)",
        where,
        weights.network,
        weights.arrays_sha256.substr(0, 16)
    ));
  return weights;
}

fs::path lpips_weights_place() {
  if (const char* place = std::getenv("GLINT_LPIPS_WEIGHTS"); place && *place) return place;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return fs::path(cache) / "glint-bench" / "lpips";
  if (const char* home = std::getenv("HOME"); home && *home)
    return fs::path(home) / ".cache" / "glint-bench" / "lpips";
  return {};
}

std::shared_ptr<const LpipsWeights> lpips_weights_at(const fs::path& place, std::string network) {
  if (place.empty()) return nullptr;
  const bool folder = is_folder(place);
  if (folder && network.empty()) network = "alex";
  fs::path file = folder ? place / fmt::format("lpips_{}_v0.1.safetensors", network) : place;
  if (folder && !is_there(file)) file.replace_extension(".npz");  // says what to do
  if (!is_there(file)) return nullptr;
  try {
    auto weights = std::make_shared<const LpipsWeights>(load_lpips_weights(file));
    return network.empty() || weights->network == network ? weights : nullptr;
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error& error) {
    throw MissingWeights(error.what());
  }
}

}  // namespace glint

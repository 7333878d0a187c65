// SPDX-License-Identifier: MIT
// The weights of an LPIPS network, a file of safetensors that the user has
// (scripts/convert_lpips_weights.py makes it). Arrays are named as in the published files:
// features.N.weight [out][in][k][k], features.N.bias [out], linK.weight [channels] of the K-th tap.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "metrics/lpips_network.h"

namespace glint {

// One step of the chain, ready to run.
struct FeatureStep {
  bool pools = false;  // max pooling; otherwise a convolution with bias and ReLU
  int in_channels = 3, out_channels = 3;
  int kernel = 1, stride = 1, padding = 0;
  bool tap = false;
  std::vector<float> weight, bias;  // [out][in][kernel][kernel], [out]
};

struct LpipsArray {
  std::vector<std::size_t> shape;
  std::vector<float> values;
};
using LpipsArrays = std::map<std::string, LpipsArray>;  // by name

struct LpipsWeights {
  std::string network;  // "alex"
  std::string version;  // "0.1"; empty: not among the known checksums
  std::string sha256;   // of the file, as sha256sum prints it; empty: not from a file
  // Of the arrays: name, a zero byte, values; in the order of the names. The same weights have the
  // same in whatever file: the version is known by it.
  std::string arrays_sha256;
  std::vector<FeatureStep> steps;
  std::vector<std::vector<float>> lin;  // a weight per channel of each tap
};

// Errors (kBadReference): a missing or unknown name, another shape, negative lin weights or values
// that are not finite. `where` opens messages.
LpipsWeights make_lpips_weights(
    const LpipsNetwork& network, const LpipsArrays& arrays, const std::string& where
);

// Which network it is, the names say. Warns where the checksum is not known: values are then not
// comparable with published ones. Errors: as above, and of
// SafetensorsFile.
LpipsWeights load_lpips_weights(const fs::path& path);

// Where weights are looked for: the file or folder that GLINT_LPIPS_WEIGHTS names, otherwise
// $XDG_CACHE_HOME/glint-bench/lpips (~/.cache/...). Empty: no home either.
fs::path lpips_weights_place();
// The weights of `network` in a place: a file, or lpips_<network>_v0.1.safetensors in a folder.
// Nothing where there is no such file, or the file is of another network. An empty `network` means
// the file's own, in a folder alex. Errors (kEnvironment): a file that cannot be used, an .npz of
// earlier versions.
std::shared_ptr<const LpipsWeights> lpips_weights_at(const fs::path& place, std::string network);

}  // namespace glint

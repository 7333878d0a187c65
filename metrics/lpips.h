// SPDX-License-Identifier: MIT
// LPIPS 0.1 [Zhang18]: distance of two images in the features of a network trained on photos.
// Small: alike.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/image.h"
#include "metrics/lpips_weights.h"

namespace glint {

// What the network is fed. kSymmetric: values mapped to [-1, 1], as LPIPS defines. kUnit: [0, 1] as
// they are, as the code of 3DGS, 2DGS, EnvGS and GLINT does; other numbers come out.
enum class LpipsRange { kSymmetric, kUnit };
NLOHMANN_JSON_SERIALIZE_ENUM(
    LpipsRange, {{LpipsRange::kSymmetric, "[-1, 1]"}, {LpipsRange::kUnit, "[0, 1]"}}
)

struct LpipsProtocol {
  std::string network;
  LpipsRange range = LpipsRange::kSymmetric;
  std::string mean = "over each tap; masked: over the mask of the bilinearly enlarged taps";
  static constexpr bool clamp = true;
  template <class V>
  void visit(V&& v) {
    v("network", network, "alex or vgg");
    v("range", range, "of what the network is fed");
    v("mean", mean, "spatial mean");
    v("clamp", clamp, "the prediction is clamped to [0, 1]");
  }
};

// What is recorded with the protocol: {"weights": "LPIPS 0.1" or "unknown", "sha256": ...}: of
// the file, as sha256sum prints it (records before this had a checksum of the arrays).
Json lpips_provenance(const LpipsWeights& weights);

using LpipsMap = BasicImage<double>;  // [h][w][1]

// Of one network. Compiled for the size of the last images, so that a folder of one size pays once.
// Not to be used by two threads at once.
class Lpips {
 public:
  // most_bytes: for targets that are kept; on a GPU never more than a quarter of what is free, on
  // the CPU than 1 GiB.
  explicit Lpips(
      std::shared_ptr<const LpipsWeights> weights,
      LpipsRange range = LpipsRange::kSymmetric,
      std::size_t most_bytes = ~std::size_t{0}
  );
  ~Lpips();

  // The weighted squared distance at every position of every tap, at the taps' sizes. Both images
  // [H][W][3] in [0, 1], the prediction is clamped. Errors: as mse(), kBadReference besides for
  // images too small for the network.
  std::vector<LpipsMap> tap_maps(ImageView prediction, ImageView reference);

  // Without a mask the published value: the sum of the taps' means. With one, the mean of
  // lpips_map() over it. Errors besides: kBadReference for an empty mask.
  double distance(ImageView prediction, ImageView reference, MaskView mask = {});

  // For training: returns the distance (only told: NaN in a silent step), nothing clamped, and adds
  // weight * gradient to dL_drendered. A target that comes again has a number, always of the same
  // picture: its features are kept where there is room. Errors: as tap_maps(); on a GPU nobody
  // looks whether values are finite.
  double evaluate(
      const Image& rendered,
      const Image& target,
      float weight,
      Image& dL_drendered,
      std::optional<std::size_t> target_id = {}
  );
  std::size_t num_kept_targets() const;

  // False: images too small for the network.
  bool accepts(ImageSize size) const;
  const LpipsWeights& weights() const;
  LpipsRange range() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// The sum of the maps' means.
double lpips_mean(const std::vector<LpipsMap>& taps);
// The sum of the maps, each enlarged bilinearly to `size`: what the published code calls spatial.
LpipsMap lpips_map(const std::vector<LpipsMap>& taps, ImageSize size);
// lpips_mean() without a mask; with one, the mean of lpips_map() over it, nothing where it is
// empty.
std::optional<double> lpips_mean(const std::vector<LpipsMap>& taps, MaskView mask);

}  // namespace glint

// SPDX-License-Identifier: MIT
// View-dependent colour that a network adds to surfels' spherical harmonics [TSGS, after
// Spec-Gaussian]: a feature per surfel becomes the numbers of anisotropic spherical Gaussians about
// fixed axes, which are asked for the viewing direction and, with that direction's encoding, become
// RGB.
#pragma once

#include <vector>

#include "baselines/deferred/mlp.h"
#include "baselines/planar/lobe_appearance_kernels.h"
#include "glint/render/surfel_set.h"

namespace glint {

struct LobeRates {
  float feature = 2.5e-3f, network = 2.5e-3f, network_final = 1.25e-4f;

  template <class V>
  void visit(V&& v) {
    v("rate_lobe_feature", feature, "learning rate of lobes' features");
    v("rate_lobe", network, "learning rate of lobes' networks");
    v("rate_lobe_final", network_final, "the same at the end of the run");
  }
  // All of them faster_rates() times as high.
  LobeRates for_shorter_run(double shortening) const;
};

// Its authors' network for rooms: lobes see the viewing direction.
struct LobeAppearanceConfig {
  int feature = 12;        // numbers of a surfel's feature
  int theta = 2, phi = 4;  // axes of lobes between the poles and around them
  int hidden = 32;         // width of the network's two hidden layers
  LobeRates rates;

  int num_lobes() const { return theta * phi; }
  // Two values a lobe, the viewing direction and its encoding.
  int input_width() const { return 2 * num_lobes() + 3 + kEncodedDirection; }
};

// visible[i] becomes 1 where something of surfel i can be in the picture: its 3-sigma sphere meets
// the pyramid of the image. All that reach a pixel are among them, and some that do not.
void mark_in_pyramid(const SurfelCloud& cloud, const Camera& camera, Array<std::uint8_t>& visible);

class LobeAppearance {
 public:
  LobeAppearance() = default;
  // Features of `count` surfels start at zero. The surfels must stay the same ones in the same
  // order: make it after density control has ended (in TSGS at half of the run).
  LobeAppearance(const LobeAppearanceConfig& config, std::size_t count, std::uint64_t seed);

  // What to add to the colours of the surfels with visible[i] != 0, [N][3]; zero for all others.
  // means: [N][3] metres, world; eye: camera centre. All must stay as they are until backward().
  // The result is valid until the next call. Errors (kUsage): arrays of another number of surfels.
  const FloatArray& forward(const FloatArray& means, Vec3f eye, const Array<std::uint8_t>& visible);
  // The same for a cloud as a camera sees it, which must stay as it is until backward().
  const FloatArray& forward(const SurfelCloud& cloud, const Camera& camera);
  // Adds dL/d(features and weights) of the last forward(). Positions are constants.
  void backward(const FloatArray& dL_doffsets);
  // The same from what was rasterised with the offsets; channels: of its features.
  void backward(const RasterGradient& gradient, int channels);
  // An optimiser step, the networks' rate at step `step` of `steps`.
  void step(int step, int steps);

  const LobeAppearanceConfig& config() const { return config_; }
  std::size_t num_surfels() const { return count_; }
  TrainableArray& features() { return features_; }  // [N][feature]
  Mlp& to_lobes() { return to_lobes_; }
  Mlp& to_color() { return to_color_; }

  std::vector<TensorToWrite> tensors(const std::string& name) const;
  void read(SafetensorsFile& file, const std::string& name);
  void check_finite(const std::string& name) const;
  template <class State>
  void visit_state(State& state) {
    state("features", features_);
    state("to_lobes", to_lobes_);
    state("to_color", to_color_);
  }

 private:
  void find_visible(const Array<std::uint8_t>& visible);
  void clear_unseen(FloatArray& rows) const;

  LobeAppearanceConfig config_;
  std::size_t count_ = 0;
  Array<LobeFrame<float>> frames_;
  TrainableArray features_;
  Mlp to_lobes_, to_color_;
  // Of the last forward(); M visible surfels.
  Array<std::uint8_t> visible_;  // [N]
  const Array<std::uint8_t>* seen_ = nullptr;
  LobeView view_{};
  Array<std::uint32_t> surfels_;         // [M]
  FloatArray seen_features_, inputs_;    // [M][feature], [M][input_width]
  FloatArray offsets_;                   // [N][3]
  const FloatArray* numbers_ = nullptr;  // [M][lobes][4]
  FloatArray dL_doffsets_;               // [N][3]
  FloatArray dL_dcolors_, dL_dinputs_, dL_dnumbers_, dL_dfeatures_;
};

}  // namespace glint

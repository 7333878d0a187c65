// SPDX-License-Identifier: MIT
// Losses that look at the transmission set from the camera on its own (not only behind the
// interface), and at the transparency map t: guidance [Na26 Sec. 4], and what GLINT's release adds
// (direct supervision, plausibility, a prior on t).
#pragma once

#include <string>

#include "glint/render/glass_transport.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/photometric.h"
#include "glint/train/trainable_set.h"
#include "glint/train/transparency_guidance.h"
#include "glint/train/transparency_prior.h"

namespace glint {

struct TransmissionLossConfig {
  std::string guidance = "paper";
  float lambda_transparency = 0.1f;
  float depth_threshold = 0.01f, low_albedo = 0.05f;
  float lambda_direct = 0, lambda_plausible = 0, lambda_transparency_prior = 0;
  int transparency_from = 7000, plausible_from = 5000, transparency_prior_from = 7000;

  template <class V>
  void visit(V&& v) {
    v("guidance", guidance, "of t: paper (L1 to one mask) or release (cross-entropy to two)");
    v("lambda_transparency", lambda_transparency, "weight of transparency guidance");
    v("depth_threshold", depth_threshold, "tau_d: metres between the layers at glass");
    v("low_albedo", low_albedo, "gamma_a: albedo of glass lies below");
    v("lambda_direct", lambda_direct, "photometric loss of the transmission set on its own");
    v("lambda_plausible", lambda_plausible, "ties transmission to the interface where opaque");
    v("lambda_transparency_prior", lambda_transparency_prior, "entropy, mean, smoothness of t");
    v("transparency_from", transparency_from, "first published iteration of guidance");
    v("plausible_from", plausible_from, "first published iteration of plausibility");
    v("transparency_prior_from", transparency_prior_from, "first published iteration of that");
  }
  template <class F>
  void scale(F&& scaled) {
    for (int* window : {&transparency_from, &plausible_from, &transparency_prior_from})
      *window = scaled(*window);
  }
};

class TransmissionLosses {
 public:
  // `config` with windows of this run. Errors (kUsage): unknown kind of guidance. Guidance is off
  // when a training view lacks the prior it needs; returns a warning for it.
  std::vector<std::string> set_up(
      const TransmissionLossConfig& config, const Scene& scene, const std::string& method
  );
  // Rasterises `transmission` where a loss needs it, and adds the gradient of its parameters and of
  // the transparency map. `interface` and `buffer` are constants.
  void add(
      const View& view,
      int iteration,
      int sh_degree,
      PhotometricWeights weights,
      const RasterOutput& interface,
      const GlassBuffer& buffer,
      TrainableSet& transmission,
      Image& dL_dtransparency,
      StepStats& stats
  );

 private:
  TransparencyCues cues(const View& view, const RasterOutput& interface, const GlassBuffer& buffer);
  void add_direct(
      const View& view,
      int iteration,
      PhotometricWeights weights,
      const GlassBuffer& buffer,
      TrainableSet& transmission,
      StepStats& stats
  );
  void add_plausible(
      const View& view, const RasterOutput& out, const GlassBuffer& buffer, StepStats& stats
  );

  TransmissionLossConfig config_;
  TransparencyGuidance guidance_;
  TransparencyPriorLoss transparency_prior_;
  PhotometricLoss photometric_;
  DepthPriorLoss depth_;
  NormalPriorLoss normal_;
  RasterPass pass_;
  RasterOutputGradient dL_ddirect_;
  TransparencyMasks masks_;
  Image direct_depth_, cosine_, dL_ddepth_;
};

}  // namespace glint

// SPDX-License-Identifier: MIT
// Losses that look at the transmission set from the camera on its own (not only behind the
// interface), and at the transparency map t: guidance [Na26 Sec. 3.4], and what GLINT's release
// adds (direct supervision by colour and on its normals, plausibility, a prior on t).
#pragma once

#include <string>

#include "glint/render/glass_transport.h"
#include "glint/train/clip_at_white.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/masked_transparency.h"
#include "glint/train/perceptual.h"
#include "glint/train/photometric.h"
#include "glint/train/trainable_set.h"
#include "glint/train/transparency_guidance.h"
#include "glint/train/transparency_prior.h"

namespace glint {

struct TransmissionLossConfig {
  std::string guidance = "paper";
  float lambda_transparency = 0.1f;
  float depth_threshold = 0.01f, low_albedo = 0.05f, transparent_weight = 1;
  float lambda_direct = 0, lambda_plausible = 0, lambda_transparency_prior = 0;
  // First published iterations.
  int transparency_from = 7000, plausible_from = 5000, transparency_prior_from = 7000;
  // The prior on t by the labels of guidance, and from when to when it changes to one of surfels
  // (masked_transparency.h).
  bool masked_transparency_prior = false;
  int transparency_prior_late_from = 21000, transparency_prior_late_until = 31000;
  // On the set seen from the camera on its own, as on the interface.
  bool direct_lpips = false;
  float lambda_direct_consistency = 0;
  bool direct_near_consistency = true, direct_cosine_consistency = false;

  template <class V>
  void visit(V&& v) {
    v("guidance", guidance, "of t: paper (L1 to one mask) or release (cross-entropy to two)");
    v("lambda_transparency", lambda_transparency, "weight of transparency guidance");
    v("depth_threshold", depth_threshold, "tau_d: metres between the layers at glass");
    v("low_albedo", low_albedo, "gamma_a: albedo of glass lies below");
    v("transparent_weight", transparent_weight, "of labels that say glass, beside 1 (paper)");
    v("lambda_direct", lambda_direct, "photometric loss of the transmission set on its own");
    v("lambda_direct_consistency", lambda_direct_consistency, "its normal consistency");
    v("lambda_plausible", lambda_plausible, "ties transmission to the interface where opaque");
    v("lambda_transparency_prior", lambda_transparency_prior, "entropy, mean, smoothness of t");
    v("transparency_from", transparency_from, "first published iteration of guidance");
  }
  // The priors that guidance looks at (Method::inputs).
  void add_inputs(std::vector<std::string>& inputs) const;
  template <class F>
  void scale(F&& scaled) {
    for (int* window :
         {&transparency_from,
          &plausible_from,
          &transparency_prior_from,
          &transparency_prior_late_from,
          &transparency_prior_late_until})
      *window = scaled(*window);
  }
  // Errors (kUsage): an unknown kind of guidance, a negative weight of labels. `method` opens them.
  void check(const std::string& method) const;
  // Whether a loss on the set's own picture is on.
  bool has_direct() const { return lambda_direct > 0 || lambda_direct_consistency > 0; }
};

class TransmissionLosses {
 public:
  // `config` with windows of this run. Errors: those of its check(). Guidance is off at views that
  // lack a prior it needs; returns a warning where training views do.
  std::vector<std::string> set_up(
      const TransmissionLossConfig& config, const Scene& scene, const std::string& method
  );
  // LPIPS of the interface's pictures, for those of the set on its own if the config wants it;
  // `loss` may be null, else it outlives this.
  void use_perceptual(PerceptualLoss* loss, const PerceptualConfig& config);
  // [H][W][1] 1: pixels of the next add() of which the set on its own says nothing; null: none. It
  // must stay until then.
  void leave_out(const Image* pixels) { left_out_ = pixels; }
  // [H][W][3] what the set on its own is held to in the next add(), in the photo's place; it must
  // stay until then.
  void look_at(const Image& photo) { photo_ = &photo; }
  // Whether its picture is no error where the photo is white and it is brighter.
  void clip_at_white(bool clips) { clips_at_white_ = clips; }
  // Adds the gradient of the entropy of the surfels' t, the last stretch of the masked prior.
  void add_surfel_entropy(
      int iteration,
      std::size_t channel,
      const RasterOutput& output,
      TrainableSet& interface,
      StepStats& stats
  ) const;
  // Rasterises `transmission` where a loss needs it, and adds the gradient of its parameters and of
  // the transparency map. `interface` and `buffer` are constants. behind: the pass that has just
  // rasterised `transmission` behind the interface for this view, which then shares its work; null:
  // none has.
  void add(
      const View& view,
      int iteration,
      int sh_degree,
      PhotometricWeights weights,
      const RasterOutput& interface,
      const GlassBuffer& buffer,
      TrainableSet& transmission,
      RasterPass* behind,
      Image& dL_dtransparency,
      StepStats& stats
  );

 private:
  bool has_transparency_prior(int iteration) const {
    return config_.lambda_transparency_prior > 0 && iteration >= config_.transparency_prior_from;
  }
  MaskedTransparencyRamp ramp(int iteration) const;
  void add_transparency_prior(
      const View& view, int iteration, const Image& transparency, Image& dL_dt, StepStats& stats
  );
  // Whether the view has the priors that labels are made from.
  bool has_cues(const View& view) const;
  TransparencyCues cues(const View& view, const RasterOutput& interface, const GlassBuffer& buffer);
  BorrowedImage needed_depths(const View& view, bool only_labels);
  Photo direct_photo(const View& view);
  void add_direct(
      const View& view,
      int iteration,
      PhotometricWeights weights,
      const GlassBuffer& buffer,
      TrainableSet& transmission,
      StepStats& stats
  );
  void add_direct_geometry(
      const View& view, int iteration, const RasterOutput& out, StepStats& stats
  );
  void add_plausible(
      const View& view, const RasterOutput& out, const GlassBuffer& buffer, StepStats& stats
  );

  TransmissionLossConfig config_;
  TransparencyGuidance guidance_;
  TransparencyPriorLoss transparency_prior_;
  MaskedTransparencyLoss masked_prior_;
  PhotometricLoss photometric_;
  WhiteClip white_;
  bool clips_at_white_ = false;
  PerceptualLoss* perceptual_ = nullptr;
  PerceptualConfig perceptual_config_;
  GeometryLosses direct_geometry_;
  DepthPriorLoss depth_;
  NormalPriorLoss normal_;
  RasterPass pass_;
  RasterOutputGradient dL_ddirect_;
  Image direct_color_, dL_dcolor_;  // [H][W][3]
  const Image *left_out_ = nullptr, *photo_ = nullptr;
  Image direct_counted_;  // [H][W][1] the view's, less what is left out
  TransparencyMasks masks_;
  Image direct_depth_, cosine_, dL_ddepth_, needed_, plausible_;
};

}  // namespace glint

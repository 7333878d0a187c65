// SPDX-License-Identifier: MIT
#include "glint/train/transmission_losses.h"

#include <algorithm>

#include <fmt/format.h>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/map_kernels.h"
#include "glint/render/map_ops.h"
#include "glint/train/check_fits.h"
#include "glint/train/counted_kernels.h"
#include "glint/train/glass_masks.h"
#include "glint/train/plane_mirrors_kernels.h"

namespace glint {

namespace {

// A mask of one channel, 0 where a depth map has none.
void keep_with_depth(const Image& depth, Image& mask) {
  check_fits("depth prior", depth, mask.size(), 1);
  run_kernel(mask.num_pixels(), 4096, KeepCounted{depth.on_device(), mask.on_device()});
}

// Adds the terms of some losses under names of their own.
void add_terms(const std::string& prefix, const StepStats& from, StepStats& to) {
  for (const auto& [name, value] : from.terms) to.terms[prefix + name] = value;
}

GeometryLossConfig direct_geometry(const TransmissionLossConfig& config) {
  GeometryLossConfig geometry;
  geometry.lambda_consistency = config.lambda_direct_consistency;
  geometry.near_consistency = config.direct_near_consistency;
  geometry.cosine_consistency = config.direct_cosine_consistency;
  return geometry;
}

// Masks say how much of the glass has labels that draw t down: too much of it, and t is lost.
void warn_of_bright_glass(
    const TransparencyGuidance& guidance,
    const Scene& scene,
    const std::string& method,
    std::vector<std::string>& warnings
) {
  const auto dark = dark_share_of_glass(scene.train, guidance.low_albedo);
  if (!dark || *dark > guidance.share_needed()) return;
  warnings.push_back(fmt::format(
      "{}: only {:.0f} % of what the masks call glass has an albedo below {} (low_albedo), and "
      "L_trans lets surfaces be transparent where more than {:.0f} % of their labels do: expect t "
      "to be lost; {}",
      method,
      100 * *dark,
      guidance.low_albedo,
      100 * guidance.share_needed(),
      guidance.transparent_weight < 4
          ? "transparent_weight=4 (glint/robust) asks for a fifth"
          : "a larger transparent_weight asks for fewer, a larger low_albedo finds more"
  ));
}

}  // namespace

void TransmissionLossConfig::add_inputs(std::vector<std::string>& inputs) const {
  if (lambda_transparency <= 0) return;
  inputs.push_back(prior_input("albedo"));
  if (guidance == "release") inputs.push_back(prior_input("basecolor"));
}

void TransmissionLossConfig::check(const std::string& method) const {
  GLINT_CHECK(
      guidance == "paper" || guidance == "release",
      kUsage,
      "{}: guidance is '{}', expected paper or release",
      method,
      guidance
  );
  GLINT_CHECK(
      transparent_weight >= 0,
      kUsage,
      "{}: transparent_weight is {}, expected at least 0",
      method,
      transparent_weight
  );
}

std::vector<std::string> TransmissionLosses::set_up(
    const TransmissionLossConfig& config, const Scene& scene, const std::string& method
) {
  config.check(method);
  config_ = config;
  const bool release = config.guidance == "release";
  guidance_ = release ? TransparencyGuidance::release() : TransparencyGuidance::paper();
  guidance_.depth_threshold = config.depth_threshold;
  guidance_.low_albedo = config.low_albedo;
  guidance_.transparent_weight = config.transparent_weight;
  depth_.gradient_scales = 4;                                       // of plausibility
  normal_.weighted_mean = true;                                     // as well
  direct_geometry_.set_up(direct_geometry(config), scene, method);  // needs no prior
  std::vector<std::string> warnings;
  float& weight = config_.lambda_transparency;
  require_prior(scene, "albedo", "L_trans", method, weight, warnings);
  if (release) require_prior(scene, "basecolor", "L_trans", method, weight, warnings);
  if (!release && weight > 0) warn_of_bright_glass(guidance_, scene, method, warnings);
  return warnings;
}

void TransmissionLosses::use_perceptual(PerceptualLoss* loss, const PerceptualConfig& config) {
  perceptual_ = config_.direct_lpips ? loss : nullptr;
  perceptual_config_ = config;
}

bool TransmissionLosses::has_cues(const View& view) const {
  const bool needs_basecolor = guidance_.kind == GuidanceKind::kBce;
  return view.priors.has("albedo") && (!needs_basecolor || view.priors.has("basecolor"));
}

TransparencyCues TransmissionLosses::cues(
    const View& view, const RasterOutput& interface, const GlassBuffer& buffer
) {
  TransparencyCues cues;
  cues.interface_depth = buffer.depth;
  cues.transmission_depth = direct_depth_;
  cues.albedo = view.priors["albedo"];
  cues.counted = view.counted;
  if (guidance_.kind == GuidanceKind::kL1) return cues;
  cues.basecolor = view.priors["basecolor"];
  cosine_ = viewing_cosines(view.camera, interface.normal);
  cues.cosine = cosine_;
  return cues;
}

// Of the set on its own, where nothing but labels looks at it. A GPU makes all of them anyway.
BorrowedImage TransmissionLosses::needed_depths(const View& view, bool only_labels) {
  if (!only_labels || on_gpu()) return {};
  guidance_.mark_needed_depths(view.priors["albedo"], needed_);
  return needed_;
}

// The release's plausibility: on pixels labelled opaque that have a depth prior, the set seen on
// its own is the interface. Half of the depth loss with its gradient term, and the mean of the
// normals' over these pixels.
void TransmissionLosses::add_plausible(
    const View& view, const RasterOutput& out, const GlassBuffer& buffer, StepStats& stats
) {
  const bool eroded = guidance_.kind == GuidanceKind::kBce;
  if (masks_.opaque.empty()) return;
  plausible_ = eroded ? masks_.labelled_opaque : masks_.opaque;
  if (view.priors.has("depth")) keep_with_depth(view.priors["depth"], plausible_);
  const Image& mask = plausible_;
  const float weight = config_.lambda_plausible;
  clear_image(dL_ddepth_, out.alpha.size(), 1);
  const double of_depth =
      depth_.evaluate(direct_depth_, buffer.depth, mask, 0.5f * weight, dL_ddepth_);
  const double of_normal =
      normal_.evaluate(out.normal, view.priors["normal"], mask, weight, dL_ddirect_.normal);
  expected_depth_map_vjp(out, dL_ddepth_, dL_ddirect_);
  stats.terms["plausible"] = static_cast<double>(weight) * (0.5 * of_depth + of_normal);
}

// As on the interface, with terms of their own names.
void TransmissionLosses::add_direct_geometry(
    const View& view, int iteration, const RasterOutput& out, StepStats& stats
) {
  StepStats terms;
  add_perceptual(
      perceptual_, perceptual_config_, iteration, direct_color_, view, dL_dcolor_, terms
  );
  direct_geometry_.add(view, iteration, out, direct_depth_, dL_ddirect_, terms);
  add_terms("direct ", terms, stats);
}

Photo TransmissionLosses::direct_photo(const View& view) {
  const Image& photo = photo_ != nullptr ? *photo_ : view.rgb;
  if (left_out_ == nullptr) return {photo, view.counted};
  fit(direct_counted_, view.camera.size(), 1);
  run_kernel(
      direct_counted_.num_pixels(),
      4096,
      CountOutsideMirror{
          view.counted.on_device(), left_out_->on_device(), direct_counted_.on_device()}
  );
  return {photo, direct_counted_};
}

void TransmissionLosses::add_direct(
    const View& view,
    int iteration,
    PhotometricWeights weights,
    const GlassBuffer& buffer,
    TrainableSet& transmission,
    StepStats& stats
) {
  const bool plausible = config_.lambda_plausible > 0 && iteration >= config_.plausible_from;
  if (!config_.has_direct() && !plausible) return;
  const RasterOutput& out = pass_.rasterizer.output();
  clear_gradient(view.camera.size(), out.features.channels(), dL_ddirect_);
  clear_image(dL_dcolor_, view.camera.size(), 3);
  copy_color(out.features, direct_color_);
  if (config_.lambda_direct > 0) {
    const PhotometricWeights direct{
        config_.lambda_direct * weights.l1, config_.lambda_direct * weights.ssim};
    const Photo photo = direct_photo(view);
    const PhotometricTerms terms = photometric_.evaluate(
        clips_at_white_ ? white_.clip(direct_color_, view.rgb, photo.rgb) : direct_color_,
        photo,
        direct,
        dL_dcolor_
    );
    if (clips_at_white_) white_.vjp(direct_color_, view.rgb, photo.rgb, dL_dcolor_);
    stats.terms["direct"] = terms.weighted(direct);
  }
  add_direct_geometry(view, iteration, out, stats);
  if (plausible) add_plausible(view, out, buffer, stats);
  add_color(dL_dcolor_, dL_ddirect_.features);
  transmission.backward(dL_ddirect_, pass_);
}

void TransmissionLosses::add(
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
) {
  const bool guided =
      config_.lambda_transparency > 0 && iteration >= config_.transparency_from && has_cues(view);
  const bool plausible = config_.lambda_plausible > 0 && iteration >= config_.plausible_from;
  const bool labelled =
      guided || plausible ||
      (config_.masked_transparency_prior && has_transparency_prior(iteration) && has_cues(view));
  if (!labelled) masks_ = {};
  if (labelled || config_.has_direct()) {
    const bool only_labels = !plausible && !config_.has_direct();
    const RasterOutput& direct =
        behind != nullptr
            ? transmission.forward_again(pass_, *behind, {}, needed_depths(view, only_labels))
            : transmission.forward(pass_, view.camera, sh_degree);
    expected_depth_map(direct, direct_depth_);
    if (labelled) guidance_.label(cues(view, interface, buffer), masks_);
    add_direct(view, iteration, weights, buffer, transmission, stats);
  }
  if (guided)
    stats.terms["transparency"] =
        static_cast<double>(config_.lambda_transparency) *
        guidance_.evaluate(
            buffer.transparency, masks_, config_.lambda_transparency, dL_dtransparency
        );
  if (has_transparency_prior(iteration))
    add_transparency_prior(view, iteration, buffer.transparency, dL_dtransparency, stats);
}

MaskedTransparencyRamp TransmissionLosses::ramp(int iteration) const {
  const int from = config_.transparency_prior_late_from;
  const int length = std::max(1, config_.transparency_prior_late_until - from);
  const float late = static_cast<float>(iteration - from) / static_cast<float>(length);
  return {std::clamp(late, 0.0f, 1.0f)};
}

void TransmissionLosses::add_transparency_prior(
    const View& view, int iteration, const Image& transparency, Image& dL_dt, StepStats& stats
) {
  const float weight = config_.lambda_transparency_prior;
  const double loss =
      config_.masked_transparency_prior
          ? masked_prior_.evaluate(transparency, masks_, view.rgb, ramp(iteration), weight, dL_dt)
          : transparency_prior_.evaluate(transparency, view.rgb, weight, dL_dt);
  stats.terms["transparency prior"] = static_cast<double>(weight) * loss;
}

void TransmissionLosses::add_surfel_entropy(
    int iteration,
    std::size_t channel,
    const RasterOutput& output,
    TrainableSet& interface,
    StepStats& stats
) const {
  const float late = ramp(iteration).late;
  if (!config_.masked_transparency_prior || !has_transparency_prior(iteration) || late <= 0) return;
  const float weight = config_.lambda_transparency_prior * late;
  stats.terms["surfel entropy"] =
      static_cast<double>(weight) * interface.penalise_entropy(weight, channel, output.visibility);
}

}  // namespace glint

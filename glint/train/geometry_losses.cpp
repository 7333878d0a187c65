// SPDX-License-Identifier: MIT
#include "glint/train/geometry_losses.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "glint/render/map_ops.h"
#include "glint/train/trainer.h"

namespace glint {

std::string prior_input(MapId prior) { return std::string(prior.row().id) + " prior"; }

void GeometryLossConfig::add_inputs(std::vector<std::string>& inputs) const {
  if (lambda_depth > 0) inputs.push_back(prior_input("depth"));
  if (lambda_normal > 0) inputs.push_back(prior_input("normal"));
}

void require_prior(
    const Scene& scene,
    MapId prior,
    const char* loss_name,
    const std::string& method,
    float& weight,
    std::vector<std::string>& warnings
) {
  const auto lacks = [&](const View& view) { return !view.priors.has(prior); };
  const auto missing = std::count_if(scene.train.begin(), scene.train.end(), lacks);
  if (weight == 0 || missing == 0) return;
  const bool all = missing == std::ssize(scene.train);
  if (all) weight = 0;
  warnings.push_back(fmt::format(
      "{}: {} has no {} prior for {} of {} training views; {} is off{}",
      method,
      scene.name,
      prior.row().id,
      missing,
      scene.train.size(),
      loss_name,
      all ? "" : " there"
  ));
}

void GeometryLossConfig::use_priors(int published_iterations) {
  const auto scaled = [&](int step) {
    return scaled_step(step, published_iterations, 1, PriorLosses::kIterations);
  };
  lambda_depth = PriorLosses::kLambdaDepth;
  lambda_normal = PriorLosses::kLambdaNormal;
  min_cosine = PriorLosses::kMinCosine;
  gate_from = scaled(PriorLosses::kGateFrom);
  lambda_smooth = PriorLosses::kLambdaSmooth;
  smooth_from = scaled(PriorLosses::kSmoothFrom);
  normal_l1 = 0;
  near_first = false;
}

std::vector<std::string> GeometryLosses::set_up(
    const GeometryLossConfig& config, const Scene& scene, const std::string& method
) {
  config_ = config;
  depth_prior_.gradient_scales = config.depth_gradient_scales;
  normal_prior_.l1 = config.normal_l1;
  normal_prior_.weighted_mean = config.weighted_normals;
  consistency_.unit_normals = config.unit_consistency;
  consistency_.cosine = config.cosine_consistency;
  std::vector<std::string> warnings;
  require_prior(scene, "depth", "L_depth", method, config_.lambda_depth, warnings);
  require_prior(scene, "normal", "L_normal", method, config_.lambda_normal, warnings);
  return warnings;
}

void GeometryLosses::add_depth_prior(
    const View& view, const Image& depth, Image& dL_ddepth, StepStats& stats
) {
  const float weight = config_.lambda_depth;
  if (weight <= 0 || !view.priors.has("depth")) return;
  stats.terms["depth"] = static_cast<double>(weight) *
                         depth_prior_.evaluate(depth, view.priors["depth"], {}, weight, dL_ddepth);
}

void GeometryLosses::add_normal_prior(
    const View& view,
    int iteration,
    const RasterOutput& output,
    const Image& depth,
    Image& dL_dnormal,
    StepStats& stats
) {
  const float weight = config_.lambda_normal;
  if (weight <= 0 || !view.priors.has("normal")) return;
  normal_prior_.min_cosine =
      iteration >= config_.gate_from ? config_.min_cosine : NormalPriorLoss::kNoGate;
  const Image pixel_weight = config_.near_first ? inverse_depth_weight(depth) : Image{};
  stats.terms["normal"] = static_cast<double>(weight) *
                          normal_prior_.evaluate(
                              output.normal, view.priors["normal"], pixel_weight, weight, dL_dnormal
                          );
}

void GeometryLosses::add_consistency(
    const View& view,
    int iteration,
    const RasterOutput& output,
    const Image& depth,
    Image& dL_dnormal,
    Image& dL_ddepth,
    StepStats& stats
) {
  const float weight = config_.lambda_consistency;
  if (!consistent_at(iteration)) return;
  const Image pixel_weight = config_.near_consistency ? inverse_depth_weight(depth) : Image{};
  const double loss = consistency_.evaluate(
      view.camera, output.normal, depth, output.alpha, weight, dL_dnormal, dL_ddepth, pixel_weight
  );
  stats.terms["consistency"] = static_cast<double>(weight) * loss;
}

void GeometryLosses::add_smoothness(
    const View& view, int iteration, const RasterOutput& output, Image& dL_dnormal, StepStats& stats
) {
  const float weight = config_.lambda_smooth;
  if (!smooth_at(iteration)) return;
  stats.terms["smooth"] = static_cast<double>(weight) *
                          smoothness_.evaluate(output.normal, view.rgb, weight, dL_dnormal);
}

void GeometryLosses::add(
    const View& view,
    int iteration,
    const RasterOutput& output,
    const Image& depth,
    RasterOutputGradient& dL_doutput,
    StepStats& stats,
    LossDepth kind
) {
  const bool expected = kind == LossDepth::kExpected;
  Image& dL_ddepth = expected ? dL_ddepth_ : dL_doutput.depth_median;
  clear_image(dL_ddepth, depth.size(), 1);
  add_depth_prior(view, depth, dL_ddepth, stats);
  add_normal_prior(view, iteration, output, depth, dL_doutput.normal, stats);
  add_consistency(view, iteration, output, depth, dL_doutput.normal, dL_ddepth, stats);
  add_smoothness(view, iteration, output, dL_doutput.normal, stats);
  if (expected) expected_depth_map_vjp(output, dL_ddepth_, dL_doutput);
}

}  // namespace glint

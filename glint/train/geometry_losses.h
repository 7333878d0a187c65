// SPDX-License-Identifier: MIT
// Losses on the depth and normal maps of one rasterised set, each with its weight and the iteration
// from which it counts: depth and normal priors, normal consistency, smoothness of normals. Shared,
// so that a method and the control with the same priors differ in nothing else.
#pragma once

#include <string>
#include <vector>

#include "glint/method.h"
#include "glint/render/rasterize.h"
#include "glint/train/depth_prior.h"
#include "glint/train/normal_consistency.h"
#include "glint/train/normal_prior.h"
#include "glint/train/normal_smoothness.h"

namespace glint {

struct GeometryLossConfig {
  float lambda_depth = 0, lambda_normal = 0, lambda_consistency = 0, lambda_smooth = 0;
  int consistency_from = 0;
  int gate_from = 10000, smooth_from = 0;  // first published iteration: of the normal prior's gate
  float min_cosine = 0.3f;
  float normal_l1 = 0;              // |n - prior|_1 beside 1 - cosine in the normal prior
  bool near_first = false;          // the normal prior weighs near pixels more
  bool weighted_normals = false;    // its mean divides by its weights
  int depth_gradient_scales = 0;    // of the depth prior's gradient term
  bool near_consistency = false;    // weighs near pixels more
  bool unit_consistency = false;    // of unit normals
  bool cosine_consistency = false;  // the weighted mean of 1 - cosine, without alpha

  template <class V>
  void visit(V&& v) {
    v("lambda_depth", lambda_depth, "weight of the depth prior");
    v("lambda_normal", lambda_normal, "weight of the normal prior");
    v("lambda_consistency", lambda_consistency, "weight of normal consistency");
    v("lambda_smooth", lambda_smooth, "weight of edge-aware normal smoothness");
    v("consistency_from", consistency_from, "first published iteration of normal consistency");
    v("min_cosine", min_cosine, "tau_n: the gate of the normal prior");
  }
  // The priors that these weights look at (Method::inputs).
  void add_inputs(std::vector<std::string>& inputs) const;
  // Gives a baseline of so many published iterations the priors and the smoothness of GLINT: same
  // losses, weights and gate, at the same share of the run.
  void use_priors(int published_iterations);
  // Published windows to this run's iterations.
  template <class F>
  void scale(F&& scaled) {
    for (int* window : {&consistency_from, &gate_from, &smooth_from})
      *window = *window > 0 ? scaled(*window) : 0;
  }
};

// Depth and normal priors and the smoothness of normals as [Na26 Sec. 3.4, 4.1] uses them, and
// as GeometryLossConfig::use_priors() gives them to others. Weights and starts that the paper does
// not give: docs/design/glint.md, "What the paper leaves open".
struct PriorLosses {
  static constexpr float kLambdaDepth = 0.05f, kLambdaNormal = 0.3f, kMinCosine = 0.3f;
  static constexpr float kLambdaSmooth = 0.05f / 3;  // there a mean over three components
  static constexpr int kGateFrom = 10000, kSmoothFrom = 5000, kIterations = 60000;
};

// Which depth of a rasterised set its losses look at: expected (depth_ratio 0 of [Huang24]) or
// median (1), where the transmittance falls below one half.
enum class LossDepth { kExpected, kMedian };

// "depth prior", as Method::inputs() names it.
std::string prior_input(MapId prior);

class GeometryLosses {
 public:
  // `config` with windows of this run. A loss is off at views that lack its prior; returns a
  // warning for each prior that a training view lacks.
  std::vector<std::string> set_up(
      const GeometryLossConfig& config, const Scene& scene, const std::string& method
  );
  // Whether any of them looks at the surface in this iteration.
  bool any_at(int iteration) const {
    return config_.lambda_depth > 0 || config_.lambda_normal > 0 || consistent_at(iteration) ||
           smooth_at(iteration);
  }
  // depth: expected_depth_map() of `output`, or its depth_median. Adds the gradients of the normal
  // image and of those that the depth is made of to dL_doutput, and each weighted loss to
  // stats.terms.
  void add(
      const View& view,
      int iteration,
      const RasterOutput& output,
      const Image& depth,
      RasterOutputGradient& dL_doutput,
      StepStats& stats,
      LossDepth kind = LossDepth::kExpected
  );

 private:
  bool consistent_at(int iteration) const {
    return config_.lambda_consistency > 0 && iteration >= config_.consistency_from;
  }
  bool smooth_at(int iteration) const {
    return config_.lambda_smooth > 0 && iteration >= config_.smooth_from;
  }
  void add_depth_prior(const View& view, const Image& depth, Image& dL_ddepth, StepStats& stats);
  void add_normal_prior(
      const View& view,
      int iteration,
      const RasterOutput& output,
      const Image& depth,
      Image& dL_dnormal,
      StepStats& stats
  );
  void add_consistency(
      const View& view,
      int iteration,
      const RasterOutput& output,
      const Image& depth,
      Image& dL_dnormal,
      Image& dL_ddepth,
      StepStats& stats
  );
  void add_smoothness(
      const View& view,
      int iteration,
      const RasterOutput& output,
      Image& dL_dnormal,
      StepStats& stats
  );

  GeometryLossConfig config_;
  DepthPriorLoss depth_prior_;
  NormalPriorLoss normal_prior_;
  NormalConsistencyLoss consistency_;
  NormalSmoothnessLoss smoothness_;
  Image dL_ddepth_;
};

// Warns where `weight` is not 0 and training views lack the prior; sets it to 0 where all do.
void require_prior(
    const Scene& scene,
    MapId prior,
    const char* loss_name,
    const std::string& method,
    float& weight,
    std::vector<std::string>& warnings
);

}  // namespace glint

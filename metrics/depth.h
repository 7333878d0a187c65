// SPDX-License-Identifier: MIT
// Errors of depth maps: planar z in metres, [H][W][1].
#pragma once

#include <cstddef>
#include <optional>

#include "glint/core/config.h"
#include "glint/core/image.h"

namespace glint {

// How a prediction is fitted to the reference before it is compared, per view. Posed
// reconstructions are metric: kNone.
enum class DepthAlignment {
  kNone,
  kMedian,  // times median(reference) / median(prediction)
  kScale,   // least squares, scale
  kAffine,  // least squares, scale and shift
};
NLOHMANN_JSON_SERIALIZE_ENUM(
    DepthAlignment,
    {{DepthAlignment::kNone, "none"},
     {DepthAlignment::kMedian, "median"},
     {DepthAlignment::kScale, "scale"},
     {DepthAlignment::kAffine, "affine"}}
)

struct DepthProtocol {
  DepthAlignment alignment = DepthAlignment::kNone;
  // A pixel without prediction counts with an error of the whole depth and as wrong in delta;
  // otherwise it is skipped, which rewards holes.
  bool missing_counts = true;
  double min_depth = 1e-6;  // metres; at or below: no depth
  double max_depth = 0;     // metres; at or beyond: no depth, in either map. 0: no limit
  bool rmse_over_mean_depth = false;
  double delta_threshold = 1.25;
  template <class V>
  void visit(V&& v) {
    v("alignment", alignment, "none, median, scale or affine; per view");
    v("missing_counts", missing_counts, "pixels without prediction count as wrong");
    v("min_depth", min_depth, "metres; at or below: no depth");
    v("max_depth", max_depth, "metres; at or beyond: no depth; 0: no limit");
    v("rmse_over_mean_depth", rmse_over_mean_depth, "RMSE divided by the mean reference depth");
    v("delta_threshold", delta_threshold, "max(p/r, r/p) strictly below");
  }
};

// The official release: median scale, both maps below 20 m, pixels without prediction skipped.
DepthProtocol release_depth_protocol();

struct DepthFit {  // aligned = scale * prediction + shift
  double scale = 1, shift = 0;
};

struct DepthErrors {
  double absrel = 0;           // mean |p - r| / r
  double rmse = 0;             // metres, or relative (rmse_over_mean_depth)
  double delta1 = 0;           // percent
  double coverage = 0;         // percent of the reference's pixels that have a prediction
  std::size_t num_pixels = 0;  // that the means are over
  DepthFit fit;
};

// Over the pixels of the mask where both maps have a depth; identity without any. An affine fit of
// a constant prediction is the mean of the reference.
DepthFit fit_depth(
    ImageView prediction, ImageView reference, MaskView mask, const DepthProtocol& protocol
);

// Empty when no pixel counts. Errors: kBadPrediction (size, channels), kBadReference.
std::optional<DepthErrors> depth_errors(
    ImageView prediction,
    ImageView reference,
    MaskView mask,
    const DepthProtocol& protocol,
    const DepthFit& fit
);
// With the fit over the same pixels.
std::optional<DepthErrors> depth_errors(
    ImageView prediction,
    ImageView reference,
    MaskView mask = {},
    const DepthProtocol& protocol = {}
);

}  // namespace glint

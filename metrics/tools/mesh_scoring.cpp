// SPDX-License-Identifier: MIT
#include "metrics/tools/mesh_scoring.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"

namespace glint {
namespace {

constexpr int kCurvePoints = 100;  // equal steps up to the largest threshold

std::vector<double> curve_thresholds(double last) {
  std::vector<double> thresholds;
  for (int i = 1; i <= kCurvePoints; ++i) thresholds.push_back(last * i / kCurvePoints);
  return thresholds;
}

// Before anything is drawn.
void check_samples(std::size_t num_samples) {
  const double needed = kBytesPerMeshSample * static_cast<double>(num_samples);
  const auto available = static_cast<double>(available_memory_bytes());
  if (needed > available)
    throw OutOfMemory(fmt::format(
        "--samples {} needs about {:.1f} GB, {:.1f} GB are free; use fewer",
        num_samples,
        needed / 1e9,
        available / 1e9
    ));
}

}  // namespace

void cull_surfaces(MeshReport& report, const std::vector<Camera>& cameras) {
  cull_surface(report.reference, cameras, report.protocol);
  with_exit_code(ExitCode::kBadPrediction, [&] {
    cull_surface(report.prediction, cameras, report.protocol);
  });
}

void score_surfaces(MeshReport& report) {
  check_samples(report.protocol.num_samples);
  const Surface &prediction = report.prediction.surface, &reference = report.reference.surface;
  log::info(fmt::format("measuring {} samples of either surface", report.protocol.num_samples));
  const SurfaceDistances distances = surface_distances(prediction, reference, report.protocol);
  report.scores = mesh_scores(distances, report.protocol);
  const auto& thresholds = report.protocol.thresholds_m;
  report.curve = f1_curve(
      distances, curve_thresholds(*std::max_element(thresholds.begin(), thresholds.end()))
  );
}

}  // namespace glint

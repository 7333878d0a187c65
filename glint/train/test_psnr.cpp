// SPDX-License-Identifier: MIT
#include "glint/train/test_psnr.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "metrics/psnr.h"

namespace glint {

namespace {

// Each from the middle of its share of the views.
std::vector<const View*> spread_out(const std::vector<View>& views) {
  const std::size_t count = std::min(views.size(), kMostTestPsnrViews);
  std::vector<const View*> chosen;
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(&views[(2 * i + 1) * views.size() / (2 * count)]);
  return chosen;
}

double psnr_of(Method& method, const View& view) {
  const MapSet maps = method.render_view(view);
  const MaskImage counted = mask_of_map(view.counted);
  try {
    return psnr(maps["rgb"], view.rgb, counted.empty() ? MaskView() : counted);
  } catch (const Error& error) {
    if (error.code() != ExitCode::kBadPrediction) throw;
    return std::nan("");
  }
}

}  // namespace

TestPsnr::TestPsnr(const Scene& scene, int every) : views_(spread_out(scene.test)), every_(every) {}

bool TestPsnr::is_due(int iteration, int iterations) const {
  if (every_ <= 0 || views_.empty()) return false;
  return (iteration + 1) % every_ == 0 || iteration + 1 == iterations;
}

double TestPsnr::measure(Method& method) const {
  double sum = 0;
  for (const View* view : views_) sum += psnr_of(method, *view);
  return sum / static_cast<double>(views_.size());
}

}  // namespace glint

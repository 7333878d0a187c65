// SPDX-License-Identifier: MIT
// The worked example of docs/guide/your_metric.md, which has the lines between the marks word for
// word.
#include <catch2/catch.hpp>

#include "glint/core/files.h"

// example: begin
#include <cmath>

#include "metrics/metric.h"

namespace glint {
namespace {

// Mean of abs(p - r) over the pixels that count and the channels; empty without such a pixel.
std::optional<double> mean_error(ImageView p, ImageView r, MaskView mask) {
  double sum = 0, count = 0;
  for (int y = 0; y < r.height; ++y)
    for (int x = 0; x < r.width; ++x)
      for (int c = 0; counts(mask, x, y) && c < r.channels; ++c, ++count)
        sum += std::abs(static_cast<double>(p.at(x, y, c) - r.at(x, y, c)));
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

MetricFamily rgb_l1() {
  MetricFamily family;
  family.metrics = {{"rgb-l1", "", Direction::kLowerIsBetter, 4, {{"range", 1}}}};
  family.evaluate = [](const ViewPair& pair, std::span<const Region> regions) {
    std::vector<MetricValues> rows;  // one a region, a value per metric
    for (const Region& region : regions)
      rows.push_back({mean_error(pair.rendered["rgb"], pair.truth["rgb"], region.mask)});
    return rows;
  };
  return family;
}

}  // namespace
GLINT_REGISTER(MetricFamily, rgb_l1())
}  // namespace glint
// example: end

using namespace glint;

TEST_CASE("a metric is a file that registers it: it has a value for each region") {
  Image render(4, 2, 3, 0.25f), truth(4, 2, 3, 0.5f);
  for (int c = 0; c < 3; ++c) render.at(0, 0, c) = 1.0f;
  MaskImage glass(4, 2, 1);
  glass.at(0, 0) = 255;
  ViewPair pair;
  pair.rendered["rgb"] = render, pair.truth["rgb"] = truth;
  pair.glass = glass;
  const auto values = evaluate_view(pair);
  CHECK(values.at("rgb-l1") == Approx((0.5 + 7 * 0.25) / 8));
  CHECK(values.at("rgb-l1@glass") == Approx(0.5));
  CHECK(values.at("rgb-l1@opaque") == Approx(0.25));
  CHECK(find_metric("rgb-l1")->direction == Direction::kLowerIsBetter);
}

TEST_CASE("docs/guide/your_metric.md has the example as it is compiled") {
  const std::string source = read_file("tests/metrics/adding_a_metric_test.cpp");
  const std::string begin = "// example: begin\n", end = "// example: end";
  const std::size_t from = source.find(begin) + begin.size();
  const std::string example = source.substr(from, source.find(end) - from);
  CHECK(read_file("docs/guide/your_metric.md").find(example) != std::string::npos);
}

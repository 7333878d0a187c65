// SPDX-License-Identifier: MIT
#include "metrics/metric.h"

#include <catch2/catch.hpp>

#include <set>

#include "metrics/depth.h"
#include "metrics/normal.h"
#include "metrics/psnr.h"
#include "metrics/ssim.h"
#include "tests/metrics/golden_images.h"

using namespace glint;

namespace {

constexpr int kWidth = 40, kHeight = 30;

// Maps of one view; glass is the square [10, 20) x [10, 20).
struct Maps {
  Image rgb = golden::rendered_image(kWidth, kHeight, 3);
  Image true_rgb = golden::reference_image(kWidth, kHeight, 3);
  Image depth = golden::predicted_depth_map(kWidth, kHeight);
  Image true_depth = golden::true_depth_map(kWidth, kHeight);
  Image normal = golden::predicted_normal_map(kWidth, kHeight);
  Image true_normal = golden::true_normal_map(kWidth, kHeight);
  Image transparency = Image(kWidth, kHeight, 1, 0.75f);
  MaskImage glass = MaskImage(kWidth, kHeight, 1);

  Maps() {
    for (int y = 10; y < 20; ++y)
      for (int x = 10; x < 20; ++x) glass.at(x, y) = 255;
  }
  ViewPair pair() const {
    ViewPair pair;
    pair.rendered["rgb"] = rgb, pair.truth["rgb"] = true_rgb;
    pair.rendered["depth"] = depth, pair.truth["depth"] = true_depth;
    pair.rendered["normal"] = normal, pair.truth["normal"] = true_normal;
    pair.rendered["transparency"] = transparency;
    pair.rendered["behind_depth"] = depth, pair.truth["behind_depth"] = true_depth;
    pair.glass = glass;
    return pair;
  }
};

std::size_t count(const MaskImage& mask) {
  std::size_t n = 0;
  for (const unsigned char value : mask.values()) n += value != 0;
  return n;
}

}  // namespace

TEST_CASE("the border region reaches three pixels to either side of the glass outline") {
  const MaskImage border = glass_border_region(Maps().glass);
  CHECK(count(border) == 16 * 16 - 4 * 4);
  CHECK(border.at(7, 15) != 0);
  CHECK(border.at(6, 15) == 0);
  CHECK(border.at(12, 15) != 0);
  CHECK(border.at(13, 15) == 0);
}

TEST_CASE("the image's edge is no outline of glass") {
  const MaskImage everywhere(12, 9, 1, 255);
  CHECK(count(glass_border_region(everywhere)) == 0);
  CHECK(evaluation_regions(everywhere).size() == 2);  // the whole image and glass
}

TEST_CASE("glass and opaque regions share the image") {
  const Maps maps;
  CHECK(count(glass_region(maps.glass)) == 100);
  CHECK(count(opaque_region(maps.glass)) == kWidth * kHeight - 100);
  CHECK(evaluation_regions({}).size() == 1);
}

TEST_CASE("every metric of the protocol is registered once, with direction and protocol") {
  std::set<std::string> ids;
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics) {
      CAPTURE(metric.id);
      CHECK(ids.insert(metric.id).second);
      CHECK(metric.protocol.is_object());
      CHECK_FALSE(metric.protocol.empty());
    }
  for (const char* id :
       {"psnr",
        "psnr-8bit",
        "ssim-3dgs",
        "ssim-wang",
        "normal-mae",
        "normal-median",
        "normal-5",
        "normal-7.5",
        "normal-11.25",
        "normal-22.5",
        "normal-30",
        "depth-absrel",
        "depth-rmse",
        "depth-delta1",
        "depth-absrel-release",
        "depth-rmse-release",
        "depth-delta1-release",
        "transparency-iou",
        "transparency-mae",
        "glass-iou-best",
        "behind-absrel",
        "behind-coverage",
        "behind-absrel-expected",
        "behind-coverage-expected",
        "behind-absrel-median",
        "behind-coverage-median",
        "behind-absrel-last-mode",
        "behind-coverage-last-mode",
        "depth-absrel-first-mode",
        "depth-coverage-first-mode",
        "behind-absrel-content",
        "behind-absrel-beyond",
        "normal-mae-background",
        "trans-psnr",
        "refl-psnr",
        "layer-1-absrel",
        "layer-4-coverage",
        "layer-last-absrel",
        "layer-last-coverage",
        "layer-4-mae",
        "layer-3-t-iou",
        "order-pairs",
        "order-quadruplets",
        "path-t-psnr",
        "path-rt-psnr"})
    CHECK(ids.count(id) == 1);
  CHECK(find_metric("normal-mae@glass")->direction == Direction::kLowerIsBetter);
  CHECK(find_metric("no-such-metric") == nullptr);
}

TEST_CASE("evaluate_view gives what the functions give, for the image and each region") {
  const Maps maps;
  const auto scores = evaluate_view(maps.pair());
  CHECK(scores.at("psnr") == psnr(maps.rgb, maps.true_rgb));
  CHECK(scores.at("psnr-8bit@glass") == psnr_8bit(maps.rgb, maps.true_rgb, maps.glass));
  CHECK(scores.at("ssim-wang") == ssim_wang(maps.rgb, maps.true_rgb));
  CHECK(
      scores.at("ssim-3dgs@opaque") == ssim_3dgs(maps.rgb, maps.true_rgb, opaque_region(maps.glass))
  );
  CHECK(
      scores.at("depth-absrel@glass") ==
      depth_errors(maps.depth, maps.true_depth, maps.glass)->absrel
  );
  CHECK(
      scores.at("normal-22.5@glass-border") ==
      normal_errors(maps.normal, maps.true_normal, glass_border_region(maps.glass))->below[3]
  );
  CHECK(scores.at("behind-absrel") == scores.at("depth-absrel@glass"));
  CHECK(scores.at("transparency-iou") == Approx(100.0 / (kWidth * kHeight)));
  CHECK(scores.at("transparency-mae@glass") == 0.25);
  CHECK(scores.at("glass-iou-best") == scores.at("transparency-iou"));
  CHECK(scores.count("transparency-iou@glass") == 0);
}

TEST_CASE("a method with one layer is scored by its depth behind glass, too") {
  const Maps maps;
  ViewPair pair = maps.pair();
  const Image behind(kWidth, kHeight, 1, 3.0f);
  pair.rendered["behind_depth"] = {};
  pair.truth["behind_depth"] = behind;
  CHECK(
      evaluate_view(pair).at("behind-absrel") ==
      depth_errors(maps.depth, behind, maps.glass)->absrel
  );
}

TEST_CASE("behind glass, each estimate of depth is scored by itself, holes counted as they are") {
  const Maps maps;
  ViewPair pair = maps.pair();
  const Image behind(kWidth, kHeight, 1, 4.0f), expected(kWidth, kHeight, 1, 5.0f);
  Image median(kWidth, kHeight, 1, 4.0f);
  for (int y = 10; y < 15; ++y)
    for (int x = 10; x < 20; ++x) median.at(x, y) = 0;  // half of the glass
  pair.truth["behind_depth"] = behind;
  pair.rendered["behind_depth"] = behind;
  CHECK(evaluate_view(pair).count("behind-absrel-expected") == 0);
  pair.rendered["behind_expected"] = expected;
  pair.rendered["behind_median"] = median;
  const auto scores = evaluate_view(pair);
  CHECK(scores.at("behind-absrel") == 0);
  CHECK(scores.at("behind-coverage") == 100);
  CHECK(scores.at("behind-absrel-expected") == 0.25);
  CHECK(scores.at("behind-coverage-expected") == 100);
  CHECK(scores.at("behind-absrel-median") == 0.5);
  CHECK(scores.at("behind-coverage-median") == 50);
}

TEST_CASE("the first mode of depth is scored against the first surface, the last behind glass") {
  const Maps maps;
  ViewPair pair = maps.pair();
  const Image pane(kWidth, kHeight, 1, 2.0f), behind(kWidth, kHeight, 1, 4.0f);
  const Image last(kWidth, kHeight, 1, 5.0f);
  Image first(kWidth, kHeight, 1, 2.5f);
  for (int y = 10; y < 15; ++y)
    for (int x = 10; x < 20; ++x) first.at(x, y) = 0;  // half of the glass
  pair.truth["depth"] = pane;
  pair.truth["behind_depth"] = behind;
  CHECK(evaluate_view(pair).count("depth-absrel-first-mode") == 0);
  CHECK(evaluate_view(pair).count("behind-absrel-last-mode") == 0);
  pair.rendered["first_mode"] = first;
  pair.rendered["last_mode"] = last;
  const auto scores = evaluate_view(pair);
  CHECK(scores.at("depth-absrel-first-mode@glass") == (0.25 + 1) / 2);
  CHECK(scores.at("depth-absrel-first-mode@opaque") == 0.25);
  CHECK(scores.at("depth-coverage-first-mode@glass") == 50);
  CHECK(scores.at("behind-absrel-last-mode") == 0.25);
  CHECK(scores.at("behind-coverage-last-mode") == 100);
}

TEST_CASE("depth behind glass is scored apart within 1.25 m of the pane and beyond") {
  const Maps maps;
  ViewPair pair = maps.pair();
  Image first(kWidth, kHeight, 1, 2.0f), behind(kWidth, kHeight, 1, 3.0f);
  Image rendered(kWidth, kHeight, 1, 3.3f);
  for (int y = 10; y < 15; ++y)
    for (int x = 10; x < 20; ++x) {  // half of the glass
      behind.at(x, y) = 4;
      rendered.at(x, y) = 5;
    }
  pair.truth["depth"] = first;
  pair.truth["behind_depth"] = behind;
  pair.rendered["behind_depth"] = rendered;
  auto scores = evaluate_view(pair);
  CHECK(scores.at("behind-absrel-content") == Approx(0.1).epsilon(1e-6));
  CHECK(scores.at("behind-absrel-beyond") == 0.25);
  CHECK(scores.at("behind-absrel") == Approx(0.175).epsilon(1e-6));
  CHECK(scores.count("behind-absrel-content@glass") == 0);
  behind.array().fill(3);  // all of it content
  scores = evaluate_view(pair);
  CHECK(scores.count("behind-absrel-beyond") == 0);
  CHECK(scores.count("behind-absrel-content") == 1);
}

TEST_CASE("glass may be found in a specularity, where there is no transparency") {
  const Maps maps;
  ViewPair pair = maps.pair();
  pair.rendered["transparency"] = {};
  CHECK(evaluate_view(pair).count("glass-iou-best") == 0);
  Image faint(kWidth, kHeight, 1, 0.06f);
  for (int y = 10; y < 20; ++y)
    for (int x = 10; x < 20; ++x) faint.at(x, y) = 0.12f;
  pair.rendered["specularity"] = faint;
  CHECK(evaluate_view(pair).at("glass-iou-best") == 1);
  CHECK(evaluate_view(pair).count("transparency-iou") == 0);
}

TEST_CASE("the release's depth scale is fitted on the whole view, whatever the region") {
  const Maps maps;
  const DepthProtocol protocol = release_depth_protocol();
  const DepthFit fit = fit_depth(maps.depth, maps.true_depth, {}, protocol);
  CHECK(
      evaluate_view(maps.pair()).at("depth-absrel-release@glass") ==
      depth_errors(maps.depth, maps.true_depth, maps.glass, protocol, fit)->absrel
  );
}

TEST_CASE("metrics without their map or truth are absent") {
  const Maps maps;
  ViewPair pair;
  pair.rendered["rgb"] = maps.rgb, pair.truth["rgb"] = maps.true_rgb,
  pair.rendered["depth"] = maps.depth;
  const auto scores = evaluate_view(pair);
  CHECK(scores.size() == 4);
  CHECK(scores.count("ssim-3dgs") == 1);
}

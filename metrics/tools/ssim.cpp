// SPDX-License-Identifier: MIT
#include "metrics/ssim.h"

#include <CLI/CLI.hpp>

#include <algorithm>

#include "glint/scene/image_files.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

class SsimTool final : public MetricTool {
 public:
  std::string name() const override { return "glint-ssim"; }
  std::string description() const override {
    return "Structural similarity: 11x11 Gaussian window, sigma 1.5, per channel, range 1.";
  }
  std::string example() const override {
    return "glint-ssim renders/ images/ --variant all --mask masks/";
  }
  FolderLayout prediction_layout() const override { return {{"renders"}, {"rgb.exr", "rgb.png"}}; }
  std::string reference_map() const override { return "rgb"; }
  FolderLayout reference_layout() const override {
    return {{"images"}, {"000000.png", "000000.jpg"}};
  }

  void add_options(CLI::App& app) override {
    app.add_option("--variant", variant_, "3dgs: zeros outside the image; wang: valid region; all")
        ->check(CLI::IsMember({"3dgs", "wang", "all"}))
        ->capture_default_str();
  }

  Image load_prediction(const fs::path& path) const override { return read_image(path, 3); }
  Image load_reference(const fs::path& path) const override { return read_image(path, 3); }

  std::vector<PairMetrics> families() const override {
    std::vector<SsimBorder> borders;
    if (variant_ != "wang") borders.push_back(SsimBorder::kZeroPadded);
    if (variant_ != "3dgs") borders.push_back(SsimBorder::kValid);
    return {ssim_metrics(std::move(borders))};
  }
  std::string why_unfit(const std::string& metric_id, ImageSize size) const override {
    if (metric_id != "ssim-wang" || std::min(size.width, size.height) >= kSsimTaps) return {};
    return fmt::format(
        "the picture of {0} x {1} pixels is smaller than the window of {2} x {2}; give larger "
        "pictures, or --variant 3dgs",
        size.width,
        size.height,
        kSsimTaps
    );
  }

 private:
  std::string variant_ = "3dgs";
};

}  // namespace

std::unique_ptr<MetricTool> make_ssim_tool() { return std::make_unique<SsimTool>(); }

}  // namespace glint

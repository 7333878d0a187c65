// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

class PsnrTool final : public MetricTool {
 public:
  std::string name() const override { return "glint-psnr"; }
  std::string description() const override {
    return "Peak signal-to-noise ratio in dB. Float predictions (EXR, NPY) give psnr, integer ones "
           "(PNG, JPEG, NPY of uint8) psnr-8bit.";
  }
  std::string example() const override {
    return "glint-psnr out/ci/runs/room_1/2dgs/0 data/glassroom/room_1-* --json";
  }
  FolderLayout prediction_layout() const override { return {{"renders"}, {"rgb.exr", "rgb.png"}}; }
  std::string reference_map() const override { return "rgb"; }
  FolderLayout reference_layout() const override {
    return {{"images"}, {"000000.png", "000000.jpg"}};
  }

  Image load_prediction(const fs::path& path) const override { return read_image(path, 3); }
  Image load_reference(const fs::path& path) const override { return read_image(path, 3); }

  // A float file holds what was rendered, an integer file what was saved.
  std::vector<PairMetrics> families() const override {
    return {psnr_metrics({}), psnr_metrics(psnr_8bit_protocol())};
  }
  std::size_t family_for(const FilePair& files) const override {
    return stores_integers(files.prediction) ? 1 : 0;
  }

  // Identical images count with the cap, so their number is told.
  Json summary(std::span<const ImageScores> images) const override {
    int identical = 0;
    for (const ImageScores& image : images) identical += image.scores[0].second >= kPsnrCapDb;
    return identical > 0 ? Json{{"num_identical", identical}} : Json::object();
  }
};

}  // namespace

std::unique_ptr<MetricTool> make_psnr_tool() { return std::make_unique<PsnrTool>(); }

}  // namespace glint

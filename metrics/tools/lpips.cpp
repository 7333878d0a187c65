// SPDX-License-Identifier: MIT
#include "metrics/lpips.h"

#include <CLI/CLI.hpp>

#include "glint/scene/image_files.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

class LpipsTool final : public MetricTool {
 public:
  std::string name() const override { return "glint-lpips"; }
  std::string description() const override {
    return "LPIPS 0.1: distance in the features of AlexNet or VGG16. Weights are a "
           "file of yours: scripts/fetch_lpips_weights.sh fetches them, "
           "scripts/convert_lpips_weights.py makes one of downloaded files.";
  }
  std::string example() const override {
    return "glint-lpips renders/ images/ --weights lpips_alex_v0.1.safetensors --mask masks/";
  }
  FolderLayout prediction_layout() const override { return {{"renders"}, {"rgb.exr", "rgb.png"}}; }
  std::string reference_map() const override { return "rgb"; }
  FolderLayout reference_layout() const override {
    return {{"images"}, {"000000.png", "000000.jpg"}};
  }

  void add_options(CLI::App& app) override {
    app.add_option(
        "--weights",
        place_,
        "file, or folder of lpips_<net>_v0.1.safetensors; otherwise GLINT_LPIPS_WEIGHTS, then "
        "~/.cache/glint-bench/lpips"
    );
    app.add_option("--net", network_, "alex or vgg; otherwise the file's, or alex")
        ->check(CLI::IsMember({"alex", "vgg"}));
    app.add_option(
           "--range", range_, "lpips: the network is fed [-1, 1]; 3dgs: [0, 1], as 3DGS does"
    )
        ->check(CLI::IsMember({"lpips", "3dgs"}))
        ->capture_default_str();
  }

  void check_options() override {
    const fs::path place = place_.empty() ? lpips_weights_place() : place_;
    const auto weights = lpips_weights_at(place, network_);
    const std::string network = network_.empty() ? "alex" : network_;
    GLINT_CHECK(
        weights != nullptr,
        kEnvironment,
        "no LPIPS weights of {0} at '{1}'; scripts/fetch_lpips_weights.sh fetches them, or make "
        "lpips_{0}_v0.1.safetensors with scripts/convert_lpips_weights.py and put it there, or "
        "name it by "
        "--weights or GLINT_LPIPS_WEIGHTS",
        network,
        place.string()
    );
    protocol_.network = weights->network;
    protocol_.range = range_ == "3dgs" ? LpipsRange::kUnit : LpipsRange::kSymmetric;
    lpips_ = std::make_shared<Lpips>(weights, protocol_.range);
  }

  Image load_prediction(const fs::path& path) const override { return read_image(path, 3); }
  Image load_reference(const fs::path& path) const override { return read_image(path, 3); }

  std::vector<PairMetrics> families() const override { return {lpips_metrics(lpips_, protocol_)}; }

  bool one_at_a_time() const override { return true; }  // the network has one set of buffers

  Json protocol_of_options() const override { return lpips_provenance(lpips_->weights()); }

 private:
  fs::path place_;
  std::string network_, range_ = "lpips";
  LpipsProtocol protocol_;
  std::shared_ptr<Lpips> lpips_;
};

}  // namespace

std::unique_ptr<MetricTool> make_lpips_tool() { return std::make_unique<LpipsTool>(); }

}  // namespace glint

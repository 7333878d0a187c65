// SPDX-License-Identifier: MIT
#include "metrics/depth.h"

#include <CLI/CLI.hpp>

#include "glint/core/error.h"
#include "glint/scene/camera.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_depth.h"
#include "glint/scene/image_files_stored.h"
#include "metrics/tools/doubts.h"
#include "metrics/tools/numeric_options.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

class DepthTool final : public MetricTool {
 public:
  std::string name() const override { return "glint-depth"; }
  std::string description() const override {
    return "Errors of depth maps: planar z, one channel, metres as EXR, NPY or TIFF or steps as "
           "16-bit PNG; 0 or not finite: no depth.";
  }
  std::string example() const override {
    return "glint-depth out/ci/runs/room_1/2dgs/0 data/glassroom/room_1-* --glass "
           "data/glassroom/room_1-*";
  }
  FolderLayout prediction_layout() const override { return {{"renders"}, {"depth.exr"}}; }
  std::string reference_map() const override { return "depth"; }
  // A folder of truth of ours, or GlassRecon's: completed where glass was, unknown pixels 0.
  FolderLayout reference_layout() const override {
    return {{"gt/depth", "evaluation_depths/depths_npy", "evaluation_depths"}, {}};
  }

  void add_options(CLI::App& app) override {
    app.add_option("--align", alignment_, "fit per image")
        ->check(CLI::IsMember({"none", "median", "scale", "affine"}))
        ->capture_default_str();
    app.add_option("--max-depth", max_depth_, "metres; depths at or beyond do not exist")
        ->check(above_zero());
    auto* release = app.add_flag(
        "--release", release_, "the official release: median scale, below 20 m, holes skipped"
    );
    release->excludes("--align")->excludes("--max-depth");
    app.add_option("--ray", intrinsics_, "FX FY CX CY: the prediction holds distances along rays")
        ->expected(4);
    app.add_option(
           "--depth-scale", depth_scale_, "metres of a step of integers, on either side (0.001: mm)"
    )
        ->check(above_zero());
    app.add_flag("--planar", planar_, "the prediction holds planar z (the default)")
        ->excludes("--ray");
  }

  void check_options() override {
    GLINT_CHECK(
        intrinsics_.empty() || (intrinsics_[0] > 0 && intrinsics_[1] > 0),
        kUsage,
        "--ray: focal lengths {} and {}; expected pixels above 0",
        intrinsics_[0],
        intrinsics_[1]
    );
  }

  // Integers of all pairs have one scale.
  void look_at(const FilePair& first) override {
    if (first.view == nullptr)
      reference_scale_ = with_exit_code(ExitCode::kBadReference, [&] {
        const DepthSteps steps = glassrecon_depth_scale(first.reference);
        return depth_scale_ <= 0 && steps.known() ? steps : stated_scale(first.reference);
      });
    with_exit_code(ExitCode::kBadPrediction, [&] {
      prediction_scale_ = stated_scale(first.prediction);
      if (!stores_integers(first.prediction) || prediction_scale_.known()) return;
      const Image reference =
          first.view ? map_of(*first.view, "depth") : load_reference(first.reference);
      if (!reference.empty()) prediction_scale_ = depth_scale_by(first.prediction, reference);
    });
  }

  Image load_prediction(const fs::path& path) const override {
    const bool metric = protocol().alignment == DepthAlignment::kNone;
    Image depth = !metric && !prediction_scale_.known() ? read_image(path, 1)
                                                        : read_depth(path, prediction_scale_);
    prepare_prediction(depth);
    return depth;
  }
  Image load_reference(const fs::path& path) const override {
    if (const DepthSteps scale = glassrecon_depth_scale(path); depth_scale_ <= 0 && scale.known())
      return read_glassrecon_depth(path, scale);
    return read_depth(path, reference_scale_);
  }

  void prepare_prediction(Image& depth) const override {
    if (intrinsics_.empty()) return;
    const Camera camera{
        depth.width(),
        depth.height(),
        intrinsics_[0],
        intrinsics_[1],
        intrinsics_[2],
        intrinsics_[3]};
    make_planar(depth, camera);
  }

  // Values that a table does not have under its id get the alignment in theirs.
  std::vector<PairMetrics> families() const override {
    const std::string suffix = release_ ? "-release" : alignment_ == "none" ? "" : "-" + alignment_;
    return {depth_metrics(protocol(), suffix)};
  }

  std::string doubt(const LoadedPair& pair) const override {
    if (protocol().alignment != DepthAlignment::kNone) return {};
    return depth_unit_doubt(pair.prediction, pair.reference);
  }

  Json protocol_of_options() const override {
    Json protocol = {
        {"prediction", intrinsics_.empty() ? "planar z" : "distance along rays, made planar"}};
    for (const auto& [side, scale] :
         {std::pair{"prediction_steps", &prediction_scale_},
          {"reference_steps", &reference_scale_}})
      if (scale->known()) protocol[side] = {{"metres", scale->metres}, {"from", scale->from}};
    return protocol;
  }

 private:
  // Nothing of a file that needs none.
  DepthSteps stated_scale(const fs::path& path) const {
    if (!stores_integers(path)) return {};
    if (depth_scale_ > 0) return {depth_scale_, "--depth-scale"};
    return exported_depth_scale(path);
  }

  DepthProtocol protocol() const {
    if (release_) return release_depth_protocol();
    DepthProtocol protocol;
    protocol.alignment = Json(alignment_).get<DepthAlignment>();
    protocol.max_depth = max_depth_;
    return protocol;
  }

  std::string alignment_ = "none";
  double max_depth_ = 0;    // metres; 0: no limit
  double depth_scale_ = 0;  // metres; 0: not given
  DepthSteps prediction_scale_, reference_scale_;
  bool release_ = false, planar_ = false;
  std::vector<double> intrinsics_;  // fx fy cx cy in pixels, when given
};

}  // namespace

std::unique_ptr<MetricTool> make_depth_tool() { return std::make_unique<DepthTool>(); }

}  // namespace glint

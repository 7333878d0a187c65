// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "metrics/tools/doubts.h"
#include "metrics/tools/normal_axes.h"
#include "metrics/tools/tool.h"

namespace glint {
namespace {

// Integer files store (n + 1) / 2; black is no normal.
void decode_integers(Image& normals) {
  for (std::size_t i = 0; i < normals.num_pixels(); ++i) {
    float* n = normals.data() + 3 * i;
    const bool black = n[0] == 0 && n[1] == 0 && n[2] == 0;
    for (int c = 0; c < 3; ++c) n[c] = black ? 0 : 2 * n[c] - 1;
  }
}

Image load_normals(const fs::path& path) {
  Image normals = read_image(path);
  GLINT_CHECK(
      normals.channels() == 3,
      kBadReference,
      "{}: {} channels, expected 3 (a normal)",
      path.string(),
      normals.channels()
  );
  if (stores_integers(path)) decode_integers(normals);
  return normals;
}

void turn_to_opencv(Image& normals, const std::string& axes) {
  const Axes& known = axes_called(axes);
  for (std::size_t i = 0; i < normals.values().size(); ++i)
    normals.data()[i] *= known.to_opencv[i % 3];
}

class NormalTool final : public MetricTool {
 public:
  std::string name() const override { return "glint-normal"; }
  std::string description() const override {
    return "Angles between normal maps in camera space: floats (EXR, NPY), or integers (PNG, NPY) "
           "as (n + 1) / 2.";
  }
  std::string example() const override {
    return "glint-normal predicted/ rooms/room_3/gt/normal --axes opengl --csv";
  }
  FolderLayout prediction_layout() const override { return {{"renders"}, {"normal.exr"}}; }
  std::string reference_map() const override { return "normal"; }
  FolderLayout reference_layout() const override { return {{"gt/normal"}, {}}; }

  void add_options(CLI::App& app) override {
    const CLI::IsMember known({"opencv", "opengl", "stablenormal"});
    app.add_option("--axes", axes_, "of the prediction: opencv, opengl or stablenormal")
        ->check(known)
        ->capture_default_str();
    app.add_option("--reference-axes", reference_axes_, "the same of the reference")
        ->check(known)
        ->capture_default_str();
  }

  Image load_prediction(const fs::path& path) const override {
    Image normals = load_normals(path);
    prepare_prediction(normals);
    return normals;
  }
  Image load_reference(const fs::path& path) const override {
    Image normals = load_normals(path);
    prepare_reference(normals);
    return normals;
  }
  void prepare_prediction(Image& normals) const override { turn_to_opencv(normals, axes_); }
  void prepare_reference(Image& normals) const override {
    turn_to_opencv(normals, reference_axes_);
  }

  std::vector<PairMetrics> families() const override { return {normal_metrics()}; }

  std::string doubt(const LoadedPair& pair) const override {
    return normal_axes_doubt(pair.prediction, pair.reference, axes_);
  }

  Json protocol_of_options() const override {
    return {{"prediction_axes", axes_}, {"reference_axes", reference_axes_}};
  }

 private:
  std::string axes_ = "opencv", reference_axes_ = "opencv";
};

}  // namespace

std::unique_ptr<MetricTool> make_normal_tool() { return std::make_unique<NormalTool>(); }

}  // namespace glint

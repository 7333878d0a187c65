// SPDX-License-Identifier: MIT
// PGSR [Chen24]: "PGSR: Planar-based Gaussian Splatting for Efficient and High-Fidelity Surface
// Reconstruction", TVCG 2024. Depth is that of the plane which a pixel's composited normal and
// distance describe, and planes are regularised by one view (Eq. 9) and by a view and a neighbour
// (Eqs. 11-13). What it shares with methods built on it is in glint/train/planar_model.h.
//
// The same: losses, weights and their start, neighbours, the squared NCC, sampled clones, trim,
// rates, exposure (off, as published). Defaults are the settings that its README gives for rooms
// with little texture (max_abs_splits 0, min_opacity 0.05); for objects it has 50000 and 0.005.
//
// Deviations: surfels instead of flattened 3D Gaussians, so the loss on their thickness drops out,
// and random rotations, since the identity would lay all discs flat; schedules are scaled to the
// run; distances between neighbours and the near limit are in scene units, here half the scene's
// extent (scene_unit), where published captures span about two; one image size for training and
// NCC; images are compared as stored; pruning by screen size is left out, as in 2DGS here; a step
// trims, then densifies (there the other way round, so that trims see what is new); a view's
// exposure has an Adam of its own, whose moments wait while the view is not drawn.
#include "glint/method.h"
#include "glint/render/map_ops.h"
#include "glint/train/planar_model.h"
#include "glint/train/training_state.h"

namespace glint {

namespace {

class Pgsr final : public Method {
 public:
  explicit Pgsr(const Json& overrides) { config_from_json(config_, overrides, "pgsr"); }

  void initialize(const Scene& scene, const RunOptions& options) override {
    warnings_ = model_.set_up(config_, scene, options, "pgsr");
  }

  StepStats step(int iteration) override {
    StepStats stats;
    const View& view = model_.forward(iteration, stats);
    model_.add_losses(view, stats);
    model_.backward(stats);
    return stats;
  }

  MapSet render(const Camera& camera) override {
    MapSet maps = model_.render(camera);
    add_depth_modes(model_.set().pass().rasterizer, maps);
    return maps;
  }
  void draw(const Camera& camera) override { model_.draw(camera); }
  void save(const std::string& folder) const override { model_.save(folder); }
  void load(const std::string& folder) override { model_.load(folder); }
  Json config() const override { return config_to_json(config_); }
  std::vector<ConfigField> fields() const override { return config_fields(config_); }
  void check_finite() const override { glint::check_finite(model_.set().cloud(), "interface"); }
  bool visit_state(TrainingState& state) override {
    state("model", model_);
    return true;
  }
  std::size_t num_surfels() const override { return model_.set().cloud().size(); }
  std::vector<std::string> warnings() const override { return warnings_; }

 private:
  PlanarConfig config_;
  std::vector<std::string> warnings_;
  PlanarModel model_;
};

MethodSpec pgsr_spec() {
  MethodSpec spec;
  spec.id = "pgsr";
  spec.title = "PGSR";
  spec.citation = "chen2024pgsr";
  spec.paper_row = "PGSR";
  spec.description = "planar surfels, regularised by single and by neighbouring views";
  spec.create = [](const Json& config) { return std::make_unique<Pgsr>(config); };
  return spec;
}

}  // namespace

GLINT_REGISTER(MethodSpec, pgsr_spec())

}  // namespace glint

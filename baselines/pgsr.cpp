// SPDX-License-Identifier: MIT
// PGSR [Chen24]: "PGSR: Planar-based Gaussian Splatting for Efficient and High-Fidelity Surface
// Reconstruction", TVCG 2024. Depth is that of the plane which a pixel's composited normal and
// distance describe, and planes are regularised by one view (Eq. 9) and by a view and a neighbour
// (Eqs. 11-13). What it shares with methods built on it is in baselines/planar/planar_model.h.
//
// The same: losses, weights and their start, neighbours, the squared NCC, sampled clones, trim,
// rates. Exposure, off as published, is left out. Defaults are the settings that its README gives
// for rooms with little texture (max_abs_splits 0, min_opacity 0.05); for objects it has 50000 and
// 0.005.
//
// Deviations: surfels instead of flattened 3D Gaussians, so the loss on their thickness drops out,
// and random rotations, since the identity would lay all discs flat; schedules are scaled to the
// run; distances between neighbours and the near limit are in scene units, here half the scene's
// extent (scene_unit), where published captures span about two; one image size for training and
// NCC; images are compared as stored; pruning by screen size is left out, as in 2DGS here; a step
// trims, then densifies (there the other way round, so that trims see what is new).
#include "baselines/planar/planar_model.h"
#include "glint/render/map_ops.h"
#include "glint/surfel_method.h"

namespace glint {

namespace {

class Pgsr final : public MethodOf<PlanarConfig> {
 public:
  explicit Pgsr(PlanarConfig config) : MethodOf(std::move(config)), model_(set_) {
    sets_ = {{"interface", &set_}};
  }

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
    add_depth_modes(set_.pass().rasterizer, maps);
    return maps;
  }
  const Image& picture(const Camera& camera) override { return model_.draw(camera).features; }
  void load(const std::string& folder) override {
    MethodOf::load(folder);
    model_.use_all_degrees();
  }
  bool visit_state(TrainingState& state) override {
    state("model", model_);
    return MethodOf::visit_state(state);
  }

 private:
  TrainableSet set_;
  PlanarModel model_;
};

[[maybe_unused]] const bool registered = register_methods<Pgsr>(
    __FILE__,
    "chen2024pgsr",
    {{"pgsr", "PGSR", "PGSR", "planar surfels, regularised by single and by neighbouring views"}}
);

}  // namespace

}  // namespace glint

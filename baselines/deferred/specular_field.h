// SPDX-License-Identifier: MIT
// Reflections from a learned map of directions [Ref-GS]: the mirrored viewing direction at a
// pixel's normal is looked up at the pixel's roughness, joined with its feature, and decoded by a
// network. Shared by deferred methods; what they make of the network's outputs is theirs.
#pragma once

#include <filesystem>

#include "baselines/deferred/mlp.h"
#include "baselines/deferred/specular_field_kernels.h"
#include "baselines/deferred/spherical_lookup.h"
#include "glint/render/rasterize.h"
#include "glint/scene/surfels.h"

namespace glint {

struct SpecularFieldConfig {
  // Deviation: the published sizes are 512 rows and 256 hidden values, 86.8k multiply-adds a pixel
  // and 8.4 million texels; the defaults are for CPUs (64 is what its authors take for NeRF's
  // synthetic scenes).
  int map_height = 64, map_channels = 16, hidden = 64;
  float min_alpha = 0.05f;
  float rate_map = 2e-3f, rate_network = 5e-4f;

  static constexpr int kPublishedHeight = 512, kPublishedHidden = 256;
  // Of a run's notes, for tables: sizes other than the published ones; none: those.
  std::vector<std::string> notes() const;

  template <class V>
  void visit(V&& v) {
    v("map_height", map_height, "rows of the map of directions (published: 512)");
    v("map_channels", map_channels, "numbers of a direction");
    v("hidden", hidden, "width of the network's two hidden layers (published: 256)");
    v("min_alpha", min_alpha, "pixels with less are not shaded");
    v("rate_map", rate_map, "learning rate of the map of directions");
    v("rate_network", rate_network, "learning rate of the network");
  }
};

// The surfels' features that the network is given, behind `channels`; raw values start at random
// around zero.
void add_feature_channels(float rate, float spread, std::vector<ExtraChannel>& channels);

class SpecularField {
 public:
  SpecularField() = default;
  // The map starts at zero; the biases of the outputs at `biases`, one each. Errors (kUsage):
  // sizes.
  SpecularField(
      const SpecularFieldConfig& config, const std::vector<float>& biases, std::uint64_t seed
  );

  // The network's outputs for the pixels of a rasterised set, [H][W][outputs]; without meaning
  // where shaded directions() are zero. All must stay as they are until backward().
  const FloatArray& forward(
      const Camera& camera, const RasterOutput& surface, const SpecularChannels& channels
  );
  // [H][W][3] unit, world; zero: not shaded.
  const Image& directions() const { return directions_; }
  // Back through the last forward(): adds to the gradients of map and network, and of the set's
  // normal and features. dL_doutputs: zero where not shaded.
  void backward(const FloatArray& dL_doutputs, RasterOutputGradient& dL_dsurface);
  // An optimiser step, `faster` times the rates.
  void step(float faster);

  TrainableArray& map() { return map_; }  // [height][2 height][channels]; then map_changed()
  Mlp& network() { return network_; }
  void map_changed() { lookup_.set_texels(map_.values); }

  // A file of a run's folder, beside it the stage that the method had come to.
  void save(const std::filesystem::path& folder, int stage) const;
  // Returns the stage, the last where the file says none. Errors (kBadReference): other sizes than
  // the config's, not one of `stages`.
  int load(const std::filesystem::path& folder, int stages);
  void check_finite() const;
  void visit_state(TrainingState& state);

 private:
  std::vector<std::size_t> map_shape() const;

  SpecularFieldConfig config_;
  TrainableArray map_;
  SphericalLookup lookup_;
  Mlp network_;
  // Of the last forward().
  Camera camera_;
  const RasterOutput* surface_ = nullptr;
  SpecularChannels channels_;
  Image directions_, roughness_;
  const Image* code_ = nullptr;
  FloatArray inputs_, dL_dinputs_;
  Image dL_dcode_, dL_ddirections_, dL_droughness_;
};

}  // namespace glint

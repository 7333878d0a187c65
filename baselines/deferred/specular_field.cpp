// SPDX-License-Identifier: MIT
#include "baselines/deferred/specular_field.h"

#include <fmt/format.h>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/glass_transport.h"
#include "glint/train/training_state.h"

namespace glint {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kGrain = 512;  // pixels a block

constexpr const char* kFile = "specular_field.safetensors";
constexpr const char* kNetwork = "field.network";
constexpr const char* kMap = "field.map";
constexpr const char* kStage = "stage";  // of the method, in the file's metadata

}  // namespace

void add_feature_channels(float rate, float spread, std::vector<ExtraChannel>& channels) {
  for (int k = 0; k < kSpecularFeature; ++k)
    channels.push_back({fmt::format("feature_{}", k), 0, rate, Activation::kTanh, spread});
}

std::vector<std::string> SpecularFieldConfig::notes() const {
  if (map_height == kPublishedHeight && hidden == kPublishedHidden) return {};
  return {fmt::format(
      "map of {} x {} directions and {} hidden values (published: {} x {} and {})",
      map_height,
      2 * map_height,
      hidden,
      kPublishedHeight,
      2 * kPublishedHeight,
      kPublishedHidden
  )};
}

SpecularField::SpecularField(
    const SpecularFieldConfig& config, const std::vector<float>& biases, std::uint64_t seed
)
    : config_(config), lookup_(config.map_height, config.map_channels) {
  map_ = TrainableArray(lookup_.num_values());
  const int outputs = static_cast<int>(biases.size()), hidden = config.hidden;
  network_ = Mlp({config.map_channels * (kSpecularFeature + 1), hidden, hidden, outputs}, seed);
  std::copy(biases.begin(), biases.end(), network_.biases(2).begin());
  map_changed();
}

const FloatArray& SpecularField::forward(
    const Camera& camera, const RasterOutput& surface, const SpecularChannels& channels
) {
  camera_ = camera;
  surface_ = &surface;
  channels_ = channels;
  const ImageSize size = camera.size();
  const int feature_channels = surface.features.channels();
  fit(directions_, size, 3);
  fit(roughness_, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      SpecularDirections{
          pixel_rays(camera),
          config_.min_alpha,
          feature_channels,
          channels.roughness,
          surface.features.on_device(),
          surface.alpha.on_device(),
          surface.normal.on_device(),
          directions_.on_device(),
          roughness_.on_device()}
  );
  code_ = &lookup_.look_up(directions_, roughness_);
  inputs_.resize(size.num_pixels() * static_cast<std::size_t>(network_.widths().front()));
  run_kernel(
      size.num_pixels(),
      kGrain,
      SpecularInputs{
          config_.map_channels,
          feature_channels,
          channels.feature,
          code_->on_device(),
          surface.features.on_device(),
          inputs_.on_device()}
  );
  return network_.forward(inputs_);
}

void SpecularField::backward(const FloatArray& dL_doutputs, RasterOutputGradient& dL_dsurface) {
  GLINT_CHECK(surface_ != nullptr, kUsage, "specular field: backward() without a forward()");
  dL_dinputs_.resize(inputs_.size());
  network_.backward(dL_doutputs, &dL_dinputs_);
  const std::size_t pixels = directions_.num_pixels();
  const int feature_channels = surface_->features.channels();
  fit(dL_dcode_, directions_.size(), config_.map_channels);
  run_kernel(
      pixels,
      kGrain,
      SpecularInputsVjp{
          config_.map_channels,
          feature_channels,
          channels_.feature,
          code_->on_device(),
          surface_->features.on_device(),
          dL_dinputs_.on_device(),
          dL_dcode_.on_device(),
          dL_dsurface.features.on_device()}
  );
  lookup_.look_up_vjp(dL_dcode_, dL_ddirections_, dL_droughness_, map_.gradient);
  run_kernel(
      pixels,
      kGrain,
      SpecularDirectionsVjp{
          pixel_rays(camera_),
          feature_channels,
          channels_.roughness,
          directions_.on_device(),
          surface_->normal.on_device(),
          dL_ddirections_.on_device(),
          dL_droughness_.on_device(),
          dL_dsurface.features.on_device(),
          dL_dsurface.normal.on_device()}
  );
}

void SpecularField::step(float faster) {
  map_.step(faster * config_.rate_map);
  network_.parameters().step(faster * config_.rate_network);
  map_changed();
}

void SpecularField::visit_state(TrainingState& state) {
  state("map", map_);
  state("network", network_);
  if (state.reading()) map_changed();
}

std::vector<std::size_t> SpecularField::map_shape() const {
  const auto height = static_cast<std::size_t>(config_.map_height);
  return {height, 2 * height, static_cast<std::size_t>(config_.map_channels)};
}

void SpecularField::save(const fs::path& folder, int stage) const {
  std::vector<TensorToWrite> tensors = network_.tensors(kNetwork);
  tensors.push_back(float_tensor(kMap, map_shape(), map_.values));
  write_safetensors(folder / kFile, {{kStage, std::to_string(stage)}}, tensors);
}

int SpecularField::load(const fs::path& folder, int stages) {
  SafetensorsFile file(folder / kFile);
  network_.read(file, kNetwork);
  read_floats(file, kMap, map_shape(), map_.values);
  try {
    check_finite();
  } catch (const Error& error) {
    throw Error(
        ExitCode::kBadReference,
        fmt::format("{}: {}; train again", (folder / kFile).string(), error.what())
    );
  }
  map_changed();
  const auto stage = file.metadata().find(kStage);
  if (stage == file.metadata().end()) return stages - 1;
  int known = 0;
  while (known < stages && stage->second != std::to_string(known)) ++known;
  GLINT_CHECK(
      known < stages,
      kBadReference,
      "{}: metadata: '{}' is '{}'; expected 0 to {}, the method's stages",
      (folder / kFile).string(),
      kStage,
      stage->second,
      stages - 1
  );
  return known;
}

void SpecularField::check_finite() const {
  map_.check_finite("field map");
  network_.parameters().check_finite("field network");
}

}  // namespace glint

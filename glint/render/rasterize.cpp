// SPDX-License-Identifier: MIT
#include "glint/render/rasterize.h"

#include <optional>

#include "glint/core/error.h"
#include "glint/render/op_backends.h"
#include "glint/render/pixel_pass.h"

namespace glint {

struct Rasterizer::State {
  std::optional<RasterCall> call;
  RasterOutput output;
  RasterGradient gradient;
  DeviceChoice<RasterBackend> devices;

  RasterBackend& device() { return devices.on(on_gpu(), raster_on_cpu, gpu_ops.rasterizer); }
  const RasterCall& last_call() const {
    GLINT_CHECK(call.has_value(), kUsage, "rasterize: nothing was rasterised before");
    return *call;
  }
};

namespace {

void check_map(const char* name, const BorrowedImage& map, const Camera& camera) {
  GLINT_CHECK(
      map.empty() || (map.size() == camera.size() && map.channels() == 1),
      kUsage,
      "rasterize: {} is {}x{}x{}, expected the camera's {}x{}x1",
      name,
      map.size().width,
      map.size().height,
      map.channels(),
      camera.width,
      camera.height
  );
}

void check_call(const RasterCall& call) {
  const RasterInput& input = call.input;
  GLINT_CHECK(
      input.channels >= 1 && input.channels <= kMaxChannels,
      kUsage,
      "rasterize: {} feature channels, expected 1 to {}",
      input.channels,
      kMaxChannels
  );
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.features.size() == n * input.channels;
  GLINT_CHECK(sizes_agree, kUsage, "rasterize: array sizes do not match {} surfels", n);
  check_map("near_limit", input.near_limit, call.camera);
  check_map("needed", input.needed, call.camera);
}

void fit_output(const RasterCall& call, RasterOutput& out) {
  const auto fit_map = [&](const char*, int channels, Image& map) {
    if (channels == 0)
      map = Image();
    else
      fit(map, call.camera.size(), channels);
  };
  for_each_map(call.maps(), fit_map, out);
  out.visibility.resize(call.input.count);
  out.in_view.resize(call.input.count);
  const std::size_t with_statistics = call.settings.with_statistics ? call.input.count : 0;
  out.owned_pixels.resize(with_statistics);
  out.radii.resize(with_statistics);
}

void fit_gradient(const RasterCall& call, RasterGradient& gradient) {
  RasterGradient::for_each_array(
      call.maps(),
      [&](const char*, std::size_t width, FloatArray& array) {
        array.resize(width * call.input.count);
      },
      gradient
  );
}

}  // namespace

Rasterizer::Rasterizer() : state_(std::make_unique<State>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;
Rasterizer& Rasterizer::operator=(Rasterizer&&) noexcept = default;

const RasterCall& Rasterizer::call() const { return state_->last_call(); }
const RasterOutput& Rasterizer::output() const { return state_->output; }
std::size_t Rasterizer::num_pairs() const { return state_->device().num_pairs(); }
std::size_t Rasterizer::num_pixel_pairs() const { return state_->device().num_pixel_pairs(); }

const RasterOutput& Rasterizer::forward(const RasterCall& call, Rasterizer* first) {
  check_call(call);
  state_->call = call;
  fit_output(call, state_->output);
  state_->device().forward(
      call, state_->output, first != nullptr ? &first->state_->device() : nullptr
  );
  return state_->output;
}

const RasterGradient& Rasterizer::backward(const RasterOutputGradient& dL_doutput) {
  const RasterCall& call = state_->last_call();
  fit_gradient(call, state_->gradient);
  state_->device().backward(call, state_->output, dL_doutput, state_->gradient);
  return state_->gradient;
}

void Rasterizer::first_surface(
    const Image& mask, const FirstSurfaceSettings& settings, Image& depth
) {
  const RasterCall& call = state_->last_call();
  GLINT_CHECK(
      mask.size() == call.camera.size() && mask.channels() == 1,
      kUsage,
      "first_surface: the mask is {}x{}x{}, expected the camera's {}x{}x1",
      mask.width(),
      mask.height(),
      mask.channels(),
      call.camera.width,
      call.camera.height
  );
  GLINT_CHECK(call.maps().surface, kUsage, "first_surface: the pass was without a surface");
  fit(depth, call.camera.size(), 1);
  state_->device().first_surface(call, state_->output, mask, settings, depth);
}

void Rasterizer::depth_modes(const DepthModeSettings& settings, Image& first, Image& last) {
  const RasterCall& call = state_->last_call();
  fit(first, call.camera.size(), 1);
  fit(last, call.camera.size(), 1);
  state_->device().depth_modes(call, settings, first, last);
}

}  // namespace glint

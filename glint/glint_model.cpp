// SPDX-License-Identifier: MIT
#include "glint/glint_model.h"

#include <algorithm>

namespace glint {

namespace {

// Camera rays that start at a planar depth: the parameter of a ray with camera-space z = 1.
Rays rays_behind(const Camera& camera, const Image& depth) {
  Rays rays = camera_rays(camera);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
      rays.origins.data()[k] += depth.data()[i] * rays.directions.data()[k];
  return rays;
}

Image scaled_by_pixel(const Image& color, const Image& factor) {
  Image result = color;
  for (std::size_t i = 0; i < result.values().size(); ++i)
    result.values()[i] *= factor.data()[i / 3];
  return result;
}

}  // namespace

const Image& GlintModel::forward(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase
) {
  phase_ = phase;
  transport_.set_options({config.f0, phase.transmission, phase.reflection, config.detach_origins});
  interface_output_ = &interface.forward(camera, phase.interface_degree, {});
  const GlassBuffer& buffer = transport_.read_interface(camera, *interface_output_);
  copy_color(interface_output_->features, layers_.interface);
  if (phase.transmission) render_transmission(camera, config);
  if (phase.reflection)
    layers_.reflection =
        reflection.trace(buffer.reflected, phase.reflection_degree, config.mirror.settings()).color;
  return transport_.compose(layers_);
}

void GlintModel::render_transmission(const Camera& camera, const GlintConfig& config) {
  near_limit_ = buffer().depth;
  for (float& z : near_limit_.values()) z += z > 0 ? config.secondary_near : 0;
  if (config.transmission == "trace") {
    through_ = rays_behind(camera, near_limit_);
    layers_.transmission = transmission.trace(through_, phase_.transmission_degree, {}).color;
  } else {
    layers_.transmission =
        transmission.forward(camera, phase_.transmission_degree, {}, near_limit_).features;
  }
}

void GlintModel::transmission_vjp(
    const Camera& camera, const GlintConfig& config, const Image& dL_dradiance
) {
  if (config.transmission == "trace") {
    dL_dtrace_.color = dL_dradiance;
    transmission.trace_backward(through_, phase_.transmission_degree, {}, dL_dtrace_);
  } else {
    dL_dtransmission_.features = dL_dradiance;
    transmission.backward(camera, phase_.transmission_degree, {}, dL_dtransmission_, near_limit_);
  }
}

void GlintModel::backward(
    const Camera& camera,
    const GlintConfig& config,
    const Image& dL_dimage,
    const Image& dL_dtransparency,
    bool interface_too,
    RasterOutputGradient& dL_dinterface
) {
  const GlassLayers& dL_dlayers = transport_.compose_vjp(layers_, dL_dimage);
  const Rays* dL_drays = nullptr;
  if (phase_.reflection) {
    dL_dtrace_.color = dL_dlayers.reflection;
    dL_drays = &reflection.trace_backward(
        buffer().reflected, phase_.reflection_degree, config.mirror.settings(), dL_dtrace_
    );
  }
  if (phase_.transmission) transmission_vjp(camera, config, dL_dlayers.transmission);
  if (!interface_too) return;
  transport_.interface_vjp(camera, *interface_output_, dL_drays, dL_dtransparency, dL_dinterface);
  interface.backward(camera, phase_.interface_degree, {}, dL_dinterface);
}

// Median depth of the transmission set behind the interface, which a few faint surfels between the
// layers do not move; where nothing is, the interface's.
Image GlintModel::behind_depth(const Camera& camera) const {
  RasterPass pass;
  Image depth =
      transmission.forward(camera, phase_.transmission_degree, {}, near_limit_, pass).depth_median;
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    if (depth.data()[i] <= 0) depth.data()[i] = buffer().depth.data()[i];
  return depth;
}

// The shares of a pixel's radiance that came through the interface and that it mirrored.
void GlintModel::add_components(RenderOutput& out) const {
  Image through = buffer().transparency;
  for (std::size_t i = 0; i < through.num_pixels(); ++i)
    through.data()[i] *= 1 - buffer().mirrored.data()[i];
  if (phase_.transmission)
    out.layers["transmitted"] = scaled_by_pixel(layers_.transmission, through);
  if (phase_.reflection)
    out.layers["reflected"] = scaled_by_pixel(layers_.reflection, buffer().mirrored);
}

RenderOutput GlintModel::render(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase
) {
  RenderOutput out;
  out.rgb = forward(camera, config, phase);
  out.depth = buffer().depth;
  out.normal = buffer().normal;
  out.alpha = interface_output_->alpha;
  out.layers["transparency"] = buffer().transparency;
  out.layers["specularity"] = buffer().mirrored;
  out.layers["interface"] = layers_.interface;
  if (phase.transmission) out.layers["transmission"] = layers_.transmission;
  if (phase.transmission) out.layers["behind_depth"] = behind_depth(camera);
  if (phase.reflection) out.layers["reflection"] = layers_.reflection;
  add_components(out);
  return out;
}

GlintModel GlintModel::copy() const {
  GlintModel fresh;
  fresh.interface = SurfelSet(interface.cloud(), {}, {}, 1, 0);
  fresh.transmission = SurfelSet(transmission.cloud(), {}, {}, 1, 0);
  fresh.reflection = SurfelSet(reflection.cloud(), {}, {}, 1, 0);
  return fresh;
}

}  // namespace glint

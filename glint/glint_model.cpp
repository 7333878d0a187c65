// SPDX-License-Identifier: MIT
#include "glint/glint_model.h"

#include <algorithm>

#include "glint/core/kernel.h"
#include "glint/render/map_kernels.h"
#include "glint/render/map_ops.h"
#include "glint/train/plane_mirrors_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

}  // namespace

std::vector<MirrorPlane> GlintModel::planes() const {
  std::vector<MirrorPlane> all = mirrors.planes;
  all.insert(all.end(), panes.planes.begin(), panes.planes.end());
  return all;
}

void GlintModel::set_planes(const std::vector<MirrorPlane>& planes) {
  mirrors.planes.clear(), panes.planes.clear(), backs_.planes.clear();
  for (const MirrorPlane& plane : planes) {
    (plane.pane ? panes : mirrors).planes.push_back(plane);
    if (plane.pane) backs_.planes.push_back(plane.turned());
  }
}

const Image& GlintModel::forward(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase
) {
  return compose(camera, config, phase, false);
}

// with_behind: with the maps that add_behind_depth() reads.
const Image& GlintModel::compose(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase, bool with_behind
) {
  camera_ = camera;
  phase_ = phase;
  transport_.set_options(
      {.channels = interface_channels(interface.cloud()),
       .glass_f0 = config.glass_f0,
       .transmission = phase.transmission,
       .reflection = phase.reflection,
       .detach_origins = true,
       .linear_light = config.linear_light}
  );
  interface_output_ =
      &interface.forward(camera, phase.interface_degree, interface_settings(config, phase.planes));
  surface_ = interface_output_;
  if (phase.truth != nullptr)
    surface_ = &given_.put(
        *interface_output_, *phase.truth, interface_channels(interface.cloud()).transparency
    );
  const GlassBuffer& buffer = transport_.read_interface(camera, *surface_);
  copy_color(interface_output_->features, layers_.interface);
  rasterized_ = phase.transmission && config.transmission != "trace";
  layered_ = rasterized_ && config.layers > 1;
  if (phase.transmission) render_transmission(camera, config, with_behind);
  const MirrorsCall call = mirrors_call(camera, config, phase);
  if (phase.reflection) render_reflection(config, call);
  return mirrors.put({interface, transmission}, call, buffer.depth, transport_.compose(layers_));
}

void GlintModel::render_reflection(const GlintConfig& config, const MirrorsCall& call) {
  mirrored_.trace(
      buffer(), reflection, phase_.reflection_degree, config.mirror, phase_.step, layers_.reflection
  );
  const Image& with_panes =
      panes.put({interface, transmission}, call, buffer().depth, layers_.reflection);
  if (&with_panes != &layers_.reflection) copy_color(with_panes, layers_.reflection);
}

MirrorsCall GlintModel::mirrors_call(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase
) const {
  return {
      .camera = camera,
      .settings = interface_settings(config, false),
      .interface_degree = phase.interface_degree,
      .transmission_degree = phase.transmission_degree,
      .transmission = phase.transmission,
      .gap = config.layer_gap,
      .linear_light = config.linear_light};
}

// Their radiance in the place of the transmission set's, with what backs of panes mirror in it.
void GlintModel::add_inner_layers(const GlintConfig& config) {
  const LayersCall call{
      .camera = camera_,
      .settings = interface_settings(config, false),
      .mirror = config.mirror,
      .reflection = phase_.reflection && backs_.planes.empty(),
      .known_panes = backs_.seen(),
      .reflection_degree = phase_.reflection_degree,
      .step = phase_.step,
      .gap = config.layer_gap,
      .pane_gap = config.pane_gap,
      .linear_light = config.linear_light,
      .glass_f0 = config.glass_f0};
  copy_color(
      inner_.forward(
          {interface, transmission, reflection}, call, config.layers - 1, buffer(), near_limit_
      ),
      layers_.transmission
  );
  backs_.put_again(layers_.transmission);
}

RasterSettings GlintModel::interface_settings(const GlintConfig& config, bool with_planes) const {
  RasterSettings settings;
  settings.with_plane_distance = with_planes;
  const int t = interface_channels(interface.cloud()).transparency;
  if (config.detach_transparency && t >= 0) settings.detached_features = 1u << t;
  return settings;
}

const Image& GlintModel::interface_depth() {
  if (surface_ == interface_output_) return buffer().depth;
  expected_depth_map(*interface_output_, own_depth_);
  return own_depth_;
}

void GlintModel::render_transmission(
    const Camera& camera, const GlintConfig& config, bool with_behind
) {
  fit(near_limit_, camera.size(), 1);
  const std::size_t pixels = near_limit_.num_pixels();
  run_kernel(
      pixels,
      kGrain,
      ShiftDepth{buffer().depth.on_device(), config.secondary_near, near_limit_.on_device()}
  );
  if (!rasterized_) {
    camera_rays(camera, through_);
    run_kernel(
        pixels,
        kGrain,
        MoveAlongRays{
            through_.directions.on_device(), near_limit_.on_device(), through_.origins.on_device()}
    );
    const TraceOutput& out = transmission.trace(through_, phase_.transmission_degree, {});
    copy_color(out.color, layers_.transmission);
  } else {
    RasterSettings settings;
    settings.with_surface = with_behind || layered_ || !backs_.planes.empty();
    if (layered_) settings.detached_features = interface_settings(config, false).detached_features;
    const RasterOutput& out =
        transmission.forward(camera, phase_.transmission_degree, settings, near_limit_);
    copy_color(out.features, layers_.transmission);
    add_backs(config, out.depth_median);
    if (layered_) add_inner_layers(config);
  }
}

// depth: [H][W][1] of what stands behind the interface. What is mirrored there is a constant to
// training: at Fresnel's share it says little of the sets, and the way back is a fifth of a step.
void GlintModel::add_backs(const GlintConfig& config, const Image& depth) {
  MirrorsCall call = mirrors_call(camera_, config, phase_);
  call.f0 = config.glass_f0;
  const Image& with_backs =
      backs_.put({interface, transmission}, call, depth, layers_.transmission);
  if (&with_backs != &layers_.transmission) copy_color(with_backs, layers_.transmission);
}

const Image& GlintModel::without_panes(const Image& photo) {
  if (!phase_.reflection || panes.seen() == nullptr) return photo;
  copy_color(photo, through_photo_);
  run_kernel(
      photo.num_pixels(),
      kGrain,
      TakeOutReflection{
          panes.seen()->on_device(),
          buffer().specularity.on_device(),
          layers_.reflection.on_device(),
          through_photo_.on_device()}
  );
  backs_.take_out(through_photo_);
  return through_photo_;
}

void GlintModel::transmission_vjp(const Image& dL_dradiance, bool interface_too) {
  if (layered_) {
    inner_.backward(
        {interface, transmission, reflection}, backs_.put_vjp(dL_dradiance), interface_too
    );
  } else if (!rasterized_) {
    copy_color(dL_dradiance, dL_dthrough_.color);
    transmission.trace_backward(dL_dthrough_);
  } else {
    copy_color(backs_.put_vjp(dL_dradiance), dL_dtransmission_.features);
    transmission.backward(dL_dtransmission_);
  }
}

void GlintModel::backward(
    const Image& dL_dimage,
    const Image& dL_dtransparency,
    bool interface_too,
    RasterOutputGradient& dL_dinterface
) {
  const GlassLayers& dL_dlayers = transport_.compose_vjp(
      layers_, mirrors.put_vjp({interface, transmission}, dL_dimage, interface_too)
  );
  const Rays* dL_drays = nullptr;
  if (phase_.reflection)
    dL_drays = &mirrored_.trace_backward(
        reflection, panes.put_vjp({interface, transmission}, dL_dlayers.reflection, interface_too)
    );
  if (phase_.transmission) transmission_vjp(dL_dlayers.transmission, interface_too);
  if (!interface_too) return;
  const bool given = surface_ != interface_output_;
  transport_.interface_vjp(
      camera_, *surface_, dL_drays, dL_dtransparency, given ? given_.gradient() : dL_dinterface
  );
  if (given) given_.put_vjp(dL_dinterface);
  interface.backward(dL_dinterface);
}

// Median depth of the transmission set behind the interface, which a few faint surfels between the
// layers do not move; where nothing is, the interface's.
void GlintModel::add_behind_depth(const Camera& camera, MapSet& out) {
  const RasterOutput& behind =
      rasterized_
          ? transmission.pass().rasterizer.output()
          : transmission.forward(behind_pass_, camera, phase_.transmission_degree, {}, near_limit_);
  add_depth_estimates(behind, out);
  Image& depth = out["behind_depth"] = behind.depth_median;
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    if (depth.data()[i] <= 0) depth.data()[i] = buffer().depth.data()[i];
}

// The shares of a pixel's radiance that came through the interface and that it mirrored.
void GlintModel::add_components(bool linear_light, MapSet& out) const {
  Image through = buffer().transparency;
  for (std::size_t i = 0; i < through.num_pixels(); ++i)
    through.data()[i] *= 1 - buffer().specularity.data()[i];
  const auto add = [&](MapId name, const Image& layer, const Image& weight) {
    out[name] = part_of_picture(out["rgb"], layer, weight, linear_light);
  };
  if (phase_.transmission) add("transmitted", layers_.transmission, through);
  if (phase_.reflection) add("reflected", layers_.reflection, buffer().specularity);
}

MapSet GlintModel::render(
    const Camera& camera, const GlintConfig& config, const GlintPhase& phase
) {
  MapSet out;
  out["rgb"] = compose(camera, config, phase, true);
  out["depth"] = buffer().depth;
  out["normal"] = buffer().normal;
  out["transparency"] = buffer().transparency;
  out["specularity"] = buffer().specularity;
  out["interface"] = layers_.interface;
  if (phase.transmission) out["transmission"] = layers_.transmission;
  if (phase.transmission)
    add_behind_depth(camera, out);
  else
    add_depth_estimates(*interface_output_, out);
  add_depth_modes(interface.pass().rasterizer, out);
  if (phase.reflection) out["reflection"] = layers_.reflection;
  add_components(config.linear_light, out);
  // Surfels of a pane are off by some centimetres and degrees, for photos show other things there.
  if (phase.reflection) panes.put_surface(out["depth"], out["normal"], PlanesPut::kNearDepth);
  if (layered_) inner_.add_maps(buffer(), backs_, out);
  mirrors.put_maps(out);
  return out;
}

}  // namespace glint

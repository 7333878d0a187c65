// SPDX-License-Identifier: MIT
#include "glint/glint_layers.h"

#include <utility>

#include "glint/render/map_ops.h"
#include "glint/render/nearer_surface_kernels.h"
#include "glint/scene/layer_maps.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block
constexpr float kLeastLight = 0.02f;  // of a pixel's, for a layer to be looked at

// What a layer lets pass; light: what gets to it, null: all; known: pixels that need none.
void pass_light(const GlassBuffer& layer, const Image* light, const Image* known, Image& passed) {
  fit(passed, layer.depth.size(), 1);
  run_kernel(
      passed.num_pixels(),
      kGrain,
      PassLight{
          layer.transparency.on_device(),
          layer.specularity.on_device(),
          light == nullptr ? nullptr : light->array().device_for_reading(),
          known == nullptr ? nullptr : known->array().device_for_reading(),
          kLeastLight,
          passed.on_device()}
  );
}

// is_pane: pixels without a gap; null: none.
void limit_behind(
    const GlassBuffer& layer, const Image& before, const Image* is_pane, float gap, Image& limit
) {
  fit(limit, layer.depth.size(), 1);
  run_kernel(
      limit.num_pixels(),
      kGrain,
      LimitBehind{
          layer.depth.on_device(),
          before.on_device(),
          is_pane == nullptr ? nullptr : is_pane->array().device_for_reading(),
          gap,
          limit.on_device()}
  );
}

}  // namespace

void InnerLayers::see(
    GlassSets sets, std::size_t m, const GlassBuffer& before, const Image& near_limit
) {
  InnerLayer& layer = layers_[m];
  const bool first = m == 0;
  pass_light(
      before,
      first ? nullptr : &layers_[m - 1].light,
      first ? call_.known_panes : nullptr,
      layer.light
  );
  limit_behind(before, near_limit, nullptr, call_.pane_gap, layer.pane_limit);
  RasterPass& interface = sets.interface.pass();
  RasterPass& transmission = sets.transmission.pass();
  layer.others =
      first ? &transmission.rasterizer.output() : &layers_[m - 1].rest.rasterizer.output();
  const RasterOutput& panes = sets.interface.forward_again(
      layer.panes, interface, call_.settings, layer.light, layer.pane_limit
  );
  const RasterOutput& surface =
      layer.nearer.pick(panes, *layer.others, channels_.transparency, layer.light);
  layer.mirrors = call_.reflection && first;
  layer.transport.set_options(
      {.channels = channels_,
       .glass_f0 = call_.glass_f0,
       .reflection = layer.mirrors,
       .detach_origins = true,
       .opaque_fresnel = false,
       .linear_light = call_.linear_light}
  );
  const GlassBuffer& buffer = layer.transport.read_interface(call_.camera, surface);
  copy_color(surface.features, layer.radiance.interface);
  if (layer.mirrors)
    layer.mirrored.trace(
        buffer,
        sets.reflection,
        call_.reflection_degree,
        call_.mirror,
        call_.step,
        layer.radiance.reflection
    );
  limit_behind(buffer, near_limit, &layer.nearer.is_pane(), call_.gap, layer.limit);
  sets.transmission.forward_again(
      layer.rest, transmission, call_.settings, layer.light, layer.limit
  );
}

const Image& InnerLayers::forward(
    GlassSets sets,
    const LayersCall& call,
    int count,
    const GlassBuffer& interface,
    const Image& near_limit
) {
  call_ = call;
  channels_ = interface_channels(sets.transmission.cloud());
  layers_.resize(static_cast<std::size_t>(count));
  for (std::size_t m = 0; m < layers_.size(); ++m) {
    const bool first = m == 0;
    see(sets,
        m,
        first ? interface : layers_[m - 1].transport.buffer(),
        first ? near_limit : layers_[m - 1].limit);
  }
  copy_color(
      layers_.back().rest.rasterizer.output().features, layers_.back().radiance.transmission
  );
  const Image* radiance = nullptr;
  for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
    if (radiance != nullptr) copy_color(*radiance, layer->radiance.transmission);
    radiance = &layer->transport.compose(layer->radiance);
  }
  return *radiance;
}

// To everything but the rasterisations; the gradient of the next layer's radiance.
const Image& InnerLayers::radiance_vjp(GlassSets sets, std::size_t m, const Image& dL_dradiance) {
  InnerLayer& layer = layers_[m];
  const GlassLayers& dL_dlayers = layer.transport.compose_vjp(layer.radiance, dL_dradiance);
  const Rays* dL_drays = nullptr;
  if (layer.mirrors)
    dL_drays = &layer.mirrored.trace_backward(sets.reflection, dL_dlayers.reflection);
  const RasterOutput& surface = layer.nearer.picked();
  clear_gradient(surface.alpha.size(), surface.features.channels(), layer.dL_dsurface);
  layer.transport.interface_vjp(call_.camera, surface, dL_drays, {}, layer.dL_dsurface);
  return dL_dlayers.transmission;
}

void InnerLayers::backward(GlassSets sets, const Image& dL_dradiance, bool interface_too) {
  const Image* dL_dnext = &dL_dradiance;
  for (std::size_t m = 0; m < layers_.size(); ++m) dL_dnext = &radiance_vjp(sets, m, *dL_dnext);
  InnerLayer& last = layers_.back();
  color_gradient(*dL_dnext, last.dL_dsurface.features.channels(), last.dL_drest);
  for (std::size_t m = 0; m < layers_.size(); ++m) {
    InnerLayer& layer = layers_[m];
    RasterOutputGradient& dL_dothers = m == 0 ? dL_dfirst_ : layers_[m - 1].dL_drest;
    layer.nearer.pick_vjp(layer.dL_dsurface, layer.dL_dpanes, dL_dothers);
    if (interface_too) sets.interface.backward(layer.dL_dpanes, layer.panes);
  }
  RasterPass& pass = sets.transmission.pass();
  const RasterGradient& first = sets.transmission.backward(dL_dfirst_, pass);
  const RasterGradient* behind = nullptr;
  for (InnerLayer& layer : layers_)
    behind = &sets.transmission.backward(layer.dL_drest, layer.rest);
  sets.transmission.observe(pass, first, *behind);
}

namespace {

// A layer as it is told.
struct SeenLayer {
  Image depth, normal, transparency;

  // In pixel i, another one's surface, which nothing shines through.
  void put_opaque(std::size_t i, const SeenLayer& other) {
    depth.data()[i] = other.depth.data()[i];
    put3(normal.data(), i, get3(other.normal.data(), i));
    transparency.data()[i] = 0;
  }
  // Behind a surface that lets little through: that surface again.
  void fill_behind_opaque(const SeenLayer& before) {
    for (std::size_t i = 0; i < depth.num_pixels(); ++i)
      if (!is_glass(before.transparency.data()[i])) put_opaque(i, before);
  }
};

// With the median depth of what was picked.
SeenLayer seen_at(const InnerLayer& layer) {
  const GlassBuffer& buffer = layer.transport.buffer();
  SeenLayer seen{layer.others->depth_median, buffer.normal, buffer.transparency};
  const Image& is_pane = layer.nearer.is_pane();
  const Image& panes = layer.panes.rasterizer.output().depth_median;
  for (std::size_t i = 0; i < seen.depth.num_pixels(); ++i)
    if (is_pane.data()[i] > 0) seen.depth.data()[i] = panes.data()[i];
  return seen;
}

SeenLayer opaque_layer(const RasterOutput& out) {
  const ImageSize size = out.alpha.size();
  return {out.depth_median, unit_normals(out.normal), Image(size.width, size.height, 1)};
}

// In pixels where a pane is known by its plane: itself as the second layer, and as the third what
// the transmission set has, which is not parted there.
void put_known(const PlaneMirrors& backs, SeenLayer& second) {
  backs.put_surface(second.depth, second.normal, PlanesPut::kAll);
  for (std::size_t i = 0; i < second.depth.num_pixels(); ++i)
    if (backs.seen()->data()[i] > 0) second.transparency.data()[i] = 1;
}
void put_behind_known(const Image& known, const RasterOutput& behind, SeenLayer& third) {
  const SeenLayer seen = opaque_layer(behind);
  for (std::size_t i = 0; i < known.num_pixels(); ++i)
    if (known.data()[i] > 0) third.put_opaque(i, seen);
}

}  // namespace

void InnerLayers::add_maps(const GlassBuffer& interface, const PlaneMirrors& backs, MapSet& out)
    const {
  SeenLayer before;
  const Image* known = backs.seen();
  for (std::size_t m = 0; m <= layers_.size(); ++m) {
    const bool is_rest = m == layers_.size();
    SeenLayer seen =
        is_rest ? opaque_layer(layers_.back().rest.rasterizer.output()) : seen_at(layers_[m]);
    if (m == 0 && known != nullptr) put_known(backs, seen);
    if (m == 1 && known != nullptr) put_behind_known(*known, *layers_.front().others, seen);
    if (m > 0) seen.fill_behind_opaque(before);
    before = std::move(seen);
    if (m + 1 == kMaxLayers) continue;  // the fifth has no map
    out[kLayerDepth[m + 1]] = before.depth;
    out[kLayerNormal[m + 1]] = before.normal;
    if (!is_rest) out[kLayerTransparency[m + 1]] = before.transparency;
  }
  out["behind_depth"] = before.depth;
  add_parts(interface, backs, out);
}

// By the first two layers; what the first mirrors is not told apart by what its rays met.
void InnerLayers::add_parts(const GlassBuffer& interface, const PlaneMirrors& backs, MapSet& out)
    const {
  const InnerLayer& second = layers_.front();
  const GlassBuffer& buffer = second.transport.buffer();
  // Of black, what backs mirror; of white, with what they leave.
  const ImageSize size = buffer.depth.size();
  Image by_backs(size.width, size.height, 3), with_white(size.width, size.height, 3, 1);
  backs.put_again(by_backs), backs.put_again(with_white);
  Image beyond = second.radiance.transmission;
  Image straight = buffer.transparency, through = straight, mirrored = straight,
        to_backs = straight;
  for (std::size_t i = 0; i < straight.num_pixels(); ++i) {
    const float light = (1 - interface.specularity.data()[i]) * interface.transparency.data()[i];
    const float left = light * (with_white.data()[3 * i] - by_backs.data()[3 * i]);
    const bool known = backs.seen() != nullptr && backs.seen()->data()[i] > 0;
    const float t = known ? 1 : buffer.transparency.data()[i];
    const float k = known ? 0 : buffer.specularity.data()[i];
    if (known) put3(beyond.data(), i, get3(second.radiance.interface.data(), i));
    straight.data()[i] = left * (1 - k) * (1 - t);
    through.data()[i] = left * (1 - k) * t;
    mirrored.data()[i] = left * k;
    to_backs.data()[i] = light;
  }
  const auto part = [&](const Image& layer, const Image& weight) {
    return part_of_picture(out["rgb"], layer, weight, call_.linear_light);
  };
  out["path_t"] = part(second.radiance.interface, straight);
  out["path_tt"] = part(beyond, through);
  if (second.mirrors)
    out["path_tr"] = part(second.radiance.reflection, mirrored);
  else if (!backs.planes.empty())
    out["path_tr"] = part(by_backs, to_backs);
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/plane_mirrors.h"

#include <limits>

#include "glint/core/kernel.h"
#include "glint/render/map_ops.h"
#include "glint/render/nearer_surface_kernels.h"
#include "glint/scene/layer_maps.h"
#include "glint/train/plane_mirrors_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

}  // namespace

void MirrorView::mark_pixels(const MirrorPlane& plane, const Image& depth) {
  const ImageSize size = call_.camera.size();
  const Mat3d& turn = call_.camera.rotation_cam_from_world;
  normal_ = cast<float>(turn * plane.normal);
  for (Image* image : {&seen_, &plane_depth_, &limit_}) fit(*image, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      SeeMirror{
          pinhole_of<float>(call_.camera),
          cast<float>(call_.camera.to_cam(plane.center)),
          normal_,
          cast<float>(turn * plane.across),
          cast<float>(turn * plane.up()),
          static_cast<float>(plane.half_width),
          static_cast<float>(plane.half_height),
          call_.gap,
          call_.f0,
          depth.on_device(),
          seen_.on_device(),
          plane_depth_.on_device(),
          limit_.on_device()}
  );
}

// Where the transmission set begins: behind the first surface. What stands in a case is of that
// set, too, and between a pane's back and the interface, so there it begins at the pane.
const Image& MirrorView::limit_behind(const Image& depth) {
  if (call_.of_backs()) return limit_;
  fit(behind_limit_, camera_.size(), 1);
  run_kernel(
      behind_limit_.num_pixels(),
      kGrain,
      LimitBehind{depth.on_device(), limit_.on_device(), nullptr, 0, behind_limit_.on_device()}
  );
  return behind_limit_;
}

void MirrorView::see(
    MirroredSets sets, const MirrorsCall& call, const MirrorPlane& plane, const Image& depth
) {
  call_ = call;
  camera_ = mirrored(call.camera, plane);
  tint_ = {plane.tint[0], plane.tint[1], plane.tint[2]};
  mark_pixels(plane, depth);
  const RasterOutput& surface =
      sets.interface.forward(interface_, camera_, call.interface_degree, call.settings, limit_);
  transport_.set_options(
      {.channels = interface_channels(sets.interface.cloud()),
       .transmission = call.transmission,
       .reflection = false,
       .linear_light = call.linear_light}
  );
  const GlassBuffer& buffer = transport_.read_interface(camera_, surface);
  copy_color(surface.features, radiance_.interface);
  if (call.transmission) {
    const RasterOutput& behind = sets.transmission.forward(
        transmission_, camera_, call.transmission_degree, {}, limit_behind(buffer.depth)
    );
    copy_color(behind.features, radiance_.transmission);
  }
  picture_ = &transport_.compose(radiance_);
  fit(dL_dpicture_, camera_.size(), 3);
}

void MirrorView::backward(MirroredSets sets, bool interface_too) {
  const GlassLayers& dL_dlayers = transport_.compose_vjp(radiance_, dL_dpicture_);
  if (call_.transmission) {
    const int features = transmission_.rasterizer.output().features.channels();
    color_gradient(dL_dlayers.transmission, features, dL_dtransmission_);
    sets.transmission.backward(dL_dtransmission_, transmission_);
  }
  if (!interface_too) return;
  const RasterOutput& surface = interface_.rasterizer.output();
  clear_gradient(camera_.size(), surface.features.channels(), dL_dinterface_);
  transport_.interface_vjp(camera_, surface, nullptr, {}, dL_dinterface_);
  sets.interface.backward(dL_dinterface_, interface_);
}

void MirrorView::put_maps(MapSet& maps) const {
  const auto put = [&](MapId id, std::size_t i, float value) {
    if (maps.has(id)) maps[id].data()[i] = value;
  };
  const auto put_vector = [&](MapId id, std::size_t i, Vec3f value) {
    if (maps.has(id)) put3(maps[id].data(), i, value);
  };
  const RasterOutput& surface = interface_.rasterizer.output();
  const RasterOutput& behind = call_.transmission ? transmission_.rasterizer.output() : surface;
  const Image normals[] = {unit_normals(surface.normal), unit_normals(behind.normal)};
  for (std::size_t i = 0; i < seen_.num_pixels(); ++i) {
    if (seen_.data()[i] <= 0) continue;
    const std::size_t there = left_to_right(i, camera_.width);
    const float t = transport_.buffer().transparency.data()[there];
    const Vec3f color = hadamard(tint_, get3(picture_->data(), there));
    put("depth", i, plane_depth_.data()[i]);
    put_vector("normal", i, normal_);
    put("transparency", i, 0);
    put("specularity", i, 1);
    for (const MapId id : {MapId("reflection"), MapId("reflected")}) put_vector(id, i, color);
    for (const MapId id :
         {MapId("transmitted"), MapId("path_t"), MapId("path_tt"), MapId("path_tr")})
      put_vector(id, i, {});
    for (std::size_t layer = 1; layer < kMaxLayers; ++layer) {
      const bool further = layer > 1 && is_glass(t);
      const Vec3f n = get3(normals[further ? 1 : 0].data(), there);
      put(kLayerDepth[layer], i, (further ? behind : surface).depth_median.data()[there]);
      put_vector(kLayerNormal[layer], i, {-n.x, n.y, n.z});
      put(kLayerTransparency[layer], i, layer == 1 ? t : 0);
    }
    put("behind_depth", i, (is_glass(t) ? behind : surface).depth_median.data()[there]);
  }
}

bool MirrorView::is_drawn_at(float z, float drawn) const {
  return drawn > 0 && z > SeeMirror::kBefore * drawn - call_.gap;
}

const Image& PlaneMirrors::put(
    MirroredSets sets, const MirrorsCall& call, const Image& depth, const Image& image
) {
  num_seen_ = 0;
  auto view = views_.begin();
  for (const MirrorPlane& plane : planes) {
    if (!is_in_view(plane, call.camera)) continue;
    if (view == views_.end()) view = views_.emplace(views_.end());
    view->see(sets, call, plane, depth);
    if (num_seen_++ == 0) {
      copy_color(image, image_);
      clear_image(seen_, image.size(), 1);
    }
    run_kernel(seen_.num_pixels(), kGrain, AddSeen{view->seen().on_device(), seen_.on_device()});
    ++view;
  }
  if (num_seen_ == 0) return image;
  put_again(image_);
  return image_;
}

void PlaneMirrors::put_surface(Image& depth, Image& normal, PlanesPut which) const {
  const Image drawn = depth;
  std::vector<float> nearest(drawn.num_pixels(), std::numeric_limits<float>::infinity());
  auto view = views_.begin();
  for (std::size_t k = 0; k < num_seen_; ++k, ++view)
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      const float z = view->depth().data()[i];
      if (z <= 0 || z >= nearest[i]) continue;
      if (which == PlanesPut::kNearDepth && !view->is_drawn_at(z, drawn.data()[i])) continue;
      depth.data()[i] = nearest[i] = z;
      put3(normal.data(), i, view->normal());
    }
}

void PlaneMirrors::put_again(Image& image) const {
  auto view = views_.begin();
  for (std::size_t k = 0; k < num_seen_; ++k, ++view)
    run_kernel(
        image.num_pixels(),
        kGrain,
        PutMirror{
            image.width(),
            view->tint(),
            view->seen().on_device(),
            view->picture().on_device(),
            image.on_device()}
    );
}

// The last one first.
template <class F>
const Image& PlaneMirrors::put_vjp_of_each(const Image& dL_dpicture, F&& mirrored) {
  if (num_seen_ == 0) return dL_dpicture;
  copy_color(dL_dpicture, dL_dimage_);
  auto view = std::next(views_.begin(), static_cast<std::ptrdiff_t>(num_seen_));
  for (std::size_t k = 0; k < num_seen_; ++k) {
    --view;
    run_kernel(
        dL_dimage_.num_pixels(),
        kGrain,
        PutMirrorVjp{
            dL_dimage_.width(),
            view->tint(),
            view->seen().on_device(),
            dL_dimage_.on_device(),
            view->gradient().on_device()}
    );
    mirrored(*view);
  }
  return dL_dimage_;
}

const Image& PlaneMirrors::put_vjp(
    MirroredSets sets, const Image& dL_dpicture, bool interface_too
) {
  return put_vjp_of_each(dL_dpicture, [&](MirrorView& v) { v.backward(sets, interface_too); });
}

const Image& PlaneMirrors::put_vjp(const Image& dL_dpicture) {
  return put_vjp_of_each(dL_dpicture, [](MirrorView&) {});
}

// The last one first.
void PlaneMirrors::take_out(Image& image) const {
  auto view = std::next(views_.begin(), static_cast<std::ptrdiff_t>(num_seen_));
  for (std::size_t k = 0; k < num_seen_; ++k) {
    --view;
    run_kernel(
        image.num_pixels(),
        kGrain,
        TakeOutMirror{
            image.width(),
            view->tint(),
            view->seen().on_device(),
            view->picture().on_device(),
            image.on_device()}
    );
  }
}

void PlaneMirrors::put_maps(MapSet& maps) const {
  auto view = views_.begin();
  for (std::size_t k = 0; k < num_seen_; ++k) (view++)->put_maps(maps);
}

}  // namespace glint

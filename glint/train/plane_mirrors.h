// SPDX-License-Identifier: MIT
// What plane mirrors show (beyond the paper): in the pixels that see one, the room as the camera
// behind it sees it, by the same sets, in the place of the transport at that pixel. So k_s is 1 and
// t is 0 there, normals that are off by a degree do no harm, and photos of a mirror train the room.
// In a mirror the interface and what is seen through it are shown, and neither what glass mirrors
// there nor another mirror. Of a pane of glass the same camera gives the radiance R that it mirrors
// [Na26 Eq. 10], in the place of the reflection set's (GlintModel::panes). A pane that is seen from
// behind, through another, mirrors Fresnel's share of what reaches it: part of what is transmitted.
#pragma once

#include <list>
#include <vector>

#include "glint/render/glass_transport.h"
#include "glint/scene/maps.h"
#include "glint/train/mirror_plane.h"
#include "glint/train/trainable_set.h"

namespace glint {

struct MirroredSets {
  TrainableSet &interface, &transmission;
};

struct MirrorsCall {
  Camera camera;
  RasterSettings settings;  // of the interface
  int interface_degree = 3, transmission_degree = 3;
  bool transmission = true;
  float gap = 0.05f;  // metres about a mirror in which nothing counts as before or behind it
  float f0 = 1;       // of what planes mirror; below 1: backs of panes, at Fresnel's share
  bool linear_light = false;
  bool of_backs() const { return f0 < 1; }
};

// One mirror in one picture.
class MirrorView {
 public:
  // depth: [H][W][1] of the first surface.
  void see(
      MirroredSets sets, const MirrorsCall& call, const MirrorPlane& plane, const Image& depth
  );
  // To the sets, from the gradient of what the camera in the mirror sees.
  void backward(MirroredSets sets, bool interface_too);
  // Replaces what `maps` have in its pixels by the mirror and, as the second surface, by what is
  // seen in it, where that appears to stand.
  void put_maps(MapSet& maps) const;

  const Image& seen() const { return seen_; }         // [H][W][1] share that is mirrored, or 0
  const Image& picture() const { return *picture_; }  // [H][W][3], mirrored left to right
  Vec3f tint() const { return tint_; }
  Vec3f normal() const { return normal_; }             // camera space
  const Image& depth() const { return plane_depth_; }  // [H][W][1] metres; 0: not seen
  Image& gradient() { return dL_dpicture_; }           // of picture()
  // Whether a first surface at `drawn` metres, 0: none, may be the plane, which is at z there.
  bool is_drawn_at(float z, float drawn) const;

 private:
  void mark_pixels(const MirrorPlane& plane, const Image& depth);
  const Image& limit_behind(const Image& depth);

  MirrorsCall call_;
  Camera camera_;  // in the mirror
  Vec3f tint_, normal_;
  Image seen_, plane_depth_, limit_, behind_limit_;
  RasterPass interface_, transmission_;
  GlassTransport transport_;
  GlassLayers radiance_;
  const Image* picture_ = nullptr;
  Image dL_dpicture_;
  RasterOutputGradient dL_dinterface_, dL_dtransmission_;
};

// Of the planes in a view: all, or those where the depth at hand is about theirs, for a viewer may
// cut their surfels away.
enum class PlanesPut { kAll, kNearDepth };

class PlaneMirrors {
 public:
  std::vector<MirrorPlane> planes;

  // The picture with what is seen in mirrors; `image` itself where none is in view. Valid until the
  // next call.
  const Image& put(
      MirroredSets sets, const MirrorsCall& call, const Image& depth, const Image& image
  );
  // Back through it to the sets; the gradient of `image`.
  const Image& put_vjp(MirroredSets sets, const Image& dL_dpicture, bool interface_too);
  // The gradient of `image` alone, for what is mirrored is a constant.
  const Image& put_vjp(const Image& dL_dpicture);
  void put_maps(MapSet& maps) const;
  // Depth [H][W][1] in metres and normals [H][W][3] of the planes, where the last put() shows one:
  // the nearest.
  void put_surface(Image& depth, Image& normal, PlanesPut which) const;
  // Puts what the last put() has put in into another picture of the same view [H][W][3].
  void put_again(Image& image) const;
  // Takes it out of one.
  void take_out(Image& image) const;
  // [H][W][1] 1 where the last picture shows a mirror; null: nowhere.
  const Image* seen() const { return num_seen_ > 0 ? &seen_ : nullptr; }

 private:
  template <class F>
  const Image& put_vjp_of_each(const Image& dL_dpicture, F&& mirrored);

  std::list<MirrorView>
      views_;  // of planes in view, in their order; those behind num_seen_: unused
  std::size_t num_seen_ = 0;
  Image image_, dL_dimage_, seen_;
};

}  // namespace glint

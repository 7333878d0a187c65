// SPDX-License-Identifier: MIT
// Glass behind glass (beyond the paper): what is seen behind the interface is itself a surface that
// lets light through and mirrors it, and so on. Layers are peeled by the near limit: a layer's
// surface is the first that stands behind the one before, of the interface set where that is a pane
// (as views from the other side know it), else of the transmission set, whose surfels have t and s
// of their own then. Each layer's radiance is Eq. 5-10 with the next layer's in the place of
// L_trans, so that of k layers with weights t_m, k_m [Na26 Eq. 10, applied k times]
//   L = sum over m <= k of [prod_{j<m} (1-k_j) t_j] {(1-k_m) (1-t_m) I_m + k_m R_m}
//       + [prod_{j<=k} (1-k_j) t_j] L_rest,
// whose weights sum to one; L_rest is the transmission set behind the last. Behind the interface
// only glass (t > 0.5) has Fresnel's term, an opaque surface has k = s: so the official code's one
// path of second order is k = 2 where t_2 = 0.
//
// Deviations: the first two layers mirror, further ones only let light through; mirrored rays meet
// the reflection set alone, for in the interface set the pane they come from and the next one are
// opaque. A layer to which less than 0.02 of a pixel's light gets is as without layers, and
// density control of the transmission set looks at the first and the last of its rasterisations.
// Where panes are known by their planes (glint/train/plane_mirrors.h), their backs mirror and no
// other second layer does; in a pixel that sees one it is the second layer, and nothing is peeled.
// Mirrors are no layer.
#pragma once

#include <vector>

#include "glint/glint_config.h"
#include "glint/render/glass_transport.h"
#include "glint/render/nearer_surface.h"
#include "glint/train/mirrored_layer.h"
#include "glint/train/plane_mirrors.h"
#include "glint/train/trainable_set.h"

namespace glint {

// What the layers behind the interface are made of.
struct GlassSets {
  TrainableSet &interface, &transmission, &reflection;
};

struct LayersCall {
  Camera camera;
  RasterSettings settings;  // of every rasterisation
  MirrorCutoffs mirror;
  bool reflection = true;  // of the second layer
  // [H][W][1] 1 where a pane is known to be the second layer, by its plane; null: nowhere. It is
  // not looked for there, and what it mirrors is put in by others.
  const Image* known_panes = nullptr;
  int reflection_degree = 3;
  std::optional<int> step;  // of training; none: a picture for someone
  // Metres behind a layer where the next one of the same set may begin; of panes it is more, for
  // around a pane there are faint surfels with its t.
  float gap = 0, pane_gap = 0;
  bool linear_light = false;
  float glass_f0 = kGlassF0;  // of glass, along its normal
};

// One of the layers behind the interface.
struct InnerLayer {
  Image light;                           // [H][W][1] share of a pixel's that gets there
  Image limit, pane_limit;               // [H][W][1] metres: behind it; before its panes
  RasterPass panes, rest;                // the interface set there, transmission behind it
  const RasterOutput* others = nullptr;  // what the transmission set has there
  NearerSurface nearer;
  GlassTransport transport;
  MirroredLayer mirrored;
  GlassLayers radiance;
  bool mirrors = false;
  RasterOutputGradient dL_dsurface, dL_dpanes, dL_drest;
};

class InnerLayers {
 public:
  // The first `count` layers behind the interface. Both sets have just been rasterised, the
  // transmission set behind near_limit. Returns the radiance that gets to the interface from
  // behind; it stays valid until the next call.
  const Image& forward(
      GlassSets sets,
      const LayersCall& call,
      int count,
      const GlassBuffer& interface,
      const Image& near_limit
  );
  // Back through it, to all sets; interface_too off: that set stays as it is.
  void backward(GlassSets sets, const Image& dL_dradiance, bool interface_too);
  // Adds the maps of the layers and of the parts of the picture; `interface`: as in forward();
  // backs: what panes mirror in what forward() has returned.
  void add_maps(const GlassBuffer& interface, const PlaneMirrors& backs, MapSet& out) const;

 private:
  void see(GlassSets sets, std::size_t m, const GlassBuffer& before, const Image& near_limit);
  const Image& radiance_vjp(GlassSets sets, std::size_t m, const Image& dL_dradiance);
  void add_parts(const GlassBuffer& interface, const PlaneMirrors& backs, MapSet& out) const;

  LayersCall call_;
  InterfaceChannels channels_;
  std::vector<InnerLayer> layers_;
  RasterOutputGradient dL_dfirst_;  // of the transmission set before the first of them
};

}  // namespace glint

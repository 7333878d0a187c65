// SPDX-License-Identifier: MIT
// GLINT's three sets of surfels and the way from them to a picture and back [Na26 Eq. 5-10]: the
// interface rasterised to a G-buffer, transmission seen straight through it, reflection traced
// along mirrored rays.
#pragma once

#include <optional>

#include "glint/glint_config.h"
#include "glint/glint_layers.h"
#include "glint/method.h"
#include "glint/render/glass_transport.h"
#include "glint/train/given_surface.h"
#include "glint/train/mirrored_layer.h"
#include "glint/train/plane_mirrors.h"
#include "glint/train/trainable_set.h"

namespace glint {

// What of the model takes part, and at which SH degree.
struct GlintPhase {
  bool transmission = true, reflection = true;
  int interface_degree = 3, transmission_degree = 3, reflection_degree = 3;
  std::optional<int> step;        // of training; none: a picture for someone
  bool planes = false;            // the interface's plane distances are wanted
  const MapSet* truth = nullptr;  // the true surface of the view, for an oracle; null: none
};

class GlintModel {
 public:
  TrainableSet interface, transmission, reflection;
  // What is seen in mirrors; and in panes of glass, as the radiance that they mirror.
  PlaneMirrors mirrors, panes;

  // Of mirrors and panes.
  std::vector<MirrorPlane> planes() const;
  void set_planes(const std::vector<MirrorPlane>& planes);

  // The picture [H][W][3]; it and the buffers below stay valid until the next call.
  const Image& forward(const Camera& camera, const GlintConfig& config, const GlintPhase& phase);
  // Back through the last forward call, to all sets that took part. dL_dinterface holds, and is
  // added to, the gradient of losses on the interface's maps; dL_dtransparency that of t (may be
  // empty). `interface_too` off: the interface stays as it is.
  void backward(
      const Image& dL_dimage,
      const Image& dL_dtransparency,
      bool interface_too,
      RasterOutputGradient& dL_dinterface
  );
  const RasterOutput& interface_output() const { return *interface_output_; }
  // [H][W][1] expected depth of the interface's surfels, metres; 0: none.
  const Image& interface_depth();
  const GlassBuffer& buffer() const { return transport_.buffer(); }
  const GlassLayers& layers() const { return layers_; }
  // How mirrors are seen, as in forward() with these.
  MirrorsCall mirrors_call(const Camera& camera, const GlintConfig& config, const GlintPhase& phase)
      const;
  // Of a photo of the last view, what came through: without what panes mirror by the last forward
  // call; the photo itself where none is in view.
  const Image& without_panes(const Image& photo);
  // Of the last forward call: what rasterised the transmission set; null: nothing, or it was
  // traced.
  RasterPass* transmission_pass() { return rasterized_ ? &transmission.pass() : nullptr; }

  // All maps of a view (docs/reference/records.md).
  MapSet render(const Camera& camera, const GlintConfig& config, const GlintPhase& phase);

 private:
  RasterSettings interface_settings(const GlintConfig& config, bool with_planes) const;
  const Image& compose(
      const Camera& camera, const GlintConfig& config, const GlintPhase& phase, bool with_behind
  );
  void render_reflection(const GlintConfig& config, const MirrorsCall& call);
  void render_transmission(const Camera& camera, const GlintConfig& config, bool with_behind);
  void add_backs(const GlintConfig& config, const Image& depth);
  void add_inner_layers(const GlintConfig& config);
  void transmission_vjp(const Image& dL_dradiance, bool interface_too);
  void add_behind_depth(const Camera& camera, MapSet& out);
  void add_components(bool linear_light, MapSet& out) const;

  Camera camera_;  // of the last forward call, as is the phase
  GlintPhase phase_;
  GlassTransport transport_;
  const RasterOutput* interface_output_ = nullptr;
  const RasterOutput* surface_ = nullptr;  // that output, or what was given for it
  GivenSurface given_;
  Image own_depth_;          // of the surfels, where the surface was given
  bool rasterized_ = false;  // the transmission set
  bool layered_ = false;     // by inner_
  InnerLayers inner_;
  GlassLayers layers_;
  PlaneMirrors backs_;  // of panes
  Image through_photo_;
  Image near_limit_;
  Rays through_;
  RasterPass behind_pass_;
  RasterOutputGradient dL_dtransmission_;
  MirroredLayer mirrored_;
  TraceOutputGradient dL_dthrough_;  // of the transmission set
};

}  // namespace glint

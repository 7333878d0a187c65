// SPDX-License-Identifier: MIT
// A trained method as the viewer shows it: its layers of a look, as values and as pictures.
#pragma once

#include <string>
#include <vector>

#include "glint/method.h"
#include "reports/show/pictures/layers.h"
#include "reports/show/viewer/look.h"

namespace glint {

// The surfels of a loaded method on one side of a plane alone. The others stay, with an opacity
// that shows nowhere.
class CutSets {
 public:
  explicit CutSets(Method& method) : sets_(method.sets()) {}
  void apply(const std::optional<CutPlane>& cut);

 private:
  std::vector<MethodSet> sets_;
  std::vector<FloatArray> whole_;  // opacity logits of each, while something is cut
  std::optional<CutPlane> now_;
};

class ViewedRun {
 public:
  struct Names {
    std::string name, method, title;
    fs::path folder;
  };
  // Borrowed; `training`: the method is being trained, so nothing of it may be changed.
  ViewedRun(Names names, Method& method, const Scene& scene, bool training);

  const Names& names() const { return names_; }
  Method& method() { return method_; }
  std::size_t num_surfels() const { return method_.num_surfels(); }

  // Everything that the run has of this look, seen by `camera`; `snapped`: whose view it is, which
  // brings "error" and "angle". Errors (kUsage): a cut where nothing may be changed.
  LayerMaps layers(const Look& look, const Camera& camera, const View* snapped);
  // For a camera that moves: only what this layer needs, as quickly as the method can
  // (Method::render_quickly()).
  LayerMaps layers_for(const std::string& layer, const Look& look, const Camera& camera);
  // [H][W][3] in [0, 1]; mid-grey where the run has no such layer here.
  Image picture(const LayerMaps& maps, const std::string& layer, ImageSize size) const;

  // Looks again which layers there are: those of a training become more. Whether they changed.
  bool find_layers();

  // The run's part of the page's first message.
  Json json() const;

 private:
  MapSet maps(const Look& look, const Camera& camera, const View* snapped);

  Names names_;
  Method& method_;
  const Scene& scene_;
  bool training_;
  CutSets cut_;
  DepthScale scale_;
  std::vector<PageLayer> layers_;
  std::vector<std::string> scales_;
};

}  // namespace glint

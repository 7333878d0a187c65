// SPDX-License-Identifier: MIT
#include "reports/show/viewer/viewed_run.h"

#include <algorithm>

#include "glint/train/trainable_set.h"
#include "reports/run/bench/path_frames.h"
#include "reports/show/viewer/surfel_drawing.h"

namespace glint {

namespace {

constexpr float kHidden = -30;  // logit of an opacity that shows nowhere
constexpr float kUnknown = 0.5f;
constexpr ImageSize kProbeSize{64, 36};  // of the render that tells which layers there are

// Of what a method rendered; `view` tells which truth there is.
std::vector<PageLayer> layers_in(const MapSet& found, const View& view) {
  std::vector<PageLayer> layers;
  for (const MapRow& row : maps_in(found)) {
    layers.push_back(layer_of(row));
    if (row.id != "rgb") continue;
    if (!without_glass(found).empty()) layers.push_back(layer_without_glass());
    layers.push_back({"error", "Error", LayerStyle::kError});
  }
  if (view.truth.has("normal") && found.has("normal"))
    layers.push_back({"angle", "Angle error", LayerStyle::kAngle});
  return layers;
}

bool needs_view(const PageLayer& layer) { return layer.id == "error" || layer.id == "angle"; }

// The method renders quickly while it lives.
class QuickRenders {
 public:
  explicit QuickRenders(Method& method) : method_(method) { method_.render_quickly(true); }
  ~QuickRenders() { method_.render_quickly(false); }
  QuickRenders(const QuickRenders&) = delete;
  QuickRenders& operator=(const QuickRenders&) = delete;

 private:
  Method& method_;
};

void hide(const CutPlane& cut, SurfelCloud& cloud) {
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (is_cut(cut, get3(cloud.means.data(), i))) cloud.opacity_logits.data()[i] = kHidden;
}

bool is_same(const std::optional<CutPlane>& a, const std::optional<CutPlane>& b) {
  if (!a || !b) return !a && !b;
  return length2(a->normal - b->normal) == 0 && a->offset == b->offset;
}

std::vector<MethodSet> without(
    std::vector<MethodSet> sets, const std::vector<std::string>& hidden
) {
  std::erase_if(sets, [&](const MethodSet& set) {
    return std::find(hidden.begin(), hidden.end(), set.name) != hidden.end();
  });
  return sets;
}

}  // namespace

void CutSets::apply(const std::optional<CutPlane>& cut) {
  if (is_same(cut, now_)) return;
  now_ = cut;
  const bool begins = whole_.empty();
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    SurfelCloud& cloud = sets_[s].set->cloud();
    if (begins) whole_.push_back(cloud.opacity_logits);
    cloud.opacity_logits = whole_[s];
    if (cut) hide(*cut, cloud);
  }
  if (!cut) whole_.clear();
}

ViewedRun::ViewedRun(Names names, Method& method, const Scene& scene, bool training)
    : names_(std::move(names)), method_(method), scene_(scene), training_(training), cut_(method) {
  std::vector<Camera> cameras;
  for (const View& view : scene.train) cameras.push_back(view.camera);
  scale_ = path_depth_scale(method, scene, cameras);
  find_layers();
}

bool ViewedRun::find_layers() {
  const View& view = scene_.test.empty() ? scene_.train.front() : scene_.test.front();
  const MapSet found = method_.render(resized(view.camera, kProbeSize));
  const std::size_t before = layers_.size();
  layers_ = layers_in(found, view);
  scales_ = scales_of(found);
  return layers_.size() != before;
}

MapSet ViewedRun::maps(const Look& look, const Camera& camera, const View* snapped) {
  if (look.style != SurfelStyle::kImage)
    return draw_surfels(without(method_.sets(), look.hidden), camera, look.style, look.cut);
  GLINT_CHECK(
      !look.cut || !training_, kUsage, "cut: nothing is cut from a model that is being trained"
  );
  if (!training_) cut_.apply(look.cut);
  return snapped != nullptr ? method_.render_view(*snapped) : method_.render(camera);
}

LayerMaps ViewedRun::layers(const Look& look, const Camera& camera, const View* snapped) {
  MapSet found = maps(look, camera, snapped);
  LayerMaps layers;
  if (Image away = without_glass(found); !away.empty())
    layers[layer_without_glass().id] = std::move(away);
  found["rgb"] = with_scales(found, look.scales);
  for (const MapRow& row : maps_in(found)) layers[std::string(row.id)] = std::move(found[row]);
  if (snapped != nullptr) add_errors(*snapped, layers);
  return layers;
}

LayerMaps ViewedRun::layers_for(const std::string& layer, const Look& look, const Camera& camera) {
  const QuickRenders quick(method_);
  const bool picture_alone =
      layer == "rgb" && look.scales == LightScales{} && look.style == SurfelStyle::kImage;
  if (!picture_alone) return layers(look, camera, nullptr);
  if (!training_) cut_.apply(look.cut);
  LayerMaps maps;
  maps["rgb"] = method_.picture(camera);
  return maps;
}

Image ViewedRun::picture(const LayerMaps& maps, const std::string& layer, ImageSize size) const {
  const auto map = maps.find(layer);
  const auto known = std::find_if(layers_.begin(), layers_.end(), [&](const PageLayer& known) {
    return known.id == layer;
  });
  if (map != maps.end() && known != layers_.end())
    return layer_picture(*known, map->second, scale_);
  Image grey;
  fit(grey, size, 3);
  std::fill(grey.values().begin(), grey.values().end(), kUnknown);
  return grey;
}

Json ViewedRun::json() const {
  Json layers = layers_json(layers_, scale_);
  for (std::size_t i = 0; i < layers_.size(); ++i)
    if (needs_view(layers_[i])) layers[i]["needs_view"] = true;
  Json surfels = Json::object();
  for (const MethodSet& set : method_.sets()) surfels[set.name] = set.set->cloud().size();
  const bool drawn = !surfels.empty();
  return {
      {"name", names_.name},
      {"method", names_.method},
      {"title", names_.title},
      {"folder", names_.folder.string()},
      {"surfels", surfels},
      {"total", method_.num_surfels()},
      {"layers", layers},
      {"scales", scales_},
      {"styles", drawn ? Json{"image", "discs", "points"} : Json{"image"}},
      {"cut", drawn && !training_}};
}

}  // namespace glint

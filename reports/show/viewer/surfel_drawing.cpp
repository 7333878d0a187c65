// SPDX-License-Identifier: MIT
#include "reports/show/viewer/surfel_drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/parallel.h"
#include "glint/render/map_ops.h"
#include "glint/render/project.h"
#include "glint/train/trainable_set.h"

namespace glint {

namespace {

constexpr float kFaintest = 0.05f, kNear = 0.01f;  // opacity; metres
constexpr float kDiscRho = 1;                      // squared radius of a disc, sigma squared
constexpr float kPointReach = 1.5f;                // pixels
constexpr int kBandRows = 16;
constexpr float kDarkest = 0.4f;  // of the colour, seen from the side

struct Mark {
  ProjectedSurfel<float> shape;
  Vec3f color;
  bool seen = false;
};

CameraOf<float> camera_of(const Camera& c) {
  return {
      cast<float>(c.rotation_cam_from_world),
      cast<float>(c.translation_cam_from_world),
      static_cast<float>(c.fx),
      static_cast<float>(c.fy),
      static_cast<float>(c.cx),
      static_cast<float>(c.cy),
      static_cast<float>(c.width),
      static_cast<float>(c.height),
      kNear};
}

SurfelGeometry<float> geometry_of(const SurfelCloud& cloud, std::size_t i) {
  const float* s = cloud.log_scales.data() + 2 * i;
  const float* q = cloud.rotations.data() + 4 * i;
  return {get3(cloud.means.data(), i), {std::exp(s[0]), std::exp(s[1])}, {q[0], q[1], q[2], q[3]}};
}

Vec3f color_of(const SurfelCloud& cloud, std::size_t i) {
  const Vec3f dc = get3(cloud.sh_dc.data(), i);
  const auto shown = [](float c) { return std::clamp(0.5f + kSh0 * c, 0.0f, 1.0f); };
  return {shown(dc.x), shown(dc.y), shown(dc.z)};
}

// A square of kPointReach about the centre.
void make_point(const CameraOf<float>& camera, Vec3f mean, ProjectedSurfel<float>& shape) {
  const Vec3f m = camera.rotation * mean + camera.translation;
  const float x = camera.fx * m.x / m.z + camera.cx, y = camera.fy * m.y / m.z + camera.cy;
  shape.box_min_x = x - kPointReach, shape.box_max_x = x + kPointReach;
  shape.box_min_y = y - kPointReach, shape.box_max_y = y + kPointReach;
}

class Drawing {
 public:
  Drawing(const Camera& camera, SurfelStyle style) : camera_(camera_of(camera)), style_(style) {
    clear_image(maps_["rgb"], camera.size(), 3);
    clear_image(maps_["depth"], camera.size(), 1);
    clear_image(maps_["normal"], camera.size(), 3);
  }

  void draw(const SurfelCloud& cloud, const std::optional<CutPlane>& cut) {
    marks_.resize(cloud.size());
    parallel_for(cloud.size(), 1024, [&](std::size_t i) { marks_[i] = mark_of(cloud, i, cut); });
    const int height = maps_["rgb"].height();
    const auto bands = static_cast<std::size_t>((height + kBandRows - 1) / kBandRows);
    parallel_for(bands, 1, [&](std::size_t band) {
      const int first = static_cast<int>(band) * kBandRows;
      for (const Mark& mark : marks_)
        if (mark.seen) draw_rows(mark, first, std::min(height, first + kBandRows));
    });
  }

  MapSet take() { return std::move(maps_); }

 private:
  Mark mark_of(const SurfelCloud& cloud, std::size_t i, const std::optional<CutPlane>& cut) const {
    Mark mark;
    const SurfelGeometry<float> geometry = geometry_of(cloud, i);
    if (cut && is_cut(*cut, geometry.mean)) return mark;
    if (sigmoid(cloud.opacity_logits.data()[i]) < kFaintest) return mark;
    mark.shape = project_surfel(geometry, camera_, kDiscRho);
    if (style_ == SurfelStyle::kPoints) make_point(camera_, geometry.mean, mark.shape);
    mark.seen = mark.shape.z_center > kNear && mark.shape.box_max_x > 0 &&
                mark.shape.box_min_x < camera_.width;
    mark.color = color_of(cloud, i);
    return mark;
  }

  void draw_rows(const Mark& mark, int first, int end) {
    const ProjectedSurfel<float>& s = mark.shape;
    const auto from = [](float low, int least) {
      return std::max(least, static_cast<int>(std::ceil(std::max(low, -1e6f) - 0.5f)));
    };
    const auto to = [](float high, int most) {
      return std::min(most, static_cast<int>(std::floor(std::min(high, 1e6f) - 0.5f)) + 1);
    };
    const int x_end = to(s.box_max_x, static_cast<int>(camera_.width));
    for (int y = from(s.box_min_y, first), y_end = to(s.box_max_y, end); y < y_end; ++y)
      for (int x = from(s.box_min_x, 0); x < x_end; ++x) put(mark, x, y);
  }

  // Where the disc is not hit: 0.
  float depth_at(const ProjectedSurfel<float>& s, int x, int y) const {
    if (style_ == SurfelStyle::kPoints) return s.z_center;
    const float dx = static_cast<float>(x) + 0.5f - s.x_ref;
    const float dy = static_cast<float>(y) + 0.5f - s.y_ref;
    const PlaneHit<float> hit = intersect(zeta_at(s.map, dx, dy), s.map.det);
    return squared_radius(hit) <= kDiscRho && hit.t > kNear ? hit.t : 0.0f;
  }

  void put(const Mark& mark, int x, int y) {
    const float depth = depth_at(mark.shape, x, y);
    float& nearest = maps_["depth"].at(x, y);
    if (!(depth > 0) || (nearest > 0 && nearest <= depth)) return;
    nearest = depth;
    const Vec3f n = mark.shape.normal;
    const float light = kDarkest + (1 - kDarkest) * std::abs(n.z);
    for (int c = 0; c < 3; ++c) {
      maps_["rgb"].at(x, y, c) = light * mark.color[c];
      maps_["normal"].at(x, y, c) = n[c];
    }
  }

  CameraOf<float> camera_;
  SurfelStyle style_;
  std::vector<Mark> marks_;
  MapSet maps_;
};

}  // namespace

bool is_cut(const CutPlane& cut, Vec3f mean) {
  return dot(cut.normal, cast<double>(mean)) > cut.offset;
}

MapSet draw_surfels(
    const std::vector<MethodSet>& sets,
    const Camera& camera,
    SurfelStyle style,
    const std::optional<CutPlane>& cut
) {
  Drawing drawing(camera, style);
  for (const MethodSet& set : sets) drawing.draw(set.set->cloud(), cut);
  return drawing.take();
}

}  // namespace glint

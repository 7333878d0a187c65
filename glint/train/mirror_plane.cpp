// SPDX-License-Identifier: MIT
#include "glint/train/mirror_plane.h"

#include <cmath>

#include "glint/core/config.h"

namespace glint {

namespace {

constexpr int kLooks = 8;  // points of the rectangle, along each side
constexpr double kUnit = 1e-6;

std::array<double, 3> numbers(Vec3d v) { return {v.x, v.y, v.z}; }

// MirrorPlane as JSON has it.
struct StoredMirror {
  std::array<double, 3> center{}, normal{}, across{};
  double half_width = 0, half_height = 0, likeness = 0, outlined = 0;
  std::array<float, 3> tint{};
  bool pane = false;

  template <class V>
  void visit(V&& v) {
    v("center", center, "world, metres");
    v("normal", normal, "unit, to where it is seen from");
    v("across", across, "unit, along its width");
    v("half_width", half_width, "metres");
    v("half_height", half_height, "metres");
    v("tint", tint, "displayed values, times this");
    v("likeness", likeness, "correlation with the photos when it was found");
    v("outlined", outlined, "agreement of outlines by which a pane was placed; 0: was not");
    v("pane", pane, "true: of glass");
  }
  MirrorPlane plane() const {
    const auto vec = [](const std::array<double, 3>& a) { return Vec3d{a[0], a[1], a[2]}; };
    return {
        vec(center),
        vec(normal),
        vec(across),
        half_width,
        half_height,
        tint,
        likeness,
        outlined,
        pane};
  }
};

bool is_rectangle(const MirrorPlane& p) {
  const double size = p.half_width * p.half_height, place = length2(p.center);
  return std::isfinite(size) && std::isfinite(place) && p.half_width > 0 && p.half_height > 0 &&
         std::abs(length2(p.normal) - 1) < kUnit && std::abs(length2(p.across) - 1) < kUnit &&
         std::abs(dot(p.normal, p.across)) < kUnit;
}

MirrorPlane mirror_of(const Json& json, const std::string& file) {
  GLINT_CHECK(json.is_object(), kBadPrediction, "{}: expected a list of objects", file);
  StoredMirror stored;
  config_from_json(stored, json, file);
  const MirrorPlane plane = stored.plane();
  GLINT_CHECK(
      is_rectangle(plane),
      kBadPrediction,
      "{}: {} is no rectangle: expected sides above 0 and unit vectors at a right angle; train "
      "again",
      file,
      json.dump()
  );
  return plane;
}

}  // namespace

Camera mirrored(const Camera& camera, const MirrorPlane& plane) {
  Camera result = camera;
  result.cx = camera.width - camera.cx;
  const Vec3d n = plane.normal;
  const Vec3d turned = camera.rotation_cam_from_world * n;
  for (int i = 0; i < 3; ++i) {
    const double sign = i == 0 ? -1 : 1;  // left to right
    Vec3d& row = result.rotation_cam_from_world.rows[i];
    row = sign * (row - (2 * turned[i]) * n);
  }
  Vec3d& t = result.translation_cam_from_world;
  t += (2 * dot(n, plane.center)) * turned;
  t.x = -t.x;
  return result;
}

bool is_in_view(const MirrorPlane& plane, const Camera& camera) {
  if (plane.signed_distance(camera.center()) <= 0) return false;
  for (int i = -kLooks; i <= kLooks; ++i)
    for (int j = -kLooks; j <= kLooks; ++j) {
      const Vec3d at = camera.to_cam(
          plane.center + (i * plane.half_width / kLooks) * plane.across +
          (j * plane.half_height / kLooks) * plane.up()
      );
      if (at.z <= 0) continue;
      const Vec2d p = camera.project(at);
      if (p.x >= 0 && p.y >= 0 && p.x < camera.width && p.y < camera.height) return true;
    }
  return false;
}

std::string mirrors_text(const std::vector<MirrorPlane>& planes) {
  Json list = Json::array();
  for (const MirrorPlane& p : planes)
    list.push_back(config_to_json(StoredMirror{
        numbers(p.center),
        numbers(p.normal),
        numbers(p.across),
        p.half_width,
        p.half_height,
        p.likeness,
        p.outlined,
        p.tint,
        p.pane}));
  return list.dump(1) + "\n";
}

std::vector<MirrorPlane> mirrors_of(const std::string& text, const std::string& file) {
  const Json list = parse_json(text);
  GLINT_CHECK(list.is_array(), kBadPrediction, "{}: expected a JSON list of mirrors", file);
  return with_exit_code(ExitCode::kBadPrediction, [&] {
    std::vector<MirrorPlane> planes;
    for (const Json& json : list) planes.push_back(mirror_of(json, file));
    return planes;
  });
}

}  // namespace glint

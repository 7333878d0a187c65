// SPDX-License-Identifier: MIT
#include "tests/support/box_room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"

namespace glint::test {
namespace {

constexpr Vec3d kRoom{4.0, 3.0, 2.5};
constexpr Vec3d kPillarLow{1.8, 1.35, 0.0}, kPillarHigh{2.2, 1.65, 1.4};

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  Vec3d normal{};  // towards the origin of the ray
};

// First wall along a ray that starts inside.
Hit hit_wall(Vec3d origin, Vec3d direction) {
  Hit hit;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const double wall = direction[axis] > 0 ? kRoom[axis] : 0;
    const double t = (wall - origin[axis]) / direction[axis];
    if (t >= hit.t) continue;
    hit.t = t;
    hit.normal = {};
    hit.normal[axis] = direction[axis] > 0 ? -1 : 1;
  }
  return hit;
}

// Entry into the pillar of a ray that starts outside; t is infinite when it passes by.
Hit hit_pillar(Vec3d origin, Vec3d direction) {
  Hit enter;
  enter.t = 0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const bool forward = direction[axis] > 0;
    const double near =
        ((forward ? kPillarLow : kPillarHigh)[axis] - origin[axis]) / direction[axis];
    const double far =
        ((forward ? kPillarHigh : kPillarLow)[axis] - origin[axis]) / direction[axis];
    leave = std::min(leave, far);
    if (near <= enter.t) continue;
    enter.t = near;
    enter.normal = {};
    enter.normal[axis] = forward ? -1 : 1;
  }
  return enter.t < leave && enter.t > 0 ? enter : Hit{};
}

Vec3f wall_color(Vec3d p) {
  const auto wave = [](double v) { return static_cast<float>(0.5 + 0.4 * std::sin(v)); };
  return {wave(3 * p.x + p.z), wave(4 * p.y - p.x), wave(5 * p.z + 2 * p.y)};
}

void set(Image& image, int x, int y, Vec3f value) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = value[c];
}

View box_room_view(std::string name, const Camera& camera) {
  View view;
  view.name = std::move(name);
  view.camera = camera;
  view.rgb = view.truth["normal"] = Image(camera.width, camera.height, 3);
  view.truth["depth"] = Image(camera.width, camera.height, 1);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3d direction = camera.ray_in_world(x + 0.5, y + 0.5);
      const Hit wall = hit_wall(camera.center(), direction);
      const Hit pillar = hit_pillar(camera.center(), direction);
      const Hit& hit = pillar.t < wall.t ? pillar : wall;
      view.truth["depth"].at(x, y) = static_cast<float>(hit.t);
      set(view.truth["normal"], x, y, cast<float>(camera.rotation_cam_from_world * hit.normal));
      set(view.rgb, x, y, wall_color(camera.center() + hit.t * direction));
    }
  view.priors["normal"] = view.truth["normal"];
  return view;
}

template <class Values>
std::string yaml_matrix(const std::string& key, int rows, int cols, const Values& values) {
  std::string text;
  for (const double value : values)
    text += fmt::format("{}{:.17g}", text.empty() ? "" : ", ", value);
  return fmt::format(
      "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
      key,
      rows,
      cols,
      text
  );
}

std::string yaml_names(const std::vector<View>& views) {
  std::string text = "%YAML:1.0\n---\nnames:\n";
  for (const View& view : views) text += fmt::format("   - \"{}\"\n", view.name);
  return text;
}

Image encode_normal(const Image& normal) {
  Image encoded = normal;
  for (float& value : encoded.values()) value = 0.5f * value + 0.5f;
  return encoded;
}

PointCloud wall_points(const std::vector<View>& views) {
  PointCloud points;
  for (const View& view : views)
    for (int y = 1; y < view.truth["depth"].height(); y += 8)  // tests change the camera's size
      for (int x = 1; x < view.truth["depth"].width(); x += 8) {
        const double z = static_cast<double>(view.truth["depth"].at(x, y));
        const Vec3d p = view.camera.to_world(z * view.camera.ray_in_cam(x + 0.5, y + 0.5));
        points.positions.push_back(cast<float>(p));
        points.colors.push_back(wall_color(p));
      }
  return points;
}

}  // namespace

std::vector<View> box_room_views(int count, ImageSize size, double step) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) {
    const double angle = step * i;
    const Vec3d eye{
        2.0 + 0.9 * std::cos(angle), 1.5 + 0.7 * std::sin(angle), 1.2 + 0.05 * std::min(i, 20)};
    const Vec3d target{2.0 - std::cos(angle), 1.5 - std::sin(angle), 0.8};
    views.push_back(
        box_room_view(fmt::format("{:04}", i), look_at(eye, target, {0, 0, 1}, size, 75))
    );
  }
  return views;
}

std::string intri_yml(const std::vector<View>& views) {
  std::string text = yaml_names(views);
  for (const View& view : views) {
    const Camera& c = view.camera;
    const double k[] = {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
    const double d[] = {0, 0, 0, 0, 0};
    text += yaml_matrix("K_" + view.name, 3, 3, k) + yaml_matrix("D_" + view.name, 5, 1, d);
    text += fmt::format("H_{}: {}\nW_{}: {}\n", view.name, c.height, view.name, c.width);
  }
  return text;
}

std::string extri_yml(const std::vector<View>& views) {
  std::string text = yaml_names(views);
  for (const View& view : views) {
    std::vector<double> rotation;
    for (const Vec3d& row : view.camera.rotation_cam_from_world.rows)
      rotation.insert(rotation.end(), {row.x, row.y, row.z});
    const Vec3d& t = view.camera.translation_cam_from_world;
    text += yaml_matrix("Rot_" + view.name, 3, 3, rotation);
    text += yaml_matrix("T_" + view.name, 3, 1, std::vector<double>{t.x, t.y, t.z});
  }
  return text;
}

void write_easyvolcap(const fs::path& folder, const std::vector<View>& views) {
  write_file(folder / "intri.yml", intri_yml(views));
  write_file(folder / "extri.yml", extri_yml(views));
  write_point_ply(folder / "sparse/0/points3D.ply", wall_points(views));
  for (const View& view : views) {
    write_png(folder / "images" / view.name / "000000.png", view.rgb);
    write_exr(folder / "gt/depth" / (view.name + ".exr"), view.truth["depth"]);
    write_exr(folder / "gt/normal" / (view.name + ".exr"), view.truth["normal"], true);
    const fs::path prior = fs::path(view.name) / "000000.png";
    write_png(folder / "diffrens/normal" / prior, encode_normal(view.priors["normal"]));
    Image relative = view.truth["depth"];
    for (float& value : relative.values()) value *= 0.2f;
    write_png(folder / "diffrens/depth" / prior, relative);
  }
}

void write_nerfstudio(const fs::path& folder, const std::vector<View>& views) {
  const Camera& first = views.front().camera;
  Json json;
  json["w"] = first.width;
  json["h"] = first.height;
  json["fl_x"] = first.fx;
  json["fl_y"] = first.fy;
  json["cx"] = first.cx;
  json["cy"] = first.cy;
  json["frames"] = Json::array();
  for (const View& view : views) {
    write_png(folder / "images" / (view.name + ".png"), view.rgb);
    const Mat3d& r = view.camera.rotation_cam_from_world;
    const Vec3d c = view.camera.center();
    Json matrix = Json::array();
    for (int i = 0; i < 3; ++i)
      matrix.push_back({r.rows[0][i], -r.rows[1][i], -r.rows[2][i], c[i]});
    matrix.push_back({0, 0, 0, 1});
    json["frames"].push_back(
        {{"file_path", "images/" + view.name + ".png"},
         {"transform_matrix", matrix},
         {"sharpness", 31.5}}
    );
  }
  write_file(folder / "transforms.json", json.dump(1));
}

}  // namespace glint::test

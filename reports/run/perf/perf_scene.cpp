// SPDX-License-Identifier: MIT
#include "reports/run/perf/perf_scene.h"

#include <cmath>

#include "glint/core/rng.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/scene/ply.h"

namespace glint {

namespace {

constexpr Vec3f kHalfRoom{2.5f, 1.5f, 2.5f};  // metres

struct SurfacePoint {
  Vec3f position;
  int axis;  // of the wall's normal
};

// Uniform over the six walls by area.
SurfacePoint random_wall_point(Rng& rng) {
  const float areas[3] = {
      kHalfRoom.y * kHalfRoom.z, kHalfRoom.x * kHalfRoom.z, kHalfRoom.x * kHalfRoom.y};
  float pick = rng.uniform() * (areas[0] + areas[1] + areas[2]);
  int axis = 0;
  while (axis < 2 && pick > areas[axis]) pick -= areas[axis++];
  Vec3f p;
  for (int k = 0; k < 3; ++k) p[k] = kHalfRoom[k] * rng.uniform(-1, 1);
  p[axis] = p[axis] > 0 ? kHalfRoom[axis] : -kHalfRoom[axis];
  return {p, axis};
}

// Turns z to the wall's normal (a half turn about the bisector), with a tilt of a few degrees.
Vec4f wall_rotation(int axis, Rng& rng) {
  const float h = 0.70710678f;
  Vec4f q{axis == 2 ? 1.0f : h, axis == 1 ? h : 0.0f, axis == 0 ? h : 0.0f, 0};
  return {q.w, q.x + 0.05f * rng.normal(), q.y + 0.05f * rng.normal(), q.z + 0.3f * rng.normal()};
}

// Random colours, with every prior that a method asks for; its middle is glass.
View perf_view(const std::string& name, const Vec3d& eye, const PerfOptions& options) {
  const int width = options.width, height = options.height;
  View view;
  view.name = name;
  view.camera = look_at(eye, {0, 0, 2}, {0, -1, 0}, {width, height}, 75);
  view.rgb = Image(width, height, 3);
  Rng rng(2);
  for (float& value : view.rgb.values()) value = rng.uniform(0.3f, 0.6f);
  Image& normal = view.priors["normal"] = Image(width, height, 3);
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) normal.data()[3 * i + 2] = -1;
  Image& depth = view.priors["depth"] = Image(width, height, 1);
  for (float& value : depth.values()) value = rng.uniform(0.2f, 0.8f);
  Image& albedo = view.priors["albedo"] = Image(width, height, 3, 0.3f);
  view.priors["basecolor"] = albedo;
  Image& glass = view.priors["glass"] = Image(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = width / 4; x < width - width / 4; ++x) {
      glass.at(x, y) = 1;
      std::fill_n(albedo.pixel(x, y), 3, 0.0f);
    }
  return view;
}

}  // namespace

SurfelCloud perf_cloud(const PerfOptions& options) {
  Rng rng(1, hash_name("perf"));
  SurfelCloud cloud;
  cloud.resize(options.surfels);
  const float area =
      8 * (kHalfRoom.y * kHalfRoom.z + kHalfRoom.x * kHalfRoom.z + kHalfRoom.x * kHalfRoom.y);
  const float spacing = 0.5f * std::sqrt(area / static_cast<float>(options.surfels));
  for (std::size_t i = 0; i < options.surfels; ++i) {
    const SurfacePoint point = random_wall_point(rng);
    const Vec4f q = wall_rotation(point.axis, rng);
    for (int k = 0; k < 3; ++k) {
      cloud.means[3 * i + k] = point.position[k] + 0.01f * rng.normal();
      cloud.sh_dc[3 * i + k] = rng.uniform(-1, 1);
    }
    const float rotation[4] = {q.w, q.x, q.y, q.z};
    std::copy_n(rotation, 4, &cloud.rotations[4 * i]);
    for (int k = 0; k < 2; ++k)
      cloud.log_scales[2 * i + k] = std::log(options.overlap * spacing * rng.uniform(0.4f, 1.2f));
    cloud.opacity_logits[i] =
        logit(rng.uniform() < 0.6f ? rng.uniform(0.7f, 0.99f) : rng.uniform(0.05f, 0.7f));
    for (int k = 0; k < 45; ++k) cloud.sh_rest[45 * i + k] = 0.05f * rng.normal();
  }
  return cloud;
}

Scene perf_scene(const PerfOptions& options) {
  Scene scene;
  scene.name = "perf";
  scene.spatial_scale = 2.5f;
  scene.bounds_min = -1.0f * kHalfRoom;
  scene.bounds_max = kHalfRoom;
  scene.train.push_back(perf_view("0", {0.5, 0.2, -2.2}, options));
  scene.train.push_back(perf_view("1", {0.7, 0.2, -2.2}, options));
  const SurfelCloud cloud = perf_cloud(options);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    scene.points.positions.push_back(
        {cloud.means[3 * i], cloud.means[3 * i + 1], cloud.means[3 * i + 2]}
    );
    scene.points.colors.push_back({0.5f, 0.5f, 0.5f});
  }
  return scene;
}

void write_perf_scene(const PerfOptions& options, const fs::path& folder) {
  write_surfel_ply(folder / "surfels.ply", perf_cloud(options));
  const Camera camera = perf_scene(options).train.front().camera;
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) {
    const Vec3d r = camera.rotation_cam_from_world.rows[i];
    rows.push_back({r.x, r.y, r.z, camera.translation_cam_from_world[i]});
  }
  const Json json = {
      {"width", camera.width},
      {"height", camera.height},
      {"fx", camera.fx},
      {"fy", camera.fy},
      {"cx", camera.cx},
      {"cy", camera.cy},
      {"cam_from_world", rows}};
  write_file(folder / "camera.json", json.dump(2) + "\n");
}

}  // namespace glint

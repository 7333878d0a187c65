// SPDX-License-Identifier: MIT
#include "datasets/check_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace glint {
namespace {

constexpr std::size_t kEnoughSamples = 200;
constexpr double kAgreement = 0.05;  // relative

// A grid of about 64 x 64 pixels is plenty for medians and means.
int sample_step(ImageSize size) { return std::max(1, std::max(size.width, size.height) / 64); }

// Camera-space point of pixel (x, y) whose stored depth is `depth`.
Vec3d unproject(const Camera& camera, int x, int y, double depth, DepthKind kind) {
  const Vec3d ray = camera.ray_in_cam(x + 0.5, y + 0.5);
  return (kind == DepthKind::kPlanar ? depth : depth / length(ray)) * ray;
}

double stored_depth_of(Vec3d cam, DepthKind kind) {
  return kind == DepthKind::kPlanar ? cam.z : length(cam);
}

// A corner of a triangle, in the axes of the camera that looks at it.
struct Corner {
  Vec3d point;
  Vec2d pixel;
};

using Triangle = std::array<Corner, 3>;

// Where the camera's ray through `pixel` meets the triangle; nothing when it passes beside it.
// Image-space weights of a point on a plane are those of point / z.
std::optional<Vec3d> hit_point(const Triangle& t, Vec2d pixel) {
  const auto twice_area = [](Vec2d a, Vec2d b, Vec2d c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const double area = twice_area(t[0].pixel, t[1].pixel, t[2].pixel);
  Vec3d sum{};
  double inverse_z = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double weight = twice_area(pixel, t[(i + 1) % 3].pixel, t[(i + 2) % 3].pixel) / area;
    if (!(weight >= 0)) return std::nullopt;
    sum += (weight / t[i].point.z) * t[i].point;
    inverse_z += weight / t[i].point.z;
  }
  return (1 / inverse_z) * sum;
}

// The pixel of the image that holds the middle of the triangle.
std::optional<std::array<int, 2>> middle_pixel(const Triangle& t, ImageSize size) {
  const double x = (t[0].pixel.x + t[1].pixel.x + t[2].pixel.x) / 3;
  const double y = (t[0].pixel.y + t[1].pixel.y + t[2].pixel.y) / 3;
  if (!(x >= 0 && y >= 0 && x < size.width && y < size.height)) return std::nullopt;
  return std::array{static_cast<int>(x), static_cast<int>(y)};
}

// A map of `from` as a surface: triangles between neighbouring pixels. A map is point samples, so
// what is thinner than a pixel shows in one view and not in the other; only where four neighbours
// lie on one surface is it known to fill the space between them.
class CarriedSurface {
 public:
  CarriedSurface(const Camera& from, ImageView depth, const Camera& to, DepthKind kind)
      : from_(from), depth_(depth), to_(to), kind_(kind) {}

  // The two triangles of the cell between pixels (x, y) and (x + 1, y + 1), seen by `to`; none
  // beside edges and holes, and behind `to`.
  std::vector<Triangle> cell(int x, int y) const {
    if (!is_one_surface(x, y)) return {};
    std::array<Corner, 4> corners;
    for (int i = 0; i < 4; ++i) {
      Corner& corner = corners[static_cast<std::size_t>(i)];
      corner = seen(x + i % 2, y + i / 2);
      if (!(corner.point.z > kNearest)) return {};
    }
    return {{corners[0], corners[1], corners[2]}, {corners[3], corners[2], corners[1]}};
  }

 private:
  static constexpr double kSmooth = 0.02;  // relative; below kAgreement, so that no cell bridges it
  static constexpr double kNearest = 1e-6;

  // Either nearly at one depth, or on a plane with the pixels around them.
  bool is_one_surface(int x, int y) const {
    const auto [low, high] = std::minmax(
        {depth_.at(x, y), depth_.at(x + 1, y), depth_.at(x, y + 1), depth_.at(x + 1, y + 1)}
    );
    if (!(low > 0)) return false;
    return static_cast<double>(high) < (1 + kSmooth) * static_cast<double>(low) || is_plane(x, y);
  }

  // 1 / depth is linear in the image of a plane, however slanted: its second differences vanish.
  bool is_plane(int x, int y) const {
    if (x < 1 || y < 1 || x + 2 >= depth_.width || y + 2 >= depth_.height) return false;
    for (const int v : {y, y + 1})
      for (const int u : {x, x + 1})
        if (!(bend(u, v, 1, 0) < kSmooth) || !(bend(u, v, 0, 1) < kSmooth)) return false;
    return true;
  }

  // Second difference of 1 / depth at (x, y) along (dx, dy), relative; not a number beside holes.
  double bend(int x, int y, int dx, int dy) const {
    const auto inverse = [&](int u, int v) {
      const double depth = static_cast<double>(depth_.at(u, v));
      return depth > 0 ? 1 / depth : std::numeric_limits<double>::quiet_NaN();
    };
    const double center = inverse(x, y);
    return std::abs(inverse(x - dx, y - dy) + inverse(x + dx, y + dy) - 2 * center) / center;
  }

  Corner seen(int x, int y) const {
    const double depth = static_cast<double>(depth_.at(x, y));
    const Vec3d point = to_.to_cam(from_.to_world(unproject(from_, x, y, depth, kind_)));
    return {point, to_.project(point)};
  }

  const Camera& from_;
  ImageView depth_;
  const Camera& to_;
  DepthKind kind_;
};

// Relative difference of the carried surface to what `to` stores at the pixel below the triangle's
// middle; negative: in front of it. Nothing when the triangle lies between pixels.
std::optional<double> carried_difference(
    const Triangle& triangle, ImageView to_depth, DepthKind kind
) {
  const auto pixel = middle_pixel(triangle, to_depth.size());
  if (!pixel) return std::nullopt;
  const double stored = static_cast<double>(to_depth.at((*pixel)[0], (*pixel)[1]));
  if (!(stored > 0)) return std::nullopt;
  const auto point = hit_point(triangle, {(*pixel)[0] + 0.5, (*pixel)[1] + 0.5});
  if (!point) return std::nullopt;
  return stored_depth_of(*point, kind) / stored - 1;
}

Vec3d normal_at(ImageView normal, int x, int y) {
  const float* n = normal.pixel(x, y);
  return cast<double>(Vec3f{n[0], n[1], n[2]});
}

Vec3d flip(Vec3d n, int pattern) {
  for (int axis = 0; axis < 3; ++axis)
    if ((pattern >> axis & 1) != 0) n[axis] = -n[axis];
  return n;
}

}  // namespace

std::optional<Vec3d> normal_from_depth(
    const Camera& camera, ImageView depth, int x, int y, DepthKind kind
) {
  constexpr double kBend = 0.01;  // second difference of depth, relative
  const auto z = [&](int dx, int dy) { return static_cast<double>(depth.at(x + dx, y + dy)); };
  const double center = z(0, 0);
  for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
    const double before = z(-dx, -dy), after = z(dx, dy);
    if (!(before > 0 && after > 0 && center > 0)) return std::nullopt;
    if (std::abs(before + after - 2 * center) > kBend * center) return std::nullopt;
  }
  const auto point = [&](int dx, int dy) {
    return unproject(camera, x + dx, y + dy, z(dx, dy), kind);
  };
  const Vec3d normal = cross(point(0, 1) - point(0, -1), point(1, 0) - point(-1, 0));
  const double norm = length(normal);
  if (!(norm > 0)) return std::nullopt;
  const double toward = dot(normal, point(0, 0)) > 0 ? -1 : 1;
  return (toward / norm) * normal;
}

void DepthAgreement::add_pair(
    const Camera& from, ImageView from_depth, const Camera& to, ImageView to_depth
) {
  for (const DepthKind kind : {DepthKind::kPlanar, DepthKind::kRayLength})
    add_reading(from, from_depth, to, to_depth, kind);
}

void DepthAgreement::add_reading(
    const Camera& from, ImageView from_depth, const Camera& to, ImageView to_depth, DepthKind kind
) {
  Reading& reading = readings_[static_cast<std::size_t>(kind)];
  const CarriedSurface surface(from, from_depth, to, kind);
  const int step = sample_step(from.size());
  for (int y = (step - 1) / 2; y + 1 < from.height; y += step)
    for (int x = (step - 1) / 2; x + 1 < from.width; x += step)
      for (const Triangle& triangle : surface.cell(x, y)) {
        const auto difference = carried_difference(triangle, to_depth, kind);
        if (!difference) continue;
        ++reading.num_tested;
        if (*difference < -kAgreement) ++reading.num_in_front;
        if (std::abs(*difference) <= kAgreement)
          reading.differences.push_back(std::abs(*difference));
      }
}

double DepthAgreement::share_in_front(DepthKind kind) const {
  const Reading& reading = of(kind);
  return static_cast<double>(reading.num_in_front) /
         static_cast<double>(std::max<std::size_t>(reading.num_tested, 1));
}

double DepthAgreement::median_error(DepthKind kind) const {
  std::vector<double> differences = of(kind).differences;
  if (differences.empty()) return 0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle;
}

DepthKind DepthAgreement::best() const {
  const bool ray_fits =
      of(DepthKind::kRayLength).differences.size() >= kEnoughSamples &&
      median_error(DepthKind::kRayLength) < 0.5 * median_error(DepthKind::kPlanar);
  return ray_fits ? DepthKind::kRayLength : DepthKind::kPlanar;
}

void NormalAgreement::add_view(
    const Camera& camera, ImageView depth, DepthKind kind, ImageView normal
) {
  const int step = sample_step(camera.size());
  for (int y = 1 + step / 2; y < camera.height - 1; y += step)
    for (int x = 1 + step / 2; x < camera.width - 1; x += step) {
      const Vec3d stored = normal_at(normal, x, y);
      if (std::abs(length(stored) - 1) > 0.1) continue;
      const std::optional<Vec3d> expected = normal_from_depth(camera, depth, x, y, kind);
      if (!expected) continue;
      ++num_samples_;
      for (int pattern = 0; pattern < 8; ++pattern)
        cosines_[static_cast<std::size_t>(pattern)] += dot(flip(stored, pattern), *expected);
      world_cosine_ += dot(camera.rotation_cam_from_world * stored, *expected);
    }
}

double NormalAgreement::mean_cosine(int pattern) const {
  return cosines_[static_cast<std::size_t>(pattern)] /
         static_cast<double>(std::max<std::size_t>(num_samples_, 1));
}

double NormalAgreement::mean_cosine_world() const {
  return world_cosine_ / static_cast<double>(std::max<std::size_t>(num_samples_, 1));
}

int NormalAgreement::best_pattern() const {
  constexpr double kMargin = 0.1;
  int best = 0;
  for (int pattern = 1; pattern < 8; ++pattern)
    if (mean_cosine(pattern) > mean_cosine(best)) best = pattern;
  return mean_cosine(best) > mean_cosine(0) + kMargin ? best : 0;
}

std::string flipped_axes(int pattern) {
  std::string axes;
  for (int axis = 0; axis < 3; ++axis)
    if ((pattern >> axis & 1) != 0)
      axes += (axes.empty() ? "" : " and ") + std::string(1, "xyz"[axis]);
  return axes.empty() ? "none" : axes;
}

double facing_share(const Camera& camera, ImageView normal) {
  std::size_t facing = 0, all = 0;
  const int step = sample_step(camera.size());
  for (int y = step / 2; y < camera.height; y += step)
    for (int x = step / 2; x < camera.width; x += step) {
      const Vec3d n = normal_at(normal, x, y);
      if (length2(n) == 0) continue;
      ++all;
      if (dot(n, camera.ray_in_cam(x + 0.5, y + 0.5)) < 0) ++facing;
    }
  return all == 0 ? 1 : static_cast<double>(facing) / static_cast<double>(all);
}

}  // namespace glint

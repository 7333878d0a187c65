// SPDX-License-Identifier: MIT
#include "tests/support/reference_render.h"

#include <algorithm>
#include <cmath>

#include "glint/core/parallel.h"

namespace glint::test {
namespace {

constexpr double kCutoffSigmas = 3.0;
constexpr double kMinAlpha = 1.0 / 255.0;
constexpr double kMaxAlpha = 0.99;
constexpr double kMinTransmittance = 1e-4;
constexpr double kMedianTransmittance = 0.5;
constexpr double kLowPassInverseSquare = 2.0;
constexpr double kTinyDepth = 1e-9;  // metres, floor of a divisor

Vec3d triple(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

struct UnitQuaternion {
  double w;
  Vec3d xyz;
};

UnitQuaternion unit_quaternion(const std::vector<double>& values, std::size_t i) {
  const Vec3d v{values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]};
  const double w = values[4 * i];
  const double norm = std::hypot(w, length(v));
  return {w / norm, (1 / norm) * v};
}

// q p q* by two cross products.
Vec3d rotate(const UnitQuaternion& q, Vec3d p) {
  const Vec3d twice = 2.0 * cross(q.xyz, p);
  return p + q.w * twice + cross(q.xyz, twice);
}

// The image interval of an ellipse's coordinate x / z, where x = x0 + x1 cos + x2 sin over the
// ellipse and z alike. A line x = s z touches the ellipse iff (x0 - s z0)^2 = (x1 - s z1)^2 + (x2 -
// s z2)^2: the ends are the roots s of this quadratic a s^2 - 2 b s + c = 0.
struct Interval {
  double center, half_extent;
};
Interval projected_interval(Vec3d x, Vec3d z) {
  const double a = z.x * z.x - z.y * z.y - z.z * z.z;
  const double b = x.x * z.x - x.y * z.y - x.z * z.z;
  const double c = x.x * x.x - x.y * x.y - x.z * x.z;
  return {b / a, std::sqrt(std::max(0.0, b * b - a * c)) / std::abs(a)};
}

void find_box(ReferenceSurfel& s, const Camera& camera) {
  const Vec3d p = camera.to_cam(s.mean);
  const Vec3d u = kCutoffSigmas * s.scale_u * (camera.rotation_cam_from_world * s.axis_u);
  const Vec3d v = kCutoffSigmas * s.scale_v * (camera.rotation_cam_from_world * s.axis_v);
  s.center_depth = p.z;
  s.camera_plane_margin = 1 - (u.z * u.z + v.z * v.z) / (p.z * p.z);
  s.has_low_pass = s.camera_plane_margin > 0;
  if (!s.has_low_pass) return;
  const Interval x = projected_interval({p.x, u.x, v.x}, {p.z, u.z, v.z});
  const Interval y = projected_interval({p.y, u.y, v.y}, {p.z, u.z, v.z});
  s.box_center = {camera.fx * x.center + camera.cx, camera.fy * y.center + camera.cy};
  s.box_half_extent = {camera.fx * x.half_extent, camera.fy * y.half_extent};
}

void keep_min(double& smallest, double value) { smallest = std::min(smallest, value); }

// A surfel counts when every margin is positive; it is as far from changing sides as its smallest
// margin, or, when it does not count, as the worst of the tests it fails.
double accept_distance(double rho_margin, double alpha_margin, double z_margin) {
  return std::abs(std::min({rho_margin, alpha_margin, z_margin}));
}

double ndc_depth(double z, const RasterSettings& settings) {
  const auto near = static_cast<double>(settings.distortion_near);
  const auto far = static_cast<double>(settings.distortion_far);
  return far / (far - near) * (1 - near / z);
}

}  // namespace

ReferenceInput reference_input(const RasterInput& input) {
  const auto doubles = [](std::span<const float> values) {
    return std::vector<double>(values.begin(), values.end());
  };
  ReferenceInput result;
  result.count = input.count;
  result.channels = input.channels;
  result.means = doubles(input.means);
  result.scales = doubles(input.scales);
  result.rotations = doubles(input.rotations);
  result.opacities = doubles(input.opacities);
  result.features = doubles(input.features);
  result.near_limit = input.near_limit.view();
  return result;
}

ReferenceSurfel reference_surfel(const ReferenceInput& input, std::size_t i, const Camera& camera) {
  const UnitQuaternion q = unit_quaternion(input.rotations, i);
  ReferenceSurfel s;
  s.index = i;
  s.mean = triple(input.means, i);
  s.axis_u = rotate(q, {1, 0, 0});
  s.axis_v = rotate(q, {0, 1, 0});
  s.normal = rotate(q, {0, 0, 1});
  s.scale_u = input.scales[2 * i];
  s.scale_v = input.scales[2 * i + 1];
  s.opacity = input.opacities[i];
  find_box(s, camera);
  const bool away = dot(s.normal, s.mean - camera.center()) > 0;
  s.plane_distance = std::abs(dot(s.normal, s.mean - camera.center()));
  s.normal_in_cam = camera.rotation_cam_from_world * ((away ? -1.0 : 1.0) * s.normal);
  return s;
}

ReferenceHit reference_hit(const ReferenceSurfel& s, const Camera& camera, Vec2d point) {
  const Vec3d origin = camera.center();
  const Vec3d direction = camera.ray_in_world(point.x, point.y);  // camera z 1: t is planar depth
  ReferenceHit hit;
  if (s.has_low_pass) {
    const Vec2d d = point - s.box_center;
    hit.rho2 = kLowPassInverseSquare * (d.x * d.x + d.y * d.y);
  }
  const double slope = dot(s.normal, direction);
  if (slope == 0) return hit;
  hit.t = dot(s.normal, s.mean - origin) / slope;
  const Vec3d offset = origin + hit.t * direction - s.mean;
  hit.u = dot(s.axis_u, offset) / s.scale_u;
  hit.v = dot(s.axis_v, offset) / s.scale_v;
  hit.rho3 = hit.u * hit.u + hit.v * hit.v;
  return hit;
}

double Cutoffs::nearest_jump() const { return std::min({accept, branch, transmittance, order}); }
double Cutoffs::nearest_jump_or_median() const { return std::min(nearest_jump(), median); }
double Cutoffs::nearest_of_all() const { return std::min(nearest_jump_or_median(), clamp); }

struct ReferenceRenderer::Contribution {
  const ReferenceSurfel* surfel;
  double alpha, z;
};

ReferenceRenderer::ReferenceRenderer(
    const ReferenceInput& input, const Camera& camera, const RasterSettings& settings
)
    : input_(input), camera_(camera), settings_(settings) {
  for (std::size_t i = 0; i < input.count; ++i)
    surfels_.push_back(reference_surfel(input, i, camera));
  std::stable_sort(
      surfels_.begin(),
      surfels_.end(),
      [](const ReferenceSurfel& a, const ReferenceSurfel& b) {
        return static_cast<float>(a.center_depth) < static_cast<float>(b.center_depth);
      }
  );
}

bool ReferenceRenderer::contribution(
    const ReferenceSurfel& s, int x, int y, Vec2d shift, Contribution& out, Cutoffs& cutoffs
) const {
  const Vec2d point{x + 0.5, y + 0.5};
  const ReferenceHit there = reference_hit(s, camera_, point);
  const ReferenceHit hit = reference_hit(s, camera_, point - shift);
  const double rho = std::min(hit.rho3, hit.rho2);
  const double unclamped = s.opacity * std::exp(-rho / 2);
  const double z = there.low_pass() ? s.center_depth : there.t;
  const double limit =
      input_.near_limit.empty() ? -Cutoffs::kNone : static_cast<double>(input_.near_limit.at(x, y));
  const double near = std::max(static_cast<double>(settings_.near_plane), limit);
  // Signed relative distances; a value on the cut-off counts for rho and alpha, not for z.
  const double rho_margin = 1 - rho / square(kCutoffSigmas);
  const double alpha_margin = unclamped / kMinAlpha - 1;
  const double z_margin = (z - near) / std::max(std::abs(near), kTinyDepth);
  keep_min(cutoffs.accept, accept_distance(rho_margin, alpha_margin, z_margin));
  if (!(rho_margin >= 0 && alpha_margin >= 0)) return false;
  keep_min(cutoffs.branch, std::abs(hit.rho3 - hit.rho2) / (1 + rho));
  keep_min(cutoffs.branch, std::abs(s.camera_plane_margin));
  if (!(z_margin > 0)) return false;
  keep_min(cutoffs.clamp, std::abs(unclamped / kMaxAlpha - 1));
  out = {&s, std::min(kMaxAlpha, unclamped), z};
  return true;
}

ReferencePixel ReferenceRenderer::pixel(int x, int y, const FootprintShift& shift) const {
  ReferencePixel result;
  result.features.assign(static_cast<std::size_t>(input_.channels), 0.0);
  std::vector<std::pair<double, double>> weighted_depths;  // (w, m) of the distortion so far
  double transmittance = 1, previous_depth = -Cutoffs::kNone;
  for (const ReferenceSurfel& s : surfels_) {
    Contribution hit;
    const Vec2d by = s.index == shift.surfel ? shift.by : Vec2d{0, 0};
    if (!contribution(s, x, y, by, hit, result.cutoffs)) continue;
    const double after = transmittance * (1 - hit.alpha);
    keep_min(result.cutoffs.transmittance, std::abs(after / kMinTransmittance - 1));
    if (after < kMinTransmittance) break;

    const double w = hit.alpha * transmittance;
    for (std::size_t c = 0; c < result.features.size(); ++c)
      result.features[c] += w * input_.features[s.index * result.features.size() + c];
    result.alpha += w;
    result.depth_sum += w * hit.z;
    result.normal += w * s.normal_in_cam;
    result.plane_distance += w * s.plane_distance;
    result.weights.emplace_back(s.index, w);
    result.depths.push_back(hit.z);
    if (transmittance > kMedianTransmittance) result.owners.push_back(s.index);

    keep_min(result.cutoffs.median, std::abs(transmittance / kMedianTransmittance - 1));
    if (transmittance > kMedianTransmittance) result.depth_median = hit.z;

    const double m = ndc_depth(hit.z, settings_);
    for (const auto& [w_before, m_before] : weighted_depths)
      result.distortion += w * w_before * square(m - m_before);
    weighted_depths.emplace_back(w, m);

    const double gap = s.center_depth - previous_depth;
    if (gap != 0)
      keep_min(result.cutoffs.order, gap / std::max(std::abs(s.center_depth), kTinyDepth));
    previous_depth = s.center_depth;
    transmittance = after;
  }
  return result;
}

ReferenceOutput reference_render(
    const ReferenceInput& input, const Camera& camera, const RasterSettings& settings
) {
  const ReferenceRenderer renderer(input, camera, settings);
  ReferenceOutput output{camera.width, camera.height, {}, {}, {}};
  output.pixels.resize(camera.size().num_pixels());
  output.visibility.assign(input.count, 0.0);
  output.owned_pixels.assign(input.count, 0.0);
  parallel_for(output.pixels.size(), 64, [&](std::size_t i) {
    const auto width = static_cast<std::size_t>(camera.width);
    output.pixels[i] = renderer.pixel(static_cast<int>(i % width), static_cast<int>(i / width));
  });
  for (const ReferencePixel& pixel : output.pixels) {
    for (const auto& [surfel, w] : pixel.weights) output.visibility[surfel] += w;
    for (const std::size_t surfel : pixel.owners) output.owned_pixels[surfel] += 1;
  }
  return output;
}

double reference_loss(const ReferencePixel& p, std::size_t i, const RasterOutputGradient& g) {
  const auto weight = [](const Image& map, std::size_t j) {
    return map.empty() ? 0.0 : static_cast<double>(map.values()[j]);
  };
  double loss = 0;
  for (std::size_t c = 0; c < p.features.size(); ++c)
    loss += weight(g.features, i * p.features.size() + c) * p.features[c];
  for (int k = 0; k < 3; ++k)
    loss += weight(g.normal, 3 * i + static_cast<std::size_t>(k)) * p.normal[k];
  return loss + weight(g.alpha, i) * p.alpha + weight(g.depth_sum, i) * p.depth_sum +
         weight(g.depth_median, i) * p.depth_median + weight(g.distortion, i) * p.distortion +
         weight(g.plane_distance, i) * p.plane_distance;
}

double reference_loss(const ReferenceOutput& output, const RasterOutputGradient& g) {
  double loss = 0;
  for (std::size_t i = 0; i < output.pixels.size(); ++i)
    loss += reference_loss(output.pixels[i], i, g);
  return loss;
}

}  // namespace glint::test

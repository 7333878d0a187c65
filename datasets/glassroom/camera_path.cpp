// SPDX-License-Identifier: MIT
#include "datasets/glassroom/camera_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "glint/core/error.h"

namespace glint {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kLaps = 2;
constexpr int kAngles = 360;      // samples of the clearance profile
constexpr int kSmoothing = 22;    // samples to each side
constexpr int kPosesPerView = 6;  // candidates of which the views are chosen

// Free distance from the container's axis for each angle, at the heights that cameras take.
std::vector<double> free_radius(
    const PathTracer& tracer, Vec3d center, const CameraPathOptions& options
) {
  std::vector<double> radius(kAngles, options.max_radius);
  for (int a = 0; a < kAngles; ++a) {
    const double angle = 2 * kPi * a / kAngles;
    const Vec3f direction = cast<float>(Vec3d{std::cos(angle), std::sin(angle), 0});
    for (const double height :
         {0.9,
          options.low_height,
          0.5 * (options.low_height + options.high_height),
          options.high_height}) {
      // From the smallest radius outwards: what stands nearer is the container itself.
      const Vec3f start = cast<float>(
          center +
          Vec3d{options.min_radius * std::cos(angle), options.min_radius * std::sin(angle), height}
      );
      const auto hit = tracer.first_hit(start, direction, true);
      if (hit.hit) {
        const double free = options.min_radius + static_cast<double>(hit.t) - options.clearance;
        radius[static_cast<std::size_t>(a)] = std::min(radius[static_cast<std::size_t>(a)], free);
      }
    }
  }
  return radius;
}

// Running minimum, then running mean: a smooth curve that stays below the given one.
std::vector<double> smooth_below(const std::vector<double>& values) {
  const int n = static_cast<int>(values.size());
  const auto window = [&](const std::vector<double>& in, int half, auto&& fold, double start) {
    std::vector<double> out(in.size());
    for (int i = 0; i < n; ++i) {
      double folded = start;
      for (int k = -half; k <= half; ++k)
        folded = fold(folded, in[static_cast<std::size_t>((i + k + n) % n)]);
      out[static_cast<std::size_t>(i)] = folded;
    }
    return out;
  };
  const auto low = window(
      values,
      kSmoothing,
      [](double a, double b) { return std::min(a, b); },
      std::numeric_limits<double>::infinity()
  );
  std::vector<double> mean = window(
      low, kSmoothing, [](double a, double b) { return a + b; }, 0.0
  );
  for (double& value : mean) value /= 2 * kSmoothing + 1;
  return mean;
}

double interpolated(const std::vector<double>& periodic, double turns) {
  const double x = (turns - std::floor(turns)) * static_cast<double>(periodic.size());
  const auto i = static_cast<std::size_t>(x) % periodic.size();
  const double t = x - std::floor(x);
  return (1 - t) * periodic[i] + t * periodic[(i + 1) % periodic.size()];
}

// The curve over s in [0, 1): both laps.
class Path {
 public:
  Path(
      const PathTracer& tracer, const Bounds& container, const CameraPathOptions& options, Rng& rng
  )
      : options_(options),
        center_(cast<double>(container.center())),
        start_(static_cast<double>(rng.uniform())),
        sway_(static_cast<double>(rng.uniform(0, 6.28f))) {
    radius_ = smooth_below(free_radius(tracer, {center_.x, center_.y, 0}, options));
  }

  Camera camera(double s) const {
    const double turns = start_ + kLaps * s, angle = 2 * kPi * turns;
    const double height = std::cos(2 * kPi * s);  // one swing over the two laps closes the curve
    const double z = std::lerp(options_.low_height, options_.high_height, 0.5 - 0.5 * height);
    const double breath = 0.94 + 0.06 * std::cos(2 * kPi * 3 * s + sway_);
    const double r = std::max(options_.min_radius, breath * interpolated(radius_, turns));
    const Vec3d eye{center_.x + r * std::cos(angle), center_.y + r * std::sin(angle), z};
    const Vec3d target = center_ + Vec3d{
                                       0.12 * std::cos(2 * angle + sway_),
                                       0.12 * std::sin(3 * angle + sway_),
                                       0.05 + 0.06 * std::sin(2 * kPi * 2 * s + sway_)};
    return look_at(eye, target, {0, 0, 1}, options_.size, options_.fov_x_deg);
  }

 private:
  const CameraPathOptions& options_;
  Vec3d center_;
  double start_, sway_;
  std::vector<double> radius_;
};

bool usable(
    const PathTracer& tracer,
    const Bounds& room,
    const Bounds& container,
    const CameraPathOptions& options,
    const Camera& camera
) {
  const Vec3d eye = camera.center();
  return room.grown(-static_cast<float>(options.clearance) * 0.7f).contains(cast<float>(eye)) &&
         (!options.above_floor || options.above_floor({eye.x, eye.y})) &&
         !container.grown(0.3f).contains(cast<float>(eye)) &&
         nearest_surface(tracer, eye) > 0.6 * options.clearance &&
         container_visibility(tracer, container, camera) >= options.min_visible;
}

}  // namespace

double nearest_surface(const PathTracer& tracer, Vec3d point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const Vec3d direction = normalize(Vec3d{double(x), double(y), double(z)});
        const auto hit = tracer.first_hit(cast<float>(point), cast<float>(direction), false);
        if (hit.hit) nearest = std::min(nearest, static_cast<double>(hit.t));
      }
  return nearest;
}

double container_visibility(
    const PathTracer& tracer, const Bounds& container, const Camera& camera
) {
  constexpr int kGrid = 4;
  const Vec3f eye = cast<float>(camera.center());
  int seen = 0;
  for (int i = 0; i < kGrid * kGrid * kGrid; ++i) {
    const auto along = [&](int k) { return (static_cast<float>(k) + 0.5f) / kGrid; };
    const Vec3f size = container.size();
    const Vec3f point = container.low + Vec3f{
                                            size.x * along(i % kGrid),
                                            size.y * along(i / kGrid % kGrid),
                                            size.z * along(i / kGrid / kGrid)};
    const Vec3d in_cam = camera.to_cam(cast<double>(point));
    if (in_cam.z <= 0) continue;
    const Vec2d pixel = camera.project(in_cam);
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= camera.width || pixel.y >= camera.height) continue;
    // Things in the container do not count as obstacles: they are what is to be seen.
    const auto hit = tracer.first_hit(eye, point - eye, true);
    if (!hit.hit || hit.t >= 1 || container.grown(0.01f).contains(hit.position)) ++seen;
  }
  return static_cast<double>(seen) / (kGrid * kGrid * kGrid);
}

std::vector<Camera> camera_path(
    const PathTracer& tracer,
    const Bounds& room,
    const Bounds& container,
    const CameraPathOptions& options,
    Rng& rng
) {
  const Path path(tracer, container, options, rng);
  const int candidates = std::max(120, kPosesPerView * options.views);
  std::vector<Camera> good;
  for (int i = 0; i < candidates; ++i) {
    const Camera camera = path.camera(static_cast<double>(i) / candidates);
    if (usable(tracer, room, container, options, camera)) good.push_back(camera);
  }
  GLINT_CHECK(
      4 * static_cast<int>(good.size()) >= candidates &&
          static_cast<int>(good.size()) >= options.views,
      kEnvironment,
      "camera path: only {} of {} poses see the container; try another seed",
      good.size(),
      candidates
  );
  std::vector<Camera> cameras;
  for (int i = 0; i < options.views; ++i)
    cameras.push_back(
        good[static_cast<std::size_t>(i) * good.size() / static_cast<std::size_t>(options.views)]
    );
  return cameras;
}

}  // namespace glint

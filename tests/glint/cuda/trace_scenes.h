// SPDX-License-Identifier: MIT
// Scenes on which the cost of tracing is counted, and what counting takes.
#pragma once

#include <vector>

#include "glint/cuda/ops.h"
#include "glint/render/glass_transport.h"
#include "tests/support/host_exec.h"
#include "tests/support/trace_arrays.h"

namespace glint::test {

// Of a room 6 x 5 x 3 m, as training leaves them: overlapping surfels in a few layers within
// centimetres of the walls and of boxes that stand in it, most of them nearly opaque.
class RoomScene {
 public:
  explicit RoomScene(std::size_t count, std::uint64_t seed = 3) : rng_(seed) {
    for (std::size_t i = 0; i < count; ++i) add_to_face(faces()[i % faces().size()]);
  }
  // Metres across.
  void add_large(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d mean{uniform(rng_, 0, 6), uniform(rng_, 0, 5), uniform(rng_, 0, 3)};
      const Vec2d scale{uniform(rng_, 0.3, 1.5), uniform(rng_, 0.3, 1.5)};
      arrays.add(mean, scale, random_unit_quaternion(rng_), uniform(rng_, 0.01, 0.1), rng_);
    }
  }
  void add_outlier() {
    arrays.add({1000, 0, 0}, {0.05, 0.05}, random_unit_quaternion(rng_), 0.5, rng_);
  }
  // Anywhere, fainter than what counts.
  void add_dead(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d mean{uniform(rng_, 0, 6), uniform(rng_, 0, 5), uniform(rng_, 0, 3)};
      arrays.add(mean, {0.05, 0.05}, random_unit_quaternion(rng_), 0.001, rng_);
    }
  }

  TraceArrays arrays;

 private:
  struct Face {
    Vec3d corner, along_u, along_v;
  };
  static const std::vector<Face>& faces() {
    static const std::vector<Face> all = [] {
      std::vector<Face> faces;
      add_box({0, 0, 0}, {6, 5, 3}, faces);
      add_box({1, 1, 0}, {2, 1.8, 0.8}, faces);
      add_box({3.5, 3, 0}, {4.6, 4.2, 1.4}, faces);
      return faces;
    }();
    return all;
  }
  static void add_box(Vec3d low, Vec3d high, std::vector<Face>& faces) {
    const Vec3d size = high - low;
    const Vec3d edges[3] = {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}};
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3d u = edges[(axis + 1) % 3], v = edges[(axis + 2) % 3];
      faces.push_back({low, u, v});
      faces.push_back({low + edges[axis], u, v});
    }
  }
  void add_to_face(const Face& face) {
    const Vec3d u = normalize(face.along_u), v = normalize(face.along_v), n = cross(u, v);
    const Vec3d mean = face.corner + uniform(rng_, 0, 1) * face.along_u +
                       uniform(rng_, 0, 1) * face.along_v +
                       0.01 * static_cast<double>(rng_.normal()) * n;
    const double size = log_uniform(rng_, 0.01, 0.06);
    const double opacity = uniform(rng_, 0, 1) < 0.6 ? uniform(rng_, 0.7, 1) : uniform(rng_, 0, 1);
    arrays.add(mean, {size, size * log_uniform(rng_, 0.5, 2)}, facing(n), opacity, rng_);
  }
  // A rotation that takes z to about n.
  Vec4<double> facing(Vec3d n) {
    const auto tilt = [&] { return 0.05 * static_cast<double>(rng_.normal()); };
    const Vec3d to = normalize(n + Vec3d{tilt(), tilt(), tilt()});
    const Vec3d half = normalize(to + Vec3d{0, 0, 1.000001});
    return {half.z, -half.y, half.x, 0};
  }

  Rng rng_;
};

inline Rays room_rays(ImageSize size) {
  Rays rays;
  camera_rays(look_at({5.5, 0.7, 1.6}, {2, 3, 1}, {0, 0, 1}, size, 75), rays);
  return rays;
}
// What mirrors tilted by a few degrees at random send back, as a glass pane does while its normals
// are still noisy.
inline Rays scattered_rays(ImageSize size) {
  Rays rays = room_rays(size);
  Rng rng(4);
  for (std::size_t i = 0; i < size.num_pixels(); ++i) {
    float *o = rays.origins.data() + 3 * i, *d = rays.directions.data() + 3 * i;
    for (int axis = 0; axis < 3; ++axis) o[axis] += 1.5f * d[axis];
    for (int axis = 0; axis < 3; ++axis) d[axis] = -d[axis] + 0.15f * rng.normal();
  }
  return rays;
}

inline TraceOutput empty_output(ImageSize size) {
  const Image one(size.width, size.height, 1), three(size.width, size.height, 3);
  return {.color = three, .alpha = one, .depth_sum = one, .normal = three};
}

// Means over the rays.
struct MeanCounts {
  double nodes = 0, discs = 0, hits = 0, searches = 0;
};
inline MeanCounts mean_counts(const TraceInput& input, const Rays& rays) {
  const TraceCall call{input, rays, {}};
  const ImageSize size{rays.origins.width(), rays.origins.height()};
  TraceOutput out = empty_output(size);
  HostExec exec;
  gpu::TracePipeline<HostExec> pipeline(exec);
  std::vector<gpu::WalkCounts> counts(size.num_pixels());
  pipeline.forward(gpu::device_call(call, out), counts.data());
  MeanCounts mean;
  const double share = 1 / static_cast<double>(counts.size());
  for (const gpu::WalkCounts& c : counts) {
    mean.nodes += share * c.nodes;
    mean.discs += share * c.discs;
    mean.hits += share * c.hits;
    mean.searches += share * c.searches;
  }
  return mean;
}

}  // namespace glint::test

// SPDX-License-Identifier: MIT
#include "glint/train/surfel_set.h"

#include <cmath>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/blend.h"

namespace glint {

SurfelSet::SurfelSet(
    SurfelCloud cloud, SurfelRates rates, DensifyConfig densify, float extent, std::uint64_t seed
)
    : cloud_(std::move(cloud)), rates_(rates), extent_(extent), densifier_(densify, extent, seed) {
  gradient_.extra_names = cloud_.extra_names;
  gradient_.resize(cloud_.size());
}

const RasterOutput& SurfelSet::forward(
    const Camera& camera, int sh_degree, const RasterSettings& settings, ImageView near_limit
) {
  activate(cloud_, cast<float>(camera.center()), sh_degree, activated_);
  RasterInput input = raster_input(cloud_, activated_);
  input.near_limit = near_limit;
  rasterizer_.forward(input, camera, settings, output_);
  return output_;
}

void SurfelSet::backward(
    const Camera& camera,
    int sh_degree,
    const RasterSettings& settings,
    const RasterOutputGradient& dL_doutput,
    ImageView near_limit
) {
  RasterInput input = raster_input(cloud_, activated_);
  input.near_limit = near_limit;
  rasterizer_.backward(input, camera, settings, output_, dL_doutput, raster_gradient_);
  activate_vjp(
      cloud_, cast<float>(camera.center()), sh_degree, activated_, raster_gradient_, gradient_
  );
  densifier_.observe(output_, raster_gradient_);
}

const TraceOutput& SurfelSet::trace(
    const Rays& rays, int sh_degree, const TraceSettings& settings
) {
  activate_geometry(cloud_, activated_);
  tracer_.forward(trace_input(cloud_, activated_, sh_degree), rays, settings, trace_output_);
  return trace_output_;
}

const Rays& SurfelSet::trace_backward(
    const Rays& rays,
    int sh_degree,
    const TraceSettings& settings,
    const TraceOutputGradient& dL_doutput
) {
  tracer_.backward(
      trace_input(cloud_, activated_, sh_degree),
      rays,
      settings,
      trace_output_,
      dL_doutput,
      trace_gradient_
  );
  trace_activate_vjp(activated_, trace_gradient_, gradient_);
  densifier_.observe(trace_gradient_, rays.origins.height());
  return trace_gradient_.rays;
}

DensifyCounts SurfelSet::update(int step) {
  adam_.step(cloud_, gradient_, rates_, extent_);
  const DensifyCounts counts = densifier_.update(step, cloud_, adam_);
  gradient_.resize(cloud_.size());  // zero after every step
  return counts;
}

PointCloud initial_points(const Scene& scene, std::size_t count, std::uint64_t seed) {
  if (!scene.points.positions.empty()) return scene.points;
  Rng rng(seed, hash_name("initial points"));
  PointCloud points;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3f p, color;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = rng.uniform(scene.bounds_min[axis], scene.bounds_max[axis]);
      color[axis] = rng.uniform();
    }
    points.positions.push_back(p);
    points.colors.push_back(color);
  }
  return points;
}

void check_finite(const SurfelCloud& cloud, const std::string& set_name) {
  cloud.for_each_array([&](const char* name, const std::vector<float>& array, std::size_t width) {
    for (std::size_t i = 0; i < array.size(); ++i)
      GLINT_CHECK(
          std::isfinite(array[i]),
          kBadPrediction,
          "{}: {} of surfel {} is {}; lower the learning rate of that parameter",
          set_name,
          name,
          i / width,
          array[i]
      );
  });
}

void expected_depth_map(const RasterOutput& output, Image& depth) {
  if (depth.size() != output.alpha.size())
    depth = Image(output.alpha.width(), output.alpha.height(), 1);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    depth.data()[i] = expected_depth(output.depth_sum.data()[i], output.alpha.data()[i]);
}

Image unit_normals(const Image& normal) {
  Image result = normal;
  for (std::size_t i = 0; i < result.num_pixels(); ++i) {
    float* n = result.data() + 3 * i;
    const float norm = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; ++k) n[k] = norm > 1e-6f ? n[k] / norm : 0.0f;
  }
  return result;
}

}  // namespace glint

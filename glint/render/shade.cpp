// SPDX-License-Identifier: MIT
#include "glint/render/shade.h"

#include "glint/core/parallel.h"
#include "glint/core/simd.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // surfels a block

// Calls f<Float8>(i) for groups of eight surfels and f<float>(i) for the rest of [begin, end).
template <class F>
void for_lanes(std::size_t begin, std::size_t end, F&& f) {
  std::size_t i = begin;
  for (; i + 8 <= end; i += 8) f(Float8(0.0f), i);
  for (; i < end; ++i) f(0.0f, i);
}

template <class T>
Vec3<T> load3(const std::vector<float>& array, std::size_t i) {
  const float* p = array.data() + 3 * i;
  return {load_strided<T>(p, 3), load_strided<T>(p + 1, 3), load_strided<T>(p + 2, 3)};
}

// Unit direction from the eye to a surfel, and its length.
template <class T>
struct ViewDirection {
  Vec3<T> unit;
  T norm;
};
template <class T>
ViewDirection<T> view_direction(const SurfelCloud& cloud, Vec3f eye, std::size_t i) {
  const Vec3<T> d = load3<T>(cloud.means, i) - Vec3<T>{T(eye.x), T(eye.y), T(eye.z)};
  const T norm = max_of(length(d), T(1e-12f));
  return {(T(1) / norm) * d, norm};
}

template <class T>
T coefficient(const SurfelCloud& cloud, std::size_t i, int k, int c) {
  return k == 0 ? load_strided<T>(cloud.sh_dc.data() + 3 * i + c, 3)
                : load_strided<T>(cloud.sh_rest.data() + 45 * i + 3 * (k - 1) + c, 45);
}

template <class T>
T sh_sum(const SurfelCloud& cloud, std::size_t i, int count, const T basis[16], int c) {
  T sum(0);
  for (int k = 0; k < count; ++k) sum = fma_of(basis[k], coefficient<T>(cloud, i, k, c), sum);
  return sum;
}

template <class T>
void activate_geometry_lanes(const SurfelCloud& cloud, std::size_t i, ActivatedSurfels& out) {
  for (int axis = 0; axis < 2; ++axis) {
    const std::size_t at = 2 * i + axis;
    store_strided(&out.scales[at], 2, exp_fast(load_strided<T>(&cloud.log_scales[at], 2)));
  }
  store_strided(&out.opacities[i], 1, sigmoid(load_strided<T>(&cloud.opacity_logits[i], 1)));
}

template <class T>
void activate_features_lanes(
    const SurfelCloud& cloud, Vec3f eye, int degree, std::size_t i, ActivatedSurfels& out
) {
  T basis[16];
  sh_basis(degree, view_direction<T>(cloud, eye, i).unit, basis);
  for (int c = 0; c < 3; ++c)
    store_strided(
        &out.features[i * out.channels + c],
        out.channels,
        sh_color(sh_sum(cloud, i, sh_coefficients(degree), basis, c))
    );
  const int extra = out.channels - 3;
  for (int e = 0; e < extra; ++e)
    store_strided(
        &out.features[i * out.channels + 3 + e],
        out.channels,
        sigmoid(load_strided<T>(&cloud.extra_logits[i * extra + e], extra))
    );
}

template <class T>
void add_strided(float* p, std::ptrdiff_t stride, T value) {
  store_strided(p, stride, load_strided<T>(p, stride) + value);
}

template <class T>
void sh_vjp_lanes(
    const SurfelCloud& cloud,
    Vec3f eye,
    int degree,
    std::size_t i,
    const ActivatedSurfels& a,
    const RasterGradient& g,
    SurfelCloud& out
) {
  const ViewDirection<T> view = view_direction<T>(cloud, eye, i);
  const int count = sh_coefficients(degree);
  T basis[16], dL_dbasis[16];
  sh_basis(degree, view.unit, basis);
  for (int k = 0; k < count; ++k) dL_dbasis[k] = T(0);
  for (int c = 0; c < 3; ++c) {
    const std::size_t at = i * a.channels + c;
    const T dL_dsum = clamped_color_vjp(
        load_strided<T>(&a.features[at], a.channels), load_strided<T>(&g.features[at], a.channels)
    );
    add_strided(&out.sh_dc[3 * i + c], 3, dL_dsum * basis[0]);
    for (int k = 1; k < count; ++k) {
      add_strided(&out.sh_rest[45 * i + 3 * (k - 1) + c], 45, dL_dsum * basis[k]);
      dL_dbasis[k] = fma_of(dL_dsum, coefficient<T>(cloud, i, k, c), dL_dbasis[k]);
    }
  }
  Vec3<T> dL_dd{};
  sh_basis_vjp(degree, view.unit, dL_dbasis, dL_dd);
  const Vec3<T> dL_dmean = normalize_vjp(view.unit, view.norm, dL_dd);
  for (int axis = 0; axis < 3; ++axis)
    add_strided(
        &out.means[3 * i + axis], 3, load_strided<T>(&g.means[3 * i + axis], 3) + dL_dmean[axis]
    );
}

template <class T>
void activate_vjp_lanes(
    const SurfelCloud& cloud,
    Vec3f eye,
    int degree,
    std::size_t i,
    const ActivatedSurfels& a,
    const RasterGradient& g,
    SurfelCloud& out
) {
  sh_vjp_lanes<T>(cloud, eye, degree, i, a, g, out);
  for (int axis = 0; axis < 2; ++axis) {
    const std::size_t at = 2 * i + axis;
    const T scale = load_strided<T>(&a.scales[at], 2);
    add_strided(&out.log_scales[at], 2, exp_vjp(scale, load_strided<T>(&g.scales[at], 2)));
  }
  for (int k = 0; k < 4; ++k)
    add_strided(&out.rotations[4 * i + k], 4, load_strided<T>(&g.rotations[4 * i + k], 4));
  const T opacity = load_strided<T>(&a.opacities[i], 1);
  add_strided(&out.opacity_logits[i], 1, sigmoid_vjp(opacity, load_strided<T>(&g.opacities[i], 1)));
  const int extra = a.channels - 3;
  for (int e = 0; e < extra; ++e) {
    const std::size_t at = i * a.channels + 3 + e;
    const T value = load_strided<T>(&a.features[at], a.channels);
    add_strided(
        &out.extra_logits[i * extra + e],
        extra,
        sigmoid_vjp(value, load_strided<T>(&g.features[at], a.channels))
    );
  }
}

}  // namespace

void activate(const SurfelCloud& cloud, Vec3f eye, int sh_degree, ActivatedSurfels& activated) {
  activated.channels = 3 + static_cast<int>(cloud.num_extra());
  activated.scales.resize(2 * cloud.size());
  activated.opacities.resize(cloud.size());
  activated.features.resize(cloud.size() * activated.channels);
  parallel_for_blocks(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for_lanes(begin, end, [&](auto lanes, std::size_t i) {
      activate_geometry_lanes<decltype(lanes)>(cloud, i, activated);
      activate_features_lanes<decltype(lanes)>(cloud, eye, sh_degree, i, activated);
    });
  });
}

void activate_geometry(const SurfelCloud& cloud, ActivatedSurfels& activated) {
  activated.scales.resize(2 * cloud.size());
  activated.opacities.resize(cloud.size());
  parallel_for_blocks(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for_lanes(begin, end, [&](auto lanes, std::size_t i) {
      activate_geometry_lanes<decltype(lanes)>(cloud, i, activated);
    });
  });
}

RasterInput raster_input(const SurfelCloud& cloud, const ActivatedSurfels& activated) {
  RasterInput input;
  input.count = cloud.size();
  input.channels = activated.channels;
  input.means = cloud.means;
  input.scales = activated.scales;
  input.rotations = cloud.rotations;
  input.opacities = activated.opacities;
  input.features = activated.features;
  return input;
}

void activate_vjp(
    const SurfelCloud& cloud,
    Vec3f eye,
    int sh_degree,
    const ActivatedSurfels& activated,
    const RasterGradient& gradient,
    SurfelCloud& dL_dcloud
) {
  parallel_for_blocks(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for_lanes(begin, end, [&](auto lanes, std::size_t i) {
      activate_vjp_lanes<decltype(lanes)>(cloud, eye, sh_degree, i, activated, gradient, dL_dcloud);
    });
  });
}

}  // namespace glint

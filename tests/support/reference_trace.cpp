// SPDX-License-Identifier: MIT
#include "tests/support/reference_trace.h"

#include <algorithm>
#include <cmath>

namespace glint::test {

namespace {

Vec3d at3(const std::vector<double>& v, std::size_t i) {
  return {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
}

// q v q* of a quaternion of any length, divided by its squared length.
Vec3d rotate(const double* q, Vec3d v) {
  const Vec3d r{q[1], q[2], q[3]};
  const double s = q[0], norm2 = s * s + dot(r, r);
  return (1 / norm2) * ((s * s - dot(r, r)) * v + (2 * dot(r, v)) * r + (2 * s) * cross(r, v));
}

// Real spherical harmonics as sums of monomials x^a y^b z^c [Kerbl23 order and signs].
struct Monomial {
  int k;
  double factor;
  int a, b, c;
};
const Monomial kMonomials[] = {
    {0, 0.28209479177387814, 0, 0, 0},  {1, -0.4886025119029199, 0, 1, 0},
    {2, 0.4886025119029199, 0, 0, 1},   {3, -0.4886025119029199, 1, 0, 0},
    {4, 1.0925484305920792, 1, 1, 0},   {5, -1.0925484305920792, 0, 1, 1},
    {6, 0.6307831305050401, 0, 0, 2},   {6, -0.31539156525252005, 2, 0, 0},
    {6, -0.31539156525252005, 0, 2, 0}, {7, -1.0925484305920792, 1, 0, 1},
    {8, 0.5462742152960396, 2, 0, 0},   {8, -0.5462742152960396, 0, 2, 0},
    {9, -1.7701307697799304, 2, 1, 0},  {9, 0.5900435899266435, 0, 3, 0},
    {10, 2.890611442640554, 1, 1, 1},   {11, -1.8281831978578632, 0, 1, 2},
    {11, 0.4570457994644658, 2, 1, 0},  {11, 0.4570457994644658, 0, 3, 0},
    {12, 0.7463526651802308, 0, 0, 3},  {12, -1.1195289977703462, 2, 0, 1},
    {12, -1.1195289977703462, 0, 2, 1}, {13, -1.8281831978578632, 1, 0, 2},
    {13, 0.4570457994644658, 3, 0, 0},  {13, 0.4570457994644658, 1, 2, 0},
    {14, 1.445305721320277, 2, 0, 1},   {14, -1.445305721320277, 0, 2, 1},
    {15, -0.5900435899266435, 3, 0, 0}, {15, 1.7701307697799304, 1, 2, 0}};

Vec3d color_of(const ReferenceTraceInput& input, std::size_t i, Vec3d unit) {
  Vec3d sum{0.5, 0.5, 0.5};
  for (const Monomial& m : kMonomials) {
    if (m.k >= (input.sh_degree + 1) * (input.sh_degree + 1)) continue;
    const double basis =
        m.factor * std::pow(unit.x, m.a) * std::pow(unit.y, m.b) * std::pow(unit.z, m.c);
    const double* rest = input.sh_rest.data() + 45 * i + 3 * (m.k - 1);
    sum += basis * (m.k == 0 ? at3(input.sh_dc, i) : Vec3d{rest[0], rest[1], rest[2]});
  }
  return {std::max(sum.x, 0.0), std::max(sum.y, 0.0), std::max(sum.z, 0.0)};
}

struct Hit {
  double t;
  std::size_t surfel;
  double alpha;
  Vec3d normal;
};

double relative_distance(double value, double limit) {
  return std::abs(value - limit) / std::max(std::abs(limit), 1e-9);
}

// Fills `hit` and says whether the surfel counts.
bool meet(
    const ReferenceTraceInput& input,
    std::size_t i,
    Vec3d o,
    Vec3d d,
    const TraceSettings& settings,
    Hit& hit,
    double& nearest
) {
  const double* q = &input.rotations[4 * i];
  const Vec3d a = rotate(q, {1, 0, 0}), b = rotate(q, {0, 1, 0}), n = rotate(q, {0, 0, 1});
  const double facing = dot(n, d);
  const double t = dot(n, at3(input.means, i) - o) / facing;
  const Vec3d e = o + t * d - at3(input.means, i);
  const double u = dot(a, e) / input.scales[2 * i], v = dot(b, e) / input.scales[2 * i + 1];
  const double rho = u * u + v * v, near = static_cast<double>(settings.near);
  const double response = input.opacities[i] * std::exp(-rho / 2);
  const double max_rho = static_cast<double>(settings.max_rho);
  const double min_alpha = static_cast<double>(settings.min_alpha);
  if (!(rho < 2 * max_rho) || !(response > min_alpha / 2)) return false;
  nearest = std::min(nearest, std::abs(t - near));
  if (!(t > near)) return false;
  nearest =
      std::min({nearest, relative_distance(rho, max_rho), relative_distance(response, min_alpha)});
  if (rho > max_rho || response < min_alpha) return false;
  nearest = std::min(nearest, relative_distance(response, 0.99));
  hit = {t, i, std::min(response, 0.99), facing > 0 ? -n : n};
  return true;
}

}  // namespace

ReferenceTraceInput reference_trace_input(const TraceInput& input, const Rays& rays) {
  const auto copy = [](std::span<const float> from) {
    return std::vector<double>(from.begin(), from.end());
  };
  ReferenceTraceInput result;
  result.count = input.count;
  result.sh_degree = input.sh_degree;
  result.means = copy(input.means);
  result.scales = copy(input.scales);
  result.rotations = copy(input.rotations);
  result.opacities = copy(input.opacities);
  result.sh_dc = copy(input.sh_dc);
  result.sh_rest = copy(input.sh_rest);
  for (std::size_t i = 0; i < rays.origins.num_pixels(); ++i)
    for (const Image* image : {&rays.origins, &rays.directions})
      for (std::size_t k = 0; k < 3; ++k)
        result.rays.push_back(static_cast<double>(image->data()[3 * i + k]));
  return result;
}

ReferenceRay reference_trace(
    const ReferenceTraceInput& input, std::size_t ray, const TraceSettings& settings
) {
  const double* r = &input.rays[6 * ray];
  const Vec3d o{r[0], r[1], r[2]}, d{r[3], r[4], r[5]};
  ReferenceRay result;
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < input.count; ++i) {
    Hit hit;
    if (meet(input, i, o, d, settings, hit, result.nearest_cutoff)) hits.push_back(hit);
  }
  std::stable_sort(hits.begin(), hits.end(), [](const Hit& x, const Hit& y) { return x.t < y.t; });
  double transmittance = 1;
  const Vec3d unit = normalize(d);
  for (std::size_t k = 0; k < hits.size() && result.hits < settings.max_hits; ++k) {
    const Hit& hit = hits[k];
    if (k > 0 && hit.t > hits[k - 1].t)
      result.nearest_cutoff = std::min(result.nearest_cutoff, hit.t - hits[k - 1].t);
    const double next = transmittance * (1 - hit.alpha);
    const double least = static_cast<double>(settings.min_transmittance);
    result.nearest_cutoff = std::min(result.nearest_cutoff, relative_distance(next, least));
    if (next < least) break;
    const double weight = hit.alpha * transmittance;
    result.color += weight * color_of(input, hit.surfel, unit);
    result.normal += weight * hit.normal;
    result.depth_sum += weight * hit.t;
    result.alpha += weight;
    transmittance = next;
    ++result.hits;
  }
  return result;
}

}  // namespace glint::test

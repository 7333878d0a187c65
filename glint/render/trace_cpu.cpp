// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/sh_lanes.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/trace.h"
#include "glint/render/trace_bvh.h"

namespace glint {

namespace {

constexpr std::size_t kRaysPerBlock = 64;
constexpr std::size_t kSurfelGrain = 512;

// One hit's gradient, kept until it is summed with the others of its surfel.
struct alignas(32) HitGradient {
  Vec3f h0, h1, m, normal;
  Vec3f color;       // dL/d(SH sum), clamped channels zero
  Vec3f half_depth;  // dL/dmean t / 2
  float opacity, weight;
  float padding[4];
};
static_assert(sizeof(HitGradient) == 24 * sizeof(float));

}  // namespace

struct TraceSaved {
  std::vector<TracedSurfel> surfels;
  SurfelBvh bvh;
  std::vector<std::vector<std::uint32_t>> blocks;  // surfels of the hits of each block of rays
  std::vector<std::uint32_t> counts;               // [rays] hits
  std::vector<std::size_t> ray_begin;              // [rays + 1] first hit
  std::vector<HitGradient> hit_gradients;          // [hits]
  std::vector<float> basis;                        // [rays][48] spherical harmonics, expanded
  std::vector<std::uint32_t> surfel_begin;         // [N + 1] into `hits_of_surfel`
  std::vector<std::uint32_t> hits_of_surfel, ray_of_hit;
};

namespace {

Vec3f at3(std::span<const float> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}
Vec3f at3(const Image& image, std::size_t i) {
  return image.empty()
             ? Vec3f{}
             : Vec3f{image.data()[3 * i], image.data()[3 * i + 1], image.data()[3 * i + 2]};
}
float at1(const Image& image, std::size_t i) { return image.empty() ? 0.0f : image.data()[i]; }
void put3(float* p, Vec3f v) {
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}

// ---- surfels
// -------------------------------------------------------------------------------------

Vec4f rotation_at(const TraceInput& input, std::size_t i) {
  const float* q = &input.rotations[4 * i];
  return {q[0], q[1], q[2], q[3]};
}

TracedSurfel traced_surfel(const TraceInput& input, const TraceSettings& settings, std::size_t i) {
  const Mat3f r = rotation_matrix(rotation_at(input, i));
  TracedSurfel s;
  s.mean = at3(input.means, i);
  s.h0 = input.scales[2 * i] * column(r, 0);
  s.h1 = input.scales[2 * i + 1] * column(r, 1);
  s.e3 = cross(s.h0, s.h1);
  s.normal = column(r, 2);
  s.opacity = input.opacities[i];
  const float faintest = 2 * std::log(std::max(s.opacity, 1e-12f) / settings.min_alpha) + 1e-4f;
  s.max_rho = std::min(settings.max_rho, faintest);
  return s;
}

// From the sums of e3-free gradients back to the parameters.
void surfel_vjp(const TraceInput& input, std::size_t i, const HitGradient& g, TraceGradient& out) {
  const Mat3f r = rotation_matrix(rotation_at(input, i));
  const float su = input.scales[2 * i], sv = input.scales[2 * i + 1];
  put3(&out.means[3 * i], g.m);
  out.scales[2 * i] = dot(g.h0, column(r, 0));
  out.scales[2 * i + 1] = dot(g.h1, column(r, 1));
  out.opacities[i] = g.opacity;
  Vec4f dL_dq{};
  rotation_matrix_vjp(
      rotation_at(input, i), transpose(Mat3f{{su * g.h0, sv * g.h1, g.normal}}), dL_dq
  );
  const float q[4] = {dL_dq.w, dL_dq.x, dL_dq.y, dL_dq.z};
  std::copy_n(q, 4, &out.rotations[4 * i]);
  put3(&out.half_depths[3 * i], g.half_depth);
  out.visibility[i] = g.weight;
}

// ---- one hit
// -------------------------------------------------------------------------------------

// One hit of a ray, composited.
struct RayHit {
  PlaneHit<float> plane;
  SplatAlpha<float> alpha;
  float transmittance;  // before
  float weight;
  Vec3f sh_sum, color, normal;
};

struct RayState {
  Vec3f origin, direction;
  ShLanes basis;
  float transmittance = 1;
};

Vec3f sh_sum(const TraceInput& input, const RayState& ray, std::size_t surfel) {
  const Vec3f rest = sh_dot(ray.basis, ShLanes::load(&input.sh_rest[45 * surfel]));
  return kSh0 * at3(input.sh_dc, surfel) + rest;
}

// Colours lie scattered in memory: asked for one traversal ahead.
void prefetch(const TraceInput& input, std::size_t surfel) {
  const float* rest = &input.sh_rest[45 * surfel];
  for (int i = 0; i < 48; i += 16) __builtin_prefetch(rest + i);
  __builtin_prefetch(&input.sh_dc[3 * surfel]);
}

// Composites one surfel. Returns false when it stops the ray (and does not count).
bool composite(
    const TraceInput& input,
    const TraceSettings& settings,
    const TracedSurfel& s,
    std::size_t surfel,
    RayState& ray,
    RayHit& hit
) {
  hit.plane = meet(s, ray.origin, ray.direction);
  const float rho = fma_of(hit.plane.u, hit.plane.u, hit.plane.v * hit.plane.v);
  hit.alpha = splat_alpha(s.opacity, min_of(rho, settings.max_rho));
  hit.transmittance = ray.transmittance;
  const bool counts = hit.alpha.alpha >= settings.min_alpha;
  const BlendStep<float> step =
      blend_step(ray.transmittance, keep(counts, hit.alpha.alpha), settings.min_transmittance);
  ray.transmittance = step.transmittance;
  hit.weight = step.weight;
  if (step.transmittance < 0) return false;
  hit.sh_sum = sh_sum(input, ray, surfel);
  hit.color = {sh_color(hit.sh_sum.x), sh_color(hit.sh_sum.y), sh_color(hit.sh_sum.z)};
  hit.normal = dot(s.normal, ray.direction) > 0 ? -s.normal : s.normal;
  return true;
}

RayState ray_at(const Rays& rays, const TraceSaved& saved, std::size_t i) {
  RayState ray;
  ray.origin = at3(rays.origins, i);
  ray.direction = at3(rays.directions, i);
  ray.basis = load_expanded(&saved.basis[ShLanes::kFloats * i]);
  return ray;
}

// ---- forward
// -------------------------------------------------------------------------------------

struct RaySums {
  Vec3f color{}, normal{};
  float depth = 0;
};

void trace_ray(
    const TraceInput& input,
    const TraceSettings& settings,
    const TraceSaved& saved,
    RayState& ray,
    std::vector<std::uint32_t>& ids,
    RaySums& sums
) {
  NearestHits nearest;
  nearest.after = {settings.near, ~0u};
  const std::size_t most = ids.size() + static_cast<std::size_t>(settings.max_hits);
  do {
    saved.bvh.nearest(ray.origin, ray.direction, nearest);
    for (int i = 0; i < nearest.count; ++i) prefetch(input, nearest.hits[i].surfel);
    for (int i = 0; i < nearest.count && ids.size() < most; ++i) {
      const std::uint32_t surfel = nearest.hits[i].surfel;
      RayHit hit;
      if (!composite(input, settings, saved.surfels[surfel], surfel, ray, hit)) return;
      if (hit.weight <= 0) continue;
      ids.push_back(surfel);
      sums.color += hit.weight * hit.color;
      sums.normal += hit.weight * hit.normal;
      sums.depth += hit.weight * hit.plane.t;
    }
    if (nearest.count > 0) nearest.after = nearest.hits[nearest.count - 1];
  } while (nearest.full() && ids.size() < most);
}

// Coefficients above the degree in use count as zero.
void store_basis(const Rays& rays, int degree, std::size_t i, TraceSaved& saved) {
  const Vec3f d = at3(rays.directions, i);
  const float norm = length(d);
  float basis[16] = {};
  if (norm > 0) sh_basis(degree, (1 / norm) * d, basis);
  expand_basis(basis, &saved.basis[ShLanes::kFloats * i]);
}

void forward_ray(
    const TraceInput& input,
    const Rays& rays,
    const TraceSettings& settings,
    std::size_t i,
    TraceSaved& saved,
    TraceOutput& out
) {
  std::vector<std::uint32_t>& ids = saved.blocks[i / kRaysPerBlock];
  const std::size_t before = ids.size();
  store_basis(rays, input.sh_degree, i, saved);
  RayState ray = ray_at(rays, saved, i);
  RaySums sums;
  if (length2(ray.direction) > 0 && input.count > 0)
    trace_ray(input, settings, saved, ray, ids, sums);
  saved.counts[i] = static_cast<std::uint32_t>(ids.size() - before);
  put3(&out.color.data()[3 * i], sums.color);
  put3(&out.normal.data()[3 * i], sums.normal);
  out.depth_sum.data()[i] = sums.depth;
  out.alpha.data()[i] = 1 - std::abs(ray.transmittance);
}

// ---- backward
// ------------------------------------------------------------------------------------

// dL/d(the ray's outputs), and what of their sum lies behind the current hit.
struct RayGradient {
  Vec3f color, normal;
  float alpha, depth;
  float remaining;
  Vec3f origin{}, direction{};
  ShLanes basis = ShLanes::zero();
};

RayGradient ray_gradient(const TraceOutput& out, const TraceOutputGradient& g, std::size_t i) {
  RayGradient r;
  r.color = at3(g.color, i);
  r.normal = at3(g.normal, i);
  r.alpha = at1(g.alpha, i);
  r.depth = at1(g.depth_sum, i);
  r.remaining = dot(r.color, at3(out.color, i)) + dot(r.normal, at3(out.normal, i)) +
                r.alpha * at1(out.alpha, i) + r.depth * at1(out.depth_sum, i);
  return r;
}

void color_vjp(
    const TraceInput& input, const RayHit& hit, std::size_t surfel, RayGradient& g, HitGradient& out
) {
  for (int c = 0; c < 3; ++c) out.color[c] = sh_color_vjp(hit.sh_sum[c], hit.weight * g.color[c]);
  add_scaled(g.basis, repeat(out.color), ShLanes::load(&input.sh_rest[45 * surfel]));
}

void hit_vjp(
    const TraceInput& input,
    const TracedSurfel& s,
    std::size_t surfel,
    const RayState& ray,
    const RayHit& hit,
    RayGradient& g,
    HitGradient& out
) {
  const float value =
      dot(g.color, hit.color) + dot(g.normal, hit.normal) + g.depth * hit.plane.t + g.alpha;
  g.remaining -= hit.weight * value;
  const float dL_dalpha = blend_alpha_vjp(hit.transmittance, hit.alpha.alpha, value, g.remaining);
  float dL_drho = 0;
  out = {};
  splat_alpha_vjp(s.opacity, hit.alpha, dL_dalpha, out.opacity, dL_drho);
  RayPlane<float> dL_dplane{};
  intersect_vjp(
      hit.plane,
      2 * dL_drho * hit.plane.u,
      2 * dL_drho * hit.plane.v,
      hit.weight * g.depth,
      dL_dplane.zeta,
      dL_dplane.det
  );
  ray_plane_vjp(
      s.h0,
      s.h1,
      s.e3,
      s.mean - ray.origin,
      ray.direction,
      dL_dplane,
      out.h0,
      out.h1,
      out.m,
      g.direction
  );
  g.origin += -out.m;
  out.normal = (dot(s.normal, ray.direction) > 0 ? -hit.weight : hit.weight) * g.normal;
  out.half_depth = (0.5f * hit.plane.t) * out.m;
  out.weight = hit.weight;
  color_vjp(input, hit, surfel, g, out);
}

void backward_ray(
    const TraceInput& input,
    const Rays& rays,
    const TraceSettings& settings,
    const TraceOutput& output,
    const TraceOutputGradient& dL_doutput,
    std::size_t i,
    TraceSaved& saved,
    TraceGradient& out
) {
  RayState ray = ray_at(rays, saved, i);
  RayGradient g = ray_gradient(output, dL_doutput, i);
  const std::size_t block = i / kRaysPerBlock;
  const std::size_t first = saved.ray_begin[i] - saved.ray_begin[block * kRaysPerBlock];
  for (std::uint32_t k = 0; k < saved.counts[i]; ++k)
    prefetch(input, saved.blocks[block][first + k]);
  for (std::uint32_t k = 0; k < saved.counts[i]; ++k) {
    const std::uint32_t surfel = saved.blocks[block][first + k];
    RayHit hit;
    composite(input, settings, saved.surfels[surfel], surfel, ray, hit);
    hit_vjp(
        input,
        saved.surfels[surfel],
        surfel,
        ray,
        hit,
        g,
        saved.hit_gradients[saved.ray_begin[i] + k]
    );
  }
  const float norm = length(ray.direction);
  if (saved.counts[i] > 0) {
    const Vec3f unit = (1 / norm) * ray.direction;
    Vec3f dL_dunit{};
    float dL_dbasis[16] = {};
    collect_basis(g.basis, dL_dbasis);
    sh_basis_vjp(input.sh_degree, unit, dL_dbasis, dL_dunit);
    g.direction += normalize_vjp(unit, norm, dL_dunit);
  }
  put3(&out.rays.origins.data()[3 * i], g.origin);
  put3(&out.rays.directions.data()[3 * i], g.direction);
}

// Hits of every surfel in the order of the rays. Each band of surfels is listed by one thread.
void list_hits(std::size_t num_surfels, TraceSaved& saved) {
  const std::size_t num_hits = saved.ray_begin.back();
  saved.surfel_begin.assign(num_surfels + 1, 0);
  saved.ray_of_hit.resize(num_hits);
  saved.hits_of_surfel.resize(num_hits);
  for (const auto& block : saved.blocks)
    for (const std::uint32_t surfel : block) ++saved.surfel_begin[surfel + 1];
  for (std::size_t i = 0; i < num_surfels; ++i) saved.surfel_begin[i + 1] += saved.surfel_begin[i];
  std::vector<std::uint32_t> next(saved.surfel_begin.begin(), saved.surfel_begin.end() - 1);
  std::uint32_t hit = 0;
  for (const auto& block : saved.blocks)
    for (const std::uint32_t surfel : block) saved.hits_of_surfel[next[surfel]++] = hit++;
  parallel_for(saved.counts.size(), 1024, [&](std::size_t i) {
    std::fill_n(
        saved.ray_of_hit.begin() + static_cast<std::ptrdiff_t>(saved.ray_begin[i]),
        saved.counts[i],
        static_cast<std::uint32_t>(i)
    );
  });
}

void add(HitGradient& sum, const HitGradient& g) {
  auto* to = reinterpret_cast<float*>(&sum);
  const auto* from = reinterpret_cast<const float*>(&g);
  for (int i = 0; i < 24; i += 8) (Float8::load(to + i) + Float8::load(from + i)).store(to + i);
}

void sum_hits(const TraceInput& input, std::size_t i, const TraceSaved& saved, TraceGradient& out) {
  HitGradient sum{};
  ShLanes rest = ShLanes::zero();
  for (std::uint32_t k = saved.surfel_begin[i]; k < saved.surfel_begin[i + 1]; ++k) {
    const std::uint32_t hit = saved.hits_of_surfel[k];
    const HitGradient& g = saved.hit_gradients[hit];
    add(sum, g);
    const std::size_t ray = saved.ray_of_hit[hit];
    add_scaled(rest, repeat(g.color), load_expanded(&saved.basis[ShLanes::kFloats * ray]));
  }
  rest.store(&out.sh_rest[45 * i]);
  put3(&out.sh_dc[3 * i], kSh0 * sum.color);
  surfel_vjp(input, i, sum, out);
}

// ---- checks and buffers
// --------------------------------------------------------------------------

void check(const TraceInput& input, const Rays& rays) {
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.sh_dc.size() == 3 * n && input.sh_rest.size() == 45 * n;
  GLINT_CHECK(sizes_agree, kUsage, "trace: array sizes do not match {} surfels", n);
  GLINT_CHECK(
      rays.origins.size() == rays.directions.size() && rays.origins.channels() == 3 &&
          rays.directions.channels() == 3,
      kUsage,
      "trace: origins are {}x{}x{}, directions {}x{}x{}, expected two images of 3 channels",
      rays.origins.width(),
      rays.origins.height(),
      rays.origins.channels(),
      rays.directions.width(),
      rays.directions.height(),
      rays.directions.channels()
  );
}

void fit(Image& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = Image(size.width, size.height, channels);
}

void fit_gradient(const TraceInput& input, ImageSize size, TraceGradient& out) {
  const std::size_t n = input.count;
  out.means.resize(3 * n);
  out.scales.resize(2 * n);
  out.rotations.resize(4 * n);
  out.opacities.resize(n);
  out.sh_dc.resize(3 * n);
  out.sh_rest.resize(45 * n);
  out.visibility.resize(n);
  out.half_depths.resize(3 * n);
  fit(out.rays.origins, size, 3);
  fit(out.rays.directions, size, 3);
}

void prepare(
    const TraceInput& input, const TraceSettings& settings, std::size_t num_rays, TraceSaved& saved
) {
  saved.surfels.resize(input.count);
  parallel_for(input.count, kSurfelGrain, [&](std::size_t i) {
    saved.surfels[i] = traced_surfel(input, settings, i);
  });
  if (input.count > 0) saved.bvh.update(saved.surfels, settings.triangles);
  saved.blocks.resize((num_rays + kRaysPerBlock - 1) / kRaysPerBlock);
  saved.counts.resize(num_rays);
  saved.basis.resize(ShLanes::kFloats * num_rays);
}

}  // namespace

Tracer::Tracer() : saved_(std::make_unique<TraceSaved>()) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::size_t Tracer::num_hits() const {
  return saved_->ray_begin.empty() ? 0 : saved_->ray_begin.back();
}

void Tracer::forward(
    const TraceInput& input, const Rays& rays, const TraceSettings& settings, TraceOutput& output
) {
  check(input, rays);
  const std::size_t num_rays = rays.origins.num_pixels();
  const ImageSize size = rays.origins.size();
  fit(output.color, size, 3);
  fit(output.normal, size, 3);
  fit(output.alpha, size, 1);
  fit(output.depth_sum, size, 1);
  prepare(input, settings, num_rays, *saved_);
  parallel_for_blocks(num_rays, kRaysPerBlock, [&](std::size_t begin, std::size_t end) {
    saved_->blocks[begin / kRaysPerBlock].clear();
    for (std::size_t i = begin; i < end; ++i)
      forward_ray(input, rays, settings, i, *saved_, output);
  });
  saved_->ray_begin.assign(1, 0);
  for (const std::uint32_t count : saved_->counts)
    saved_->ray_begin.push_back(saved_->ray_begin.back() + count);
}

void Tracer::backward(
    const TraceInput& input,
    const Rays& rays,
    const TraceSettings& settings,
    const TraceOutput& output,
    const TraceOutputGradient& dL_doutput,
    TraceGradient& gradient
) {
  check(input, rays);
  fit_gradient(input, rays.origins.size(), gradient);
  saved_->hit_gradients.resize(num_hits());
  parallel_for(rays.origins.num_pixels(), kRaysPerBlock, [&](std::size_t i) {
    backward_ray(input, rays, settings, output, dL_doutput, i, *saved_, gradient);
  });
  list_hits(input.count, *saved_);
  parallel_for(input.count, kSurfelGrain, [&](std::size_t i) {
    sum_hits(input, i, *saved_, gradient);
  });
}

}  // namespace glint

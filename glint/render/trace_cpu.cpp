// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/trace.h"
#include "glint/render/trace_saved.h"

namespace glint {

namespace {

constexpr int kRebuildInterval = 16;  // updates; order and bounds loosen as surfels move

// ---- surfels
// -------------------------------------------------------------------------------------

bool is_finite(const SurfelFields<float>& s) {
  const Vec3f sum = s.mean + s.h0 + s.h1;
  return std::isfinite(sum.x + sum.y + sum.z);
}

TracedSurfel traced_surfel(const TraceInput& input, const TraceSettings& settings, std::size_t i) {
  const Mat3f r = rotation_matrix(rotation_at(input, i));
  const float opacity = input.opacities[i];
  const float faintest = 2 * std::log(std::max(opacity, 1e-12f) / settings.min_alpha) + 1e-4f;
  TracedSurfel s{};
  s.fields.mean = {input.means[3 * i], input.means[3 * i + 1], input.means[3 * i + 2]};
  s.fields.h0 = input.scales[2 * i] * column(r, 0);
  s.fields.h1 = input.scales[2 * i + 1] * column(r, 1);
  s.fields.opacity = opacity;
  s.fields.max_rho = is_finite(s.fields) ? std::min(settings.max_rho, faintest) : -1.0f;
  s.normal = column(r, 2);
  s.surfel = static_cast<std::uint32_t>(i);
  return s;
}

// ---- one ray
// -------------------------------------------------------------------------------------

// Hits of one traversal that count, to be shaded eight at a time.
struct WeightedHits {
  static constexpr std::size_t kCapacity = NearestHits::kCapacity;
  static_assert(kCapacity % kHitsAtOnce == 0);
  std::size_t count = 0;
  std::uint32_t slots[kCapacity];
  float weights[kCapacity], ts[kCapacity];

  void push(std::uint32_t slot, float weight, float t) {
    slots[count] = slot;
    weights[count] = weight;
    ts[count++] = t;
  }
  void pad() {
    while (count % kHitsAtOnce != 0) push(slots[count - 1], 0, 0);
  }
};

// Sums over a ray's hits, hit i in lane i % 8.
struct RaySums {
  Vec3<Float8> color{}, normal{};
  Float8 depth{0.0f};
};

Vec3f lane_sum(Vec3<Float8> v) { return {lane_sum(v.x), lane_sum(v.y), lane_sum(v.z)}; }

// Weights of the hits in order, at most `most`. Returns false when the ray has stopped.
bool weigh(
    const TraceSettings& settings,
    const TraceSaved& saved,
    const NearestHits& nearest,
    std::size_t most,
    RayState& ray,
    WeightedHits& hits
) {
  for (int i = 0; i < nearest.count() && hits.count < most; ++i) {
    const FoundHit& hit = nearest[i];
    const BlendStep<float> step =
        blend_step(ray.transmittance, hit.alpha, settings.min_transmittance);
    ray.transmittance = step.transmittance;
    if (step.transmittance < 0) return false;
    prefetch_hit(saved, hit.slot);
    hits.push(hit.slot, step.weight, hit.t);
  }
  return hits.count < most;
}

// Adds eight hits.
void shade(
    const TraceSaved& saved,
    const RayState& ray,
    const WeightedHits& hits,
    std::size_t first,
    RaySums& sums
) {
  const ShRow* rows[kHitsAtOnce];
  alignas(32) float normals[3][kHitsAtOnce];
  for (std::size_t i = 0; i < kHitsAtOnce; ++i) {
    const std::uint32_t slot = hits.slots[first + i];
    rows[i] = &saved.sh[slot];
    const Vec3f n = saved.surfels[slot].normal;
    for (int axis = 0; axis < 3; ++axis) normals[axis][i] = n[axis];
  }
  const Float8 weights = Float8::load(&hits.weights[first]);
  const Vec3<Float8> normal{
      Float8::load(normals[0]), Float8::load(normals[1]), Float8::load(normals[2])};
  const Mask8 away = dot(normal, all_lanes(ray.direction)) > Float8(0.0f);
  sums.color += weights * hit_colors(ray.basis, rows).colors;
  sums.normal += select(away, -weights, weights) * normal;
  sums.depth += weights * Float8::load(&hits.ts[first]);
}

void trace_ray(
    const TraceSettings& settings,
    const TraceSaved& saved,
    RayState& ray,
    std::vector<std::uint32_t>& slots,
    RaySums& sums
) {
  NearestHits nearest(settings.near, settings.min_alpha, settings.min_transmittance);
  auto left = static_cast<std::size_t>(std::max(settings.max_hits, 0));
  for (bool more = left > 0; more;) {
    nearest.start(ray.transmittance);
    saved.bvh.nearest(ray.origin, ray.direction, nearest);
    more = nearest.finish();
    WeightedHits hits;
    more = weigh(settings, saved, nearest, left, ray, hits) && more;
    slots.insert(slots.end(), hits.slots, hits.slots + hits.count);
    left -= hits.count;
    hits.pad();
    for (std::size_t i = 0; i < hits.count; i += kHitsAtOnce) shade(saved, ray, hits, i, sums);
  }
}

void forward_ray(
    const TraceInput& input,
    const Rays& rays,
    const TraceSettings& settings,
    std::size_t i,
    TraceSaved& saved,
    TraceOutput& out
) {
  std::vector<std::uint32_t>& slots = saved.blocks[i / kRaysPerBlock];
  const std::size_t before = slots.size();
  RayState ray = ray_at(rays, input.sh_degree, i);
  RaySums sums;
  if (length2(ray.direction) > 0 && input.count > 0) trace_ray(settings, saved, ray, slots, sums);
  saved.counts[i] = static_cast<std::uint32_t>(slots.size() - before);
  put3(&out.color.data()[3 * i], lane_sum(sums.color));
  put3(&out.normal.data()[3 * i], lane_sum(sums.normal));
  out.depth_sum.data()[i] = lane_sum(sums.depth);
  out.alpha.data()[i] = 1 - std::abs(ray.transmittance);
}

// ---- preparation
// --------------------------------------------------------------------------

void prepare(
    const TraceInput& input, const TraceSettings& settings, std::size_t num_rays, TraceSaved& saved
) {
  const std::size_t n = input.count;
  const bool refit = saved.surfels.size() == n && ++saved.updates % kRebuildInterval != 0;
  if (!refit) {
    saved.slot_of_surfel = morton_slots(input.means);
    saved.updates = 0;
  }
  saved.surfels.resize(n);
  saved.sh.resize(n);
  parallel_for(n, kSurfelGrain, [&](std::size_t i) {
    prefetch_hit(saved, saved.slot_of_surfel[std::min(i + kSurfelsAhead, n - 1)]);
    const std::uint32_t slot = saved.slot_of_surfel[i];
    saved.surfels[slot] = traced_surfel(input, settings, i);
    saved.sh[slot] = ShRow::pack(&input.sh_dc[3 * i], &input.sh_rest[45 * i]);
  });
  if (n > 0) saved.bvh.update(saved.surfels, settings.triangles, refit);
  saved.blocks.resize((num_rays + kRaysPerBlock - 1) / kRaysPerBlock);
  saved.counts.resize(num_rays);
}

}  // namespace

// Coefficients above the degree in use count as zero.
RayState ray_at(const Rays& rays, int sh_degree, std::size_t i) {
  RayState ray;
  ray.origin = pixel3(rays.origins, i);
  ray.direction = pixel3(rays.directions, i);
  const float norm = length(ray.direction);
  float basis[ShRow::kCoefficients] = {};
  if (norm > 0) sh_basis(sh_degree, (1 / norm) * ray.direction, basis);
  ray.basis = load_basis(basis);
  return ray;
}

void check_trace_arguments(const TraceInput& input, const Rays& rays) {
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

Tracer::Tracer() : saved_(std::make_unique<TraceSaved>()) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::size_t Tracer::num_hits() const {
  std::size_t hits = 0;
  for (const auto& block : saved_->blocks) hits += block.size();
  return hits;
}

void Tracer::forward(
    const TraceInput& input, const Rays& rays, const TraceSettings& settings, TraceOutput& output
) {
  check_trace_arguments(input, rays);
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
}

}  // namespace glint

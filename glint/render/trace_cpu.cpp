// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/op_backends.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/trace_saved.h"

namespace glint {

namespace {

constexpr int kRebuildInterval = 16;      // updates; order and bounds loosen as surfels move
constexpr std::size_t kBlocksAtOnce = 4;  // of rays, that a thread takes

// ---- surfels
// -------------------------------------------------------------------------------------

bool is_finite(const SurfelFields<float>& s) {
  const Vec3f sum = s.mean + s.h0 + s.h1;
  return std::isfinite(sum.x + sum.y + sum.z);
}

TracedSurfel traced_surfel(const TraceInput& input, const TraceSettings& settings, std::size_t i) {
  const Mat3f r = rotation_matrix(rotation_at(input, i));
  const float opacity = input.opacities[i];
  TracedSurfel s{};
  s.fields.mean = {input.means[3 * i], input.means[3 * i + 1], input.means[3 * i + 2]};
  s.fields.h0 = input.scales[2 * i] * column(r, 0);
  s.fields.h1 = input.scales[2 * i + 1] * column(r, 1);
  s.fields.opacity = opacity;
  s.fields.max_rho =
      is_finite(s.fields) ? max_rho_of(opacity, settings.max_rho, settings.min_alpha) : -1.0f;
  s.normal = column(r, 2);
  s.surfel = static_cast<std::uint32_t>(i);
  return s;
}

// ---- one ray
// -------------------------------------------------------------------------------------

// Hits that count and are not yet shaded, which takes eight at a time: which hits lie in one lane
// must not depend on how many a search returned.
struct WeightedHits {
  static constexpr std::size_t kCapacity = NearestHits::kCapacity + kHitsAtOnce;
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
  void drop_first(std::size_t shaded) {
    for (std::size_t i = shaded; i < count; ++i) {
      slots[i - shaded] = slots[i];
      weights[i - shaded] = weights[i];
      ts[i - shaded] = ts[i];
    }
    count -= shaded;
  }
};

// Sums over a ray's hits, hit i in lane i % 8.
struct RaySums {
  Vec3<Float8> color{}, normal{};
  Float8 depth{0.0f};
};

Vec3f lane_sum(Vec3<Float8> v) { return {lane_sum(v.x), lane_sum(v.y), lane_sum(v.z)}; }

// Weights of the hits in order, at most `left` of them. Returns false when the ray has stopped.
bool weigh(
    const TraceSettings& settings,
    const TraceSaved& saved,
    const NearestHits& nearest,
    std::size_t& left,
    RayState& ray,
    WeightedHits& hits
) {
  for (int i = 0; i < nearest.count() && left > 0; ++i, --left) {
    const FoundHit& hit = nearest[i];
    const BlendStep<float> step =
        blend_step(ray.transmittance, hit.alpha, settings.min_transmittance);
    ray.transmittance = step.transmittance;
    if (step.transmittance < 0) return false;
    prefetch_hit(saved, hit.slot);
    hits.push(hit.slot, step.weight, hit.t);
  }
  return left > 0;
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

// Shades whole groups of eight and keeps the rest.
void shade_groups(const TraceSaved& saved, const RayState& ray, WeightedHits& hits, RaySums& sums) {
  const std::size_t whole = hits.count / kHitsAtOnce * kHitsAtOnce;
  for (std::size_t i = 0; i < whole; i += kHitsAtOnce) shade(saved, ray, hits, i, sums);
  hits.drop_first(whole);
}

void trace_ray(
    const TraceSettings& settings,
    const TraceSaved& saved,
    RayState& ray,
    std::vector<std::uint32_t>& slots,
    RaySums& sums
) {
  NearestHits nearest(settings.near, settings.min_alpha, settings.min_transmittance);
  WeightedHits hits;
  auto left = static_cast<std::size_t>(std::max(settings.max_hits, 0));
  for (bool more = left > 0; more;) {
    nearest.start(ray.transmittance, left);
    saved.bvh.nearest(ray.origin, ray.direction, nearest);
    more = nearest.finish();
    const std::size_t before = hits.count;
    more = weigh(settings, saved, nearest, left, ray, hits) && more;
    slots.insert(slots.end(), hits.slots + before, hits.slots + hits.count);
    shade_groups(saved, ray, hits, sums);
  }
  hits.pad();
  shade_groups(saved, ray, hits, sums);
}

// Everything the forward pass reads and its outputs.
struct ForwardPass : TraceCall {
  TraceSaved& saved;
  TraceOutput& output;
};

// Embree aborts on rays that are not finite; they come from parameters that diverged, which the
// trainer reports by name.
bool is_ray(const RayState& ray) {
  const float direction2 = length2(ray.direction);
  return direction2 > 0 && std::isfinite(direction2 + length2(ray.origin));
}

// The slots of its hits go to its block.
void forward_ray(const ForwardPass& call, std::size_t i) {
  std::vector<std::uint32_t>& slots = call.saved.blocks[i / kRaysPerBlock];
  if (i % kRaysPerBlock == 0) slots.clear();
  const std::size_t before = slots.size();
  RayState ray = ray_at(call.rays, call.input.sh_degree, i);
  RaySums sums;
  if (is_ray(ray) && call.input.count > 0) trace_ray(call.settings, call.saved, ray, slots, sums);
  call.saved.counts[i] = static_cast<std::uint32_t>(slots.size() - before);
  put3(call.output.color.data(), i, lane_sum(sums.color));
  put3(call.output.normal.data(), i, lane_sum(sums.normal));
  call.output.depth_sum.data()[i] = lane_sum(sums.depth);
  call.output.alpha.data()[i] = 1 - std::abs(ray.transmittance);
}

// ---- preparation
// --------------------------------------------------------------------------

void prepare(const TraceCall& call, std::size_t num_rays, TraceSaved& saved) {
  const TraceInput& input = call.input;
  const std::size_t n = input.count;
  const bool refit = saved.surfels.size() == n && ++saved.updates % kRebuildInterval != 0;
  if (!refit) {
    saved.slot_of_surfel = cluster_slots(input.means);
    saved.updates = 0;
  }
  saved.surfels.resize(n);
  saved.sh.resize(n);
  parallel_for(n, kSurfelGrain, [&](std::size_t i) {
    prefetch_hit(saved, saved.slot_of_surfel[std::min(i + kSurfelsAhead, n - 1)]);
    const std::uint32_t slot = saved.slot_of_surfel[i];
    saved.surfels[slot] = traced_surfel(input, call.settings, i);
    saved.sh[slot] = ShRow::pack(&input.sh_dc[3 * i], &input.sh_rest[45 * i]);
  });
  if (n > 0) saved.bvh.update(saved.surfels, refit);
  saved.blocks.resize((num_rays + kRaysPerBlock - 1) / kRaysPerBlock);
  saved.counts.resize(num_rays);
}

}  // namespace

// Coefficients above the degree in use count as zero.
RayState ray_at(const Rays& rays, int sh_degree, std::size_t i) {
  RayState ray;
  ray.origin = get3(rays.origins.data(), i);
  ray.direction = get3(rays.directions.data(), i);
  const float norm = length(ray.direction);
  float basis[ShRow::kCoefficients] = {};
  if (norm > 0) sh_basis(sh_degree, (1 / norm) * ray.direction, basis);
  ray.basis = load_basis(basis);
  return ray;
}

std::size_t trace_num_hits(const TraceSaved& saved) {
  std::size_t hits = 0;
  for (const auto& block : saved.blocks) hits += block.size();
  return hits;
}

void trace_forward(const TraceCall& call, TraceOutput& output, TraceSaved& saved) {
  const std::size_t num_rays = call.rays.origins.num_pixels();
  prepare(call, num_rays, saved);
  const ForwardPass pass{{call}, saved, output};
  parallel_for_blocks(
      num_rays,
      kBlocksAtOnce * kRaysPerBlock,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) forward_ray(pass, i);
      }
  );
}

namespace {

class TraceOnCpu final : public TraceBackend {
 public:
  void forward(const TraceCall& call, TraceOutput& output) override {
    trace_forward(call, output, saved_);
  }
  void backward(
      const TraceCall& call,
      const TraceOutput& output,
      const TraceOutputGradient& dL_doutput,
      TraceGradient& gradient
  ) override {
    trace_backward(call, output, dL_doutput, gradient, saved_);
  }
  std::size_t num_hits() override { return trace_num_hits(saved_); }

 private:
  TraceSaved saved_;
};

}  // namespace

std::unique_ptr<TraceBackend> trace_on_cpu() { return std::make_unique<TraceOnCpu>(); }

}  // namespace glint

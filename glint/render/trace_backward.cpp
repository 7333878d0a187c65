// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/trace_saved.h"

namespace glint {

namespace {

// Slices of the rays: more of them cost memory and sums, fewer leave processors idle.
constexpr std::size_t kHitsPerSlice = std::size_t{1} << 17, kMinSlices = 4, kMaxSlices = 16;
constexpr std::size_t kAhead = 16;  // hits that memory is asked for in advance

Vec3f at3(const Image& image, std::size_t i) {
  return image.empty() ? Vec3f{} : get3(image.data(), i);
}
float at1(const Image& image, std::size_t i) { return image.empty() ? 0.0f : image.data()[i]; }

// dL/d(the ray's outputs), what of their sum lies behind the current hit, and what is summed over
// the hits, hit i in lane i % 8.
struct RayGradient {
  Vec3f color, normal;
  float alpha, depth;
  float remaining;
  Vec3<Float8> mean{}, direction{};
  ShBasis basis{0.0f, 0.0f};
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

// ---- eight hits
// ----------------------------------------------------------------------------------

struct HitGroup {
  std::size_t count;  // lanes in use; the others repeat the last of them
  std::uint32_t slots[kHitsAtOnce];
  const ShRow* sh[kHitsAtOnce];
  SurfelLanes surfels;
};

HitGroup load_group(const TraceSaved& saved, const std::uint32_t* slots, std::size_t count) {
  HitGroup group;
  group.count = std::min(count, kHitsAtOnce);
  const float* rows[kHitsAtOnce];
  for (std::size_t i = 0; i < kHitsAtOnce; ++i) {
    group.slots[i] = slots[std::min(i, group.count - 1)];
    group.sh[i] = &saved.sh[group.slots[i]];
    rows[i] = saved.surfels[group.slots[i]].floats();
  }
  RowLanes columns;
  load_columns(rows, columns);
  group.surfels = surfel_lanes(columns);
  return group;
}

// Transmittance before each hit.
Float8 transmittances(const HitGroup& group, Float8 alpha, RayState& ray) {
  alignas(32) float before[kHitsAtOnce];
  for (std::size_t i = 0; i < kHitsAtOnce; ++i) {
    before[i] = ray.transmittance;
    if (i < group.count) ray.transmittance *= 1 - alpha[static_cast<int>(i)];
  }
  return Float8::load(before);
}

// What of the outputs' sum lies behind each hit.
Float8 remainders(const HitGroup& group, Float8 contribution, RayGradient& g) {
  alignas(32) float behind[kHitsAtOnce];
  for (std::size_t i = 0; i < kHitsAtOnce; ++i) {
    if (i < group.count) g.remaining -= contribution[static_cast<int>(i)];
    behind[i] = g.remaining;
  }
  return Float8::load(behind);
}

// Gradients of eight surfels, the floats of SurfelGradient up to `sh`, and of their SH sums.
struct HitGradients {
  Vec3<Float8> mean, h0, h1, half_depth;
  Vec2<Float8> normal;
  Float8 opacity, weight;
  Vec3<Float8> sh_sum;
};

// Eight hits, composited.
struct HitLanes {
  PlaneHit<Float8> plane;
  SplatAlpha<Float8> alpha;
  Float8 transmittance;  // before
  Float8 weight;         // 0 in lanes not in use
  HitColors color;
  Mask8 in_use, away;  // away: the normal points along the ray
};

HitLanes composite(const HitGroup& group, RayState& ray) {
  const SurfelFields<Float8>& s = group.surfels.fields;
  const Vec3<Float8> direction = all_lanes(ray.direction);
  HitLanes hits;
  hits.plane = meet(s, all_lanes(ray.origin), direction);
  hits.alpha = splat_alpha(s.opacity, squared_radius(hits.plane));
  hits.transmittance = transmittances(group, hits.alpha.alpha, ray);
  hits.in_use = lane_indices<Float8>() < Float8(static_cast<float>(group.count));
  hits.weight = keep(hits.in_use, hits.alpha.alpha * hits.transmittance);
  hits.color = hit_colors(ray.basis, group.sh);
  hits.away = dot(group.surfels.normal, direction) > Float8(0.0f);
  return hits;
}

Float8 alpha_vjp(const HitGroup& group, const HitLanes& hits, RayGradient& g) {
  const Vec3<Float8> n = group.surfels.normal;
  const Float8 value = dot(all_lanes(g.color), hits.color.colors) +
                       dot(all_lanes(g.normal), select(hits.away, -n, n)) +
                       Float8(g.depth) * hits.plane.t + Float8(g.alpha);
  const Float8 remaining = remainders(group, hits.weight * value, g);
  return keep(hits.in_use, blend_alpha_vjp(hits.transmittance, hits.alpha.alpha, value, remaining));
}

void plane_vjp(
    const SurfelFields<Float8>& s,
    const RayState& ray,
    const PlaneHit<Float8>& hit,
    Float8 dL_drho,
    Float8 dL_dt,
    HitGradients& out,
    RayGradient& g
) {
  const Float8 dL_dsquare = dL_drho + dL_drho;
  RayPlane<Float8> dL_dplane{};
  intersect_vjp(hit, dL_dsquare * hit.u, dL_dsquare * hit.v, dL_dt, dL_dplane.zeta, dL_dplane.det);
  ray_plane_vjp(
      s.h0,
      s.h1,
      cross(s.h0, s.h1),
      s.mean - all_lanes(ray.origin),
      all_lanes(ray.direction),
      dL_dplane,
      out.h0,
      out.h1,
      out.mean,
      g.direction
  );
}

HitGradients group_vjp(const HitGroup& group, RayState& ray, RayGradient& g) {
  const SurfelFields<Float8>& s = group.surfels.fields;
  const HitLanes hits = composite(group, ray);
  HitGradients out{};
  Float8 dL_drho(0.0f);
  splat_alpha_vjp(s.opacity, hits.alpha, alpha_vjp(group, hits, g), out.opacity, dL_drho);
  plane_vjp(s, ray, hits.plane, dL_drho, hits.weight * Float8(g.depth), out, g);
  g.mean += out.mean;
  out.half_depth = (Float8(0.5f) * hits.plane.t) * out.mean;
  out.weight = hits.weight;
  const Vec3<Float8> dL_dnormal =
      select(hits.away, -hits.weight, hits.weight) * all_lanes(g.normal);
  out.normal = {dot(dL_dnormal, s.h0), dot(dL_dnormal, s.h1)};
  for (int c = 0; c < 3; ++c)
    out.sh_sum[c] = sh_color_vjp(hits.color.sums[c], hits.weight * Float8(g.color[c]));
  return out;
}

// ---- sums
// ----------------------------------------------------------------------------------------

SurfelGradient& row_of(GradientSlice& slice, std::uint32_t slot) {
  std::uint32_t& row = slice.row_of_slot[slot];
  if (row == GradientSlice::kNone) {
    row = static_cast<std::uint32_t>(slice.rows.size());
    slice.rows.emplace_back();
  }
  return slice.rows[row];
}

float* geometry(SurfelGradient& g) { return reinterpret_cast<float*>(&g); }

void add_group(
    const HitGroup& group,
    const HitGradients& g,
    const RayState& ray,
    GradientSlice& slice,
    RayGradient& dL_dray
) {
  RowLanes rows{
      g.mean.x,
      g.mean.y,
      g.mean.z,
      g.h0.x,
      g.h0.y,
      g.h0.z,
      g.h1.x,
      g.h1.y,
      g.h1.z,
      g.half_depth.x,
      g.half_depth.y,
      g.half_depth.z,
      g.normal.x,
      g.normal.y,
      g.opacity,
      g.weight};
  transpose_lanes(&rows[0]);
  transpose_lanes(&rows[8]);
  for (std::size_t i = 0; i < group.count; ++i) {
    const int lane = static_cast<int>(i);
    SurfelGradient& sum = row_of(slice, group.slots[i]);
    float* to = geometry(sum);
    (Float8::load(to) + rows[i]).store(to);
    (Float8::load(to + 8) + rows[8 + i]).store(to + 8);
    const Vec3f dL_dsum{g.sh_sum.x[lane], g.sh_sum.y[lane], g.sh_sum.z[lane]};
    add_coefficients_vjp(ray.basis, dL_dsum, sum.sh);
    add_basis_vjp(*group.sh[i], dL_dsum, dL_dray.basis);
  }
}

void prefetch_sum(const GradientSlice& slice, std::uint32_t slot) {
  const std::uint32_t row = slice.row_of_slot[slot];
  if (row == GradientSlice::kNone) return;
  const SurfelGradient& sum = slice.rows[row];
  __builtin_prefetch(&sum, 1);
  for (const auto& color : sum.sh.colors) __builtin_prefetch(color, 1);
}

// ---- rays
// ----------------------------------------------------------------------------------------

Vec3f direction_gradient(int sh_degree, Vec3f direction, const RayGradient& g) {
  const Vec3f through_plane{
      lane_sum(g.direction.x), lane_sum(g.direction.y), lane_sum(g.direction.z)};
  const float norm = length(direction);
  const Vec3f unit = (1 / norm) * direction;
  float dL_dbasis[ShRow::kCoefficients];
  g.basis.low.store(dL_dbasis);
  g.basis.high.store(dL_dbasis + 8);
  Vec3f dL_dunit{};
  sh_basis_vjp(sh_degree, unit, dL_dbasis, dL_dunit);
  return through_plane + normalize_vjp(unit, norm, dL_dunit);
}

// `slots`: of the ray's hits; as many lie behind them as `following` says.
struct RaySlots {
  const std::uint32_t* slots;
  std::size_t count, following;
};

void backward_ray(
    const TraceSaved& saved,
    const RaySlots& hits,
    RayState& ray,
    GradientSlice& slice,
    RayGradient& g
) {
  for (std::size_t first = 0; first < hits.count; first += kHitsAtOnce) {
    const std::size_t end = hits.count + hits.following;
    for (std::size_t k = first + kAhead; k < std::min(first + kAhead + kHitsAtOnce, end); ++k) {
      prefetch_hit(saved, hits.slots[k]);
      prefetch_sum(slice, hits.slots[k]);
    }
    const HitGroup group = load_group(saved, hits.slots + first, hits.count - first);
    add_group(group, group_vjp(group, ray, g), ray, slice, g);
  }
}

// Everything a pass reads.
struct BackwardPass : TraceCall {
  const TraceOutput& output;
  const TraceOutputGradient& dL_doutput;
};

void backward_block(
    const BackwardPass& call,
    std::size_t block,
    const TraceSaved& saved,
    GradientSlice& slice,
    TraceGradient& out
) {
  const std::vector<std::uint32_t>& slots = saved.blocks[block];
  const std::size_t begin = block * kRaysPerBlock;
  std::size_t done = 0;
  for (std::size_t i = begin; i < std::min(begin + kRaysPerBlock, saved.counts.size()); ++i) {
    const std::size_t count = saved.counts[i];
    Vec3f dL_dorigin{}, dL_ddirection{};
    if (count > 0) {
      RayState ray = ray_at(call.rays, call.input.sh_degree, i);
      RayGradient g = ray_gradient(call.output, call.dL_doutput, i);
      backward_ray(saved, {&slots[done], count, slots.size() - done - count}, ray, slice, g);
      dL_dorigin = -Vec3f{lane_sum(g.mean.x), lane_sum(g.mean.y), lane_sum(g.mean.z)};
      dL_ddirection = direction_gradient(call.input.sh_degree, ray.direction, g);
    }
    put3(out.rays.origins.data(), i, dL_dorigin);
    put3(out.rays.directions.data(), i, dL_ddirection);
    done += count;
  }
}

// Blocks [ends[i - 1], ends[i]) of each slice, of about as many hits each.
std::vector<std::size_t> slice_ends(const TraceSaved& saved, std::size_t num_hits) {
  const std::size_t slices = std::clamp(num_hits / kHitsPerSlice, kMinSlices, kMaxSlices);
  std::vector<std::size_t> ends;
  std::size_t hits = 0;
  for (std::size_t block = 0; block < saved.blocks.size(); ++block) {
    hits += saved.blocks[block].size();
    if (hits * slices >= num_hits * (ends.size() + 1)) ends.push_back(block + 1);
  }
  ends.resize(slices, saved.blocks.size());
  ends.back() = saved.blocks.size();
  return ends;
}

void backward_blocks(
    const BackwardPass& call,
    std::size_t begin,
    std::size_t end,
    const TraceSaved& saved,
    GradientSlice& slice,
    TraceGradient& out
) {
  slice.row_of_slot.resize(saved.surfels.size(), GradientSlice::kNone);
  for (std::size_t block = begin; block < end; ++block)
    backward_block(call, block, saved, slice, out);
}

// ---- surfels
// -------------------------------------------------------------------------------------

// The sum over the slices, which forget it.
SurfelGradient collect(std::size_t slot, std::vector<GradientSlice>& slices) {
  SurfelGradient sum{};
  for (GradientSlice& slice : slices) {
    const std::uint32_t row = slice.row_of_slot[slot];
    if (row == GradientSlice::kNone) continue;
    slice.row_of_slot[slot] = GradientSlice::kNone;
    const float* from = geometry(slice.rows[row]);
    float* to = geometry(sum);
    for (std::size_t k = 0; k < sizeof(SurfelGradient) / sizeof(float); k += 8)
      (Float8::load(to + k) + Float8::load(from + k)).store(to + k);
  }
  return sum;
}

// A surfel without extent meets no ray.
float along_tangent(float along_scaled, float scale) {
  return scale > 0 ? along_scaled / scale : 0.0f;
}

// From the gradient of the fields back to the parameters.
void surfel_vjp(
    const TraceInput& input, std::size_t i, const SurfelGradient& g, TraceGradient& out
) {
  const Mat3f r = rotation_matrix(rotation_at(input, i));
  const float su = input.scales[2 * i], sv = input.scales[2 * i + 1];
  put3(out.means.data(), i, g.mean);
  out.scales[2 * i] = dot(g.h0, column(r, 0));
  out.scales[2 * i + 1] = dot(g.h1, column(r, 1));
  out.opacities[i] = g.opacity;
  const Vec3f dL_dnormal =
      along_tangent(g.normal.x, su) * column(r, 0) + along_tangent(g.normal.y, sv) * column(r, 1);
  Vec4f dL_dq{};
  rotation_matrix_vjp(
      rotation_at(input, i), transpose(Mat3f{{su * g.h0, sv * g.h1, dL_dnormal}}), dL_dq
  );
  const float q[4] = {dL_dq.w, dL_dq.x, dL_dq.y, dL_dq.z};
  std::copy_n(q, 4, &out.rotations[4 * i]);
  put3(out.half_depths.data(), i, g.half_depth);
  out.visibility[i] = g.weight;
  g.sh.unpack(&out.sh_dc[3 * i], &out.sh_rest[45 * i]);
}

}  // namespace

void trace_backward(
    const TraceCall& call,
    const TraceOutput& output,
    const TraceOutputGradient& dL_doutput,
    TraceGradient& gradient,
    TraceSaved& saved
) {
  const BackwardPass pass{{call}, output, dL_doutput};
  const std::vector<std::size_t> ends = slice_ends(saved, trace_num_hits(saved));
  saved.slices.resize(ends.size());
  parallel_for(ends.size(), 1, [&](std::size_t i) {
    const std::size_t begin = i == 0 ? 0 : ends[i - 1];
    backward_blocks(pass, begin, ends[i], saved, saved.slices[i], gradient);
  });
  const std::size_t count = call.input.count;
  parallel_for(count, kSurfelGrain, [&](std::size_t i) {
    const auto& slots = saved.slot_of_surfel;
    const std::uint32_t ahead = slots[std::min(i + kSurfelsAhead, count - 1)];
    for (const GradientSlice& slice : saved.slices) prefetch_sum(slice, ahead);
    surfel_vjp(call.input, i, collect(slots[i], saved.slices), gradient);
  });
  for (GradientSlice& slice : saved.slices) slice.rows.clear();
}

}  // namespace glint

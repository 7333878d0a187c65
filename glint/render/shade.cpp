// SPDX-License-Identifier: MIT
#include "glint/render/shade.h"
#include "glint/render/trace.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/core/simd.h"
#include "glint/render/map_kernels.h"
#include "glint/render/shade_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // surfels a block

// cloud: const for CloudPointers.
template <class F, class Cloud>
CloudArrays<F> arrays_of(Cloud& c, const ActivationOptions& options) {
  const int num_extra = static_cast<int>(c.num_extra());
  CloudArrays<F> arrays{
      c.means.on_device(),
      c.log_scales.on_device(),
      c.rotations.on_device(),
      c.opacity_logits.on_device(),
      c.sh_dc.on_device(),
      c.sh_rest.on_device(),
      c.extra_logits.on_device(),
      num_extra,
      options.color_only ? 0 : num_extra,
      options.opacity_factor,
      options.color_offsets == nullptr ? nullptr : options.color_offsets->device_for_reading(),
      {}};
  std::copy(c.extra_activations.begin(), c.extra_activations.end(), arrays.kinds);
  return arrays;
}
CloudPointers pointers(const SurfelCloud& c, const ActivationOptions& options) {
  const std::size_t kinds = c.extra_activations.size();
  GLINT_CHECK(
      (kinds == 0 || kinds == c.num_extra()) && kinds <= kMaxExtra &&
          options.opacity_factor < static_cast<int>(c.num_extra()),
      kUsage,
      "activation: {} kinds of activation and opacity factor {} for {} extra channels, expected "
      "none or one each, at most {}",
      kinds,
      options.opacity_factor,
      c.num_extra(),
      kMaxExtra
  );
  return arrays_of<const float>(c, options);
}
CloudGradientPointers pointers(SurfelCloud& gradient) { return arrays_of<float>(gradient, {}); }

// On the CPU eight surfels at once.
template <class Kernel>
void run_lanes(std::size_t count, const Kernel& kernel) {
  if (on_gpu()) return run_kernel(count, kGrain, kernel);
  parallel_for_blocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    for (; i + 8 <= end; i += 8) kernel.template lanes<Float8>(i);
    for (; i < end; ++i) kernel.template lanes<float>(i);
  });
}

ActivationRevision revision_of(const SurfelCloud& cloud, const ActivatedSurfels& activated) {
  if (activated.options.opacity_factor >= 0) return {};  // made of more
  return {
      cloud.log_scales.device_revision(),
      cloud.opacity_logits.device_revision(),
      activated.scales.device_revision(),
      activated.opacities.device_revision()};
}

}  // namespace

void activate_geometry(const SurfelCloud& cloud, ActivatedSurfels& activated) {
  activated.scales.resize(2 * cloud.size());
  activated.opacities.resize(cloud.size());
  const ActivationRevision revision = revision_of(cloud, activated);
  if (revision.known() && revision == activated.revision) return;
  run_lanes(
      cloud.size(),
      ActivateGeometry{
          pointers(cloud, activated.options),
          activated.scales.on_device(),
          activated.opacities.on_device()}
  );
  activated.revision = revision_of(cloud, activated);
}

void activate(const SurfelCloud& cloud, Vec3f eye, int sh_degree, ActivatedSurfels& activated) {
  activated.channels = 3 + (activated.options.color_only ? 0 : static_cast<int>(cloud.num_extra()));
  activated.features.resize(cloud.size() * activated.channels);
  activate_geometry(cloud, activated);
  run_lanes(
      cloud.size(),
      ActivateFeatures{
          pointers(cloud, activated.options), eye, sh_degree, activated.features.on_device()}
  );
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
    const ActivatedSurfels& a,
    const RasterGradient& g,
    SurfelCloud& dL_dcloud
) {
  const bool apart = on_gpu() && sh_degree > 0;
  const ActivateVjp vjp{
      pointers(cloud, a.options),
      eye,
      sh_degree,
      a.scales.on_device(),
      a.opacities.on_device(),
      a.features.on_device(),
      {g.means.on_device(),
       g.scales.on_device(),
       g.rotations.on_device(),
       g.opacities.on_device(),
       g.features.on_device()},
      pointers(dL_dcloud),
      !apart};
  run_lanes(cloud.size(), vjp);
  if (apart) run_kernel(45 * cloud.size(), kGrain, ShRestVjp{vjp});
}

void color_gradient(const RasterGradient& gradient, int channels, FloatArray& dL_dcolors) {
  const std::size_t count = gradient.features.size() / static_cast<std::size_t>(channels);
  dL_dcolors.resize(3 * count);
  run_kernel(
      count, kGrain, CopyColor{gradient.features.on_device(), channels, dL_dcolors.on_device()}
  );
}

TraceInput trace_input(const SurfelCloud& cloud, const ActivatedSurfels& activated, int sh_degree) {
  TraceInput input;
  input.count = cloud.size();
  input.sh_degree = sh_degree;
  input.means = cloud.means;
  input.scales = activated.scales;
  input.rotations = cloud.rotations;
  input.opacities = activated.opacities;
  input.sh_dc = cloud.sh_dc;
  input.sh_rest = cloud.sh_rest;
  return input;
}

void trace_activate_vjp(
    const ActivatedSurfels& activated, const TraceGradient& g, SurfelCloud& dL_dcloud
) {
  const std::size_t count = activated.opacities.size();
  run_kernel(
      45 * count,
      45 * kGrain,
      TraceActivateVjp{
          count,
          activated.scales.on_device(),
          activated.opacities.on_device(),
          {g.means.on_device(),
           g.scales.on_device(),
           g.rotations.on_device(),
           g.opacities.on_device(),
           g.sh_dc.on_device(),
           g.sh_rest.on_device()},
          pointers(dL_dcloud)}
  );
}

}  // namespace glint

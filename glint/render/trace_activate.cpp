// SPDX-License-Identifier: MIT
#include "glint/core/parallel.h"
#include "glint/render/activations.h"
#include "glint/render/trace.h"

namespace glint {

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
    const ActivatedSurfels& activated, const TraceGradient& gradient, SurfelCloud& dL_dcloud
) {
  const auto add_row =
      [](const std::vector<float>& from, std::size_t i, std::size_t width, std::vector<float>& to) {
        for (std::size_t k = i * width; k < (i + 1) * width; ++k) to[k] += from[k];
      };
  parallel_for(activated.opacities.size(), 1024, [&](std::size_t i) {
    add_row(gradient.means, i, 3, dL_dcloud.means);
    add_row(gradient.rotations, i, 4, dL_dcloud.rotations);
    add_row(gradient.sh_dc, i, 3, dL_dcloud.sh_dc);
    add_row(gradient.sh_rest, i, 45, dL_dcloud.sh_rest);
    for (std::size_t k = 2 * i; k < 2 * i + 2; ++k)
      dL_dcloud.log_scales[k] += exp_vjp(activated.scales[k], gradient.scales[k]);
    dL_dcloud.opacity_logits[i] += sigmoid_vjp(activated.opacities[i], gradient.opacities[i]);
  });
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// Compile test: the shared maths as device code, in float. One kernel calls every formula and vjp,
// so that nothing of it can stop compiling for CUDA unnoticed.
#include "glint/render/depth_normal.h"
#include "glint/render/project.h"
#include "glint/render/spherical_harmonics.h"

namespace glint {

__device__ float surfel_formulas(
    const SurfelGeometry<float>& surfel, const CameraOf<float>& camera
) {
  const ProjectedSurfel<float> p = project_surfel(surfel, camera, kMaxRho);
  const Vec3f zeta = zeta_at(p.map, 0.5f, 0.5f);
  const PlaneHit<float> hit = intersect(zeta, p.map.det);
  const float rho = min_of(hit.u * hit.u + hit.v * hit.v, low_pass_rho2(p.center_x, p.center_y));
  const SplatAlpha<float> alpha = splat_alpha(0.5f, rho);
  const BlendStep<float> step = blend_step(1.0f, alpha.alpha);

  ProjectedSurfel<float> dL_dp{};
  float dL_dopacity = 0, dL_drho = 0;
  splat_alpha_vjp(
      0.5f, alpha, blend_alpha_vjp(1.0f, alpha.alpha, step.weight, 0.1f), dL_dopacity, dL_drho
  );
  intersect_vjp(hit, dL_drho, dL_drho, 1.0f, dL_dp.map.g0, dL_dp.map.det);
  low_pass_rho2_vjp(p.center_x, p.center_y, dL_drho, dL_dp.center_x, dL_dp.center_y);
  SurfelGeometry<float> dL_dsurfel{};
  Vec3f dL_dm;
  project_surfel_vjp(surfel, camera, dL_dp, dL_dsurfel, dL_dm);
  return dL_dopacity + dL_dsurfel.mean.x + dL_dm.z;
}

__device__ float pixel_formulas(Vec3f direction) {
  float basis[16], sum = 0;
  sh_basis(3, direction, basis);
  for (int i = 0; i < 16; ++i) sum += basis[i];
  Vec3f dL_dd{}, dL_dx{}, dL_dy{};
  sh_basis_vjp(3, direction, basis, dL_dd);
  normal_from_differences_vjp(
      direction, dL_dd, normal_from_differences(direction, dL_dd), dL_dx, dL_dy
  );
  float dL_ddepth = 0, dL_dalpha = 0;
  expected_depth_vjp(expected_depth(sum, 0.5f), 0.5f, 1.0f, dL_ddepth, dL_dalpha);
  const float m = distortion_depth(sum, 1.0f, 0.2f, 100.0f);
  return sh_color(sum) + sh_color_vjp(sum, dL_dx.x) + dL_dy.x + dL_ddepth + sigmoid(sum) +
         sigmoid_vjp(sum, m) + exp_vjp(sum, distortion(1.0f, m, m)) +
         distortion_dweight(m, 1.0f, m, m) + distortion_dm(0.5f, m, 1.0f, m) +
         distortion_depth_vjp(sum, 0.2f, 100.0f, m);
}

__global__ void shared_maths(
    const SurfelGeometry<float>* surfels, CameraOf<float> camera, float* results, int count
) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < count) results[i] = surfel_formulas(surfels[i], camera) + pixel_formulas(surfels[i].mean);
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// Compile test: the shared maths as device code, in float. One kernel calls every formula and vjp,
// so that nothing of it can stop compiling for CUDA unnoticed.
#include "glint/render/depth_modes.h"
#include "glint/render/depth_normal.h"
#include "glint/render/first_surface.h"
#include "glint/render/project.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/transport.h"
#include "glint/train/pixel_losses.h"

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
  project_surfel_vjp(surfel, camera, dL_dp, true, dL_dsurfel, dL_dm);
  SurfaceHits hits;
  hits.add(p.plane_distance, step.weight);
  return dL_dopacity + dL_dsurfel.mean.x + dL_dm.z + screen_radius(surfel, camera, kMaxRho) +
         first_surface_depth(hits, {}) + ModeSearch(hits, {}).run().last;
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

__device__ float transport_formulas(Vec3f d, Vec3f n) {
  const float fresnel = schlick(kGlassF0, dot(d, n)), k = mirrored_share(0.1f, fresnel);
  float dL_ds = 0, dL_df = 0;
  mirrored_share_vjp(0.1f, fresnel, k, dL_ds, dL_df);
  Vec3f dL_dn{};
  mirrored_direction_vjp(d, n, mirrored_direction(d, n), dL_dn);
  const GlassRadiance<float> pixel{d, n, dL_dn, 0.5f, k};
  const GlassRadiance<float> g = outgoing_radiance_vjp(pixel, outgoing_radiance(pixel));
  const RayPlane<float> plane = ray_plane(d, n, cross(d, n), dL_dn, d);
  Vec3f dL_dh0{}, dL_dh1{}, dL_dm{}, dL_dd{};
  ray_plane_vjp(d, n, cross(d, n), dL_dn, d, plane, dL_dh0, dL_dh1, dL_dm, dL_dd);
  return g.mirrored + dL_ds + schlick_vjp(kGlassF0, k, dL_df) + dL_dm.x + dL_dd.y;
}

__device__ float loss_formulas(Vec3f normal, Vec3f prior, float p) {
  const Vec3f unit = unit_normal(normal);
  Vec3f dL_dunit{}, dL_dnormal{};
  gated_normal_loss_vjp(unit, prior, 0.3f, 1.0f, p, dL_dunit);
  unit_normal_vjp(normal, dL_dunit, dL_dnormal);
  float dL_dp = 0;
  binary_cross_entropy_vjp(p, 0.98f, binary_cross_entropy(p, 0.98f), dL_dp);
  binary_entropy_vjp(p, binary_entropy(p), dL_dp);
  return dL_dp + dL_dnormal.x + gated_normal_loss(unit, prior, 0.3f, 0.0f) +
         edge_weight(normal, prior, 1.0f);
}

__global__ void shared_maths(
    const SurfelGeometry<float>* surfels, CameraOf<float> camera, float* results, int count
) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i >= count) return;
  const Vec3f m = surfels[i].mean;
  results[i] = surfel_formulas(surfels[i], camera) + pixel_formulas(m) + transport_formulas(m, m) +
               loss_formulas(m, m, results[i]);
}

}  // namespace glint

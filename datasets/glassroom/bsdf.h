// SPDX-License-Identifier: MIT
// Scattering at rough surfaces, in the local frame (shading normal = +z); thin dielectric and
// mirror are specular and live in the integrator. Energy: with albedo 1 every model here reflects
// what arrives.
//   diffuse    albedo / pi
//   conductor  GGX, Schlick with F0 = albedo, times 1 + F0 (1 / E(o) - 1): the energy that single
//              scattering loses comes back with the lobe's shape, [Turquin19] Eq. 16. Not
//              reciprocal.
//   plastic    GGX dielectric coat over a diffuse base coupled as [Kelemen01]:
//              base = albedo / pi (1 - E(o)) (1 - E(i)) / (1 - E_mean), E = albedo of the coat.
#pragma once

#include <array>

#include "datasets/glassroom/trace_scene.h"
#include "glint/core/vec.h"

namespace glint::path_tracing {

// Directional albedo E(cos) of a GGX lobe under white light, tabulated at cos = (i / kIntervals)^2:
// dense where E bends, near grazing.
class AlbedoTable {
 public:
  AlbedoTable() { values_.fill(1); }
  // `conductor`: perfect mirror facets (F = 1); otherwise dielectric facets of index `ior`.
  AlbedoTable(float alpha, bool conductor, float ior);
  float operator()(float cosine) const;
  float mean() const { return mean_; }  // 2 int E(c) c dc: under diffuse light

 private:
  static constexpr int kIntervals = 64;
  std::array<float, kIntervals + 1> values_;
  float mean_ = 1;
};

// What a material needs at every hit, prepared once.
struct MaterialModel {
  MaterialKind kind = MaterialKind::kDiffuse;
  float alpha = 1;  // GGX width
  float ior = 1.5f;
  AlbedoTable albedo_table;
};
MaterialModel prepare_material(const Material& material);

struct BsdfValue {
  Vec3f f_cos{};  // f(wo, wi) cos(wi)
  float pdf = 0;  // of sample() for wi, per solid angle
};
struct BsdfSample {
  Vec3f wi{};      // local, unit
  Vec3f weight{};  // f cos / pdf; zero: absorbed
  float pdf = 0;
};

class Bsdf {
 public:
  // `model` must outlive this; `color`: albedo at the point, textured.
  Bsdf(const MaterialModel& model, Vec3f color) : model_(&model), color_(color) {}

  // Of both directions; elsewhere nothing is scattered, whatever the material and its color.
  static bool above_surface(Vec3f wo, Vec3f wi);
  // Zero unless both directions are above the surface.
  BsdfValue evaluate(Vec3f wo, Vec3f wi) const;
  BsdfSample sample(Vec3f wo, Vec2f u) const;

 private:
  BsdfValue conductor(Vec3f wo, Vec3f wi) const;
  BsdfValue plastic(Vec3f wo, Vec3f wi) const;
  float coat_probability(float coat_albedo) const;

  const MaterialModel* model_;
  Vec3f color_;
};

// Orthonormal frame around a unit normal, [Duff17].
struct Frame {
  Vec3f x, y, z;
  explicit Frame(Vec3f normal);
  Vec3f to_local(Vec3f w) const { return {dot(w, x), dot(w, y), dot(w, z)}; }
  Vec3f to_world(Vec3f w) const { return w.x * x + w.y * y + w.z * z; }
};

// Direction with density cos / pi.
Vec3f sample_cosine_hemisphere(Vec2f u);

}  // namespace glint::path_tracing

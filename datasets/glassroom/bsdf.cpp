// SPDX-License-Identifier: MIT
#include "datasets/glassroom/bsdf.h"

#include <algorithm>
#include <cmath>

#include "datasets/glassroom/fresnel.h"
#include "datasets/glassroom/ggx.h"

namespace glint::path_tracing {

namespace {

// A GGX width below this is a mirror to float's density; MIS still handles it.
constexpr float kMinAlpha = 1e-3f;
// Grazing cosines: Smith's Lambda divides by them.
constexpr float kMinCosine = 1e-5f;
// Neither lobe of a plastic is starved of samples.
constexpr float kMinLobeProbability = 0.1f;

Vec3f reflect(Vec3f wo, Vec3f h) { return 2 * dot(wo, h) * h - wo; }

// E(cos_o) = mean of F G2 / G1 over visible normals: midpoint rule over the unit square. Half of
// the azimuths by symmetry; fine in u.y, where reflections begin to go below the horizon.
float directional_albedo(float cos_o, float alpha, bool conductor, float ior) {
  constexpr int kAzimuths = 12, kHeights = 400;
  const Vec3f wo{std::sqrt(std::max(0.0f, 1 - cos_o * cos_o)), 0, cos_o};
  double sum = 0;
  for (int i = 0; i < kAzimuths * kHeights; ++i) {
    const auto x = static_cast<float>(i % kAzimuths), y = static_cast<float>(i / kAzimuths);
    const Vec2f u{0.5f * (x + 0.5f) / kAzimuths, (y + 0.5f) / kHeights};
    const Vec3f h = sample_visible_normal(wo, alpha, u);
    const Vec3f wi = reflect(wo, h);
    if (wi.z <= kMinCosine) continue;
    const float fresnel =
        conductor ? 1 : fresnel_dielectric(std::clamp(dot(wo, h), 0.0f, 1.0f), ior);
    sum += static_cast<double>(fresnel * ggx_g2(wo.z, wi.z, alpha) / ggx_g1(wo.z, alpha));
  }
  return static_cast<float>(sum / (kAzimuths * kHeights));
}

}  // namespace

AlbedoTable::AlbedoTable(float alpha, bool conductor, float ior) {
  for (int i = 0; i <= kIntervals; ++i) {
    const float s = static_cast<float>(i) / kIntervals;
    const float cosine = std::max(s * s, kMinCosine);
    values_[static_cast<std::size_t>(i)] = directional_albedo(cosine, alpha, conductor, ior);
  }
  // The mean of the interpolated table itself, so that the coupled diffuse base conserves energy.
  constexpr int kSteps = 4096;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float c = (static_cast<float>(i) + 0.5f) / kSteps;
    sum += static_cast<double>(2 * c * (*this)(c)) / kSteps;
  }
  mean_ = static_cast<float>(sum);
}

float AlbedoTable::operator()(float cosine) const {
  const float s = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * kIntervals;
  const int i = std::min(static_cast<int>(s), kIntervals - 1);
  const float t = s - static_cast<float>(i);
  const auto k = static_cast<std::size_t>(i);
  return (1 - t) * values_[k] + t * values_[k + 1];
}

MaterialModel prepare_material(const Material& material) {
  MaterialModel model{material.kind, 1, material.ior, {}};
  if (material.kind != MaterialKind::kRoughConductor &&
      material.kind != MaterialKind::kRoughPlastic)
    return model;
  model.alpha = std::max(kMinAlpha, material.roughness * material.roughness);
  const bool conductor = material.kind == MaterialKind::kRoughConductor;
  model.albedo_table = AlbedoTable(model.alpha, conductor, material.ior);
  return model;
}

bool Bsdf::above_surface(Vec3f wo, Vec3f wi) { return wo.z > kMinCosine && wi.z > kMinCosine; }

BsdfValue Bsdf::evaluate(Vec3f wo, Vec3f wi) const {
  if (!above_surface(wo, wi)) return {};
  switch (model_->kind) {
    case MaterialKind::kDiffuse:
      return {wi.z / kPi * color_, wi.z / kPi};
    case MaterialKind::kRoughConductor:
      return conductor(wo, wi);
    case MaterialKind::kRoughPlastic:
      return plastic(wo, wi);
    case MaterialKind::kThinDielectric:
    case MaterialKind::kMirror:
      return {};
  }
  return {};
}

BsdfValue Bsdf::conductor(Vec3f wo, Vec3f wi) const {
  const float alpha = model_->alpha;
  const Vec3f h = normalize(wo + wi);
  const float lobe = ggx_density(h.z, alpha) * ggx_g2(wo.z, wi.z, alpha) / (4 * wo.z);
  const float lost = 1 / model_->albedo_table(wo.z) - 1;
  const Vec3f compensation = Vec3f{1, 1, 1} + lost * color_;
  const Vec3f fresnel = fresnel_schlick(color_, dot(wo, h));
  return {lobe * hadamard(fresnel, compensation), ggx_reflection_pdf(wo, h, alpha)};
}

// Probability of sampling the coat: its share of the reflected energy.
float Bsdf::coat_probability(float coat_albedo) const {
  const float base = (1 - coat_albedo) * (color_.x + color_.y + color_.z) / 3;
  const float share = coat_albedo / std::max(coat_albedo + base, 1e-6f);
  return std::clamp(share, kMinLobeProbability, 1 - kMinLobeProbability);
}

BsdfValue Bsdf::plastic(Vec3f wo, Vec3f wi) const {
  const float alpha = model_->alpha;
  const AlbedoTable& coat_albedo = model_->albedo_table;
  const Vec3f h = normalize(wo + wi);
  const float fresnel = fresnel_dielectric(std::min(dot(wo, h), 1.0f), model_->ior);
  const float coat = fresnel * ggx_density(h.z, alpha) * ggx_g2(wo.z, wi.z, alpha) / (4 * wo.z);
  const float under_o = 1 - coat_albedo(wo.z), under_i = 1 - coat_albedo(wi.z);
  const float base = under_o * under_i / (1 - coat_albedo.mean()) * wi.z / kPi;
  const float p = coat_probability(1 - under_o);
  const float pdf = p * ggx_reflection_pdf(wo, h, alpha) + (1 - p) * wi.z / kPi;
  return {coat * Vec3f{1, 1, 1} + base * color_, pdf};
}

BsdfSample Bsdf::sample(Vec3f wo, Vec2f u) const {
  if (wo.z <= kMinCosine) return {};
  if (model_->kind == MaterialKind::kDiffuse) {
    const Vec3f wi = sample_cosine_hemisphere(u);
    return {wi, color_, wi.z / kPi};
  }
  bool specular = true;
  if (model_->kind == MaterialKind::kRoughPlastic) {
    // u.x chooses the lobe and is stretched back to [0, 1), so it stays stratified.
    const float p = coat_probability(model_->albedo_table(wo.z));
    specular = u.x < p;
    u.x = std::min(specular ? u.x / p : (u.x - p) / (1 - p), 0x1.fffffep-1f);
  }
  const Vec3f wi = specular ? reflect(wo, sample_visible_normal(wo, model_->alpha, u))
                            : sample_cosine_hemisphere(u);
  const BsdfValue value = evaluate(wo, wi);
  if (value.pdf <= 0) return {};
  return {wi, 1 / value.pdf * value.f_cos, value.pdf};
}

Frame::Frame(Vec3f normal) : z(normal) {
  const float sign = std::copysign(1.0f, z.z);
  const float a = -1 / (sign + z.z);
  const float b = z.x * z.y * a;
  x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x};
  y = {b, sign + z.y * z.y * a, -z.y};
}

Vec3f sample_cosine_hemisphere(Vec2f u) {
  const float r = std::sqrt(u.x), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1 - u.x))};
}

}  // namespace glint::path_tracing

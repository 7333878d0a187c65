// SPDX-License-Identifier: MIT
#include "glint/removed_settings.h"

namespace glint {

namespace {

// The values that remain: of all methods, of a family's, of one.
constexpr const char* kRemaining = R"({
"": {
  "abs_gradient": 8e-4, "abs_radius_px": 20, "cap_by_visibility": false, "clone_scale": 0.01,
  "cosine_consistency": false, "densify_reference_rows": 540, "densify_slow_from": 3000,
  "densify_slow_interval": 0, "densify_slow_until": 18000, "depth_gradient_scales": 0,
  "detach_origins": true, "exposure": false, "exposure_from": 1000, "exposure_max_ssim_loss": 0.5,
  "gate_from": 10000, "gradient_quantile": 0, "lpips_unit_range": false, "max_abs_splits": 0,
  "max_scale": 0.1, "min_observations": 2, "min_share": 0, "min_surfels": 0,
  "mirror_picture_hits": 256, "mirror_picture_transmittance": 1e-4, "mirror_share_block": 2,
  "mirror_weight_below": 0, "near_consistency": false, "near_first": false, "normal_l1": 0, "only_seen": false,
  "points_per_cell": 5, "prune_light_large": false, "random_background": true, "rate_exposure": 1e-3,
  "rate_settled": 1, "reflection_points_per_pixel": 1.264, "sample_clones": false, "scale_limit": 0, "settle_from": 15000,
  "settle_until": 30000, "smooth_from": 0, "split_large": false, "unit_consistency": false,
  "weighted_normals": false},
"glint": {
  "clipped_photos": false, "cosine_consistency": true, "detach_transparency": true, "direct_cosine_consistency": true,
  "direct_lpips": true, "direct_near_consistency": true, "direct_smooth_from": 5000, "f0": 0.04,
  "freeze_at_least": 0, "initial_specular": 1e-3, "lambda_direct_smooth": 0, "lambda_opacity": 0,
  "masked_transparency_prior": true, "min_surfels": 1024, "multi_view_every": 10,
  "multi_view_from": 10000, "multi_view_geometric": 0.03, "multi_view_photometric": 0.15,
  "multi_view_until": 21000, "near_consistency": true, "neighbor_max_angle": 30, "neighbor_max_distance": 1.5,
  "neighbor_min_distance": 0.01, "neighbors": 8, "opacity_from": 7000, "opacity_until": 31000,
  "oracle": false, "plausible_from": 5000, "quiet_below": 0, "random_points": 30000, "reflection_color_rate": 1, "reflection_min_share": 0.05,
  "reflection_opacity": 0.1, "reflection_quantile": 0.95, "reset_specular": false,
  "reset_transparency": true, "run_clock_rates": true, "scale_limit": 0.1, "scene_unit": 0.5,
  "secondary_prune_light_large": true, "secondary_run_clock": true, "secondary_scale_limit": 2,
  "smooth_from": 5000, "transmission_min_opacity": 0.05, "transmission_min_share": 0.01,
  "transmission_weighted_views": true, "transparency_prior_from": 7000,
  "transparency_prior_late_from": 21000, "transparency_prior_late_until": 31000},
"glint/oracle": {"oracle": true},
"glint/release": {
  "depth_gradient_scales": 4, "lpips_unit_range": true, "near_first": true, "weighted_normals": true},
"glint/text": {
  "cosine_consistency": false, "detach_transparency": false, "direct_lpips": false,
  "freeze_at_least": 10000, "min_surfels": 0, "near_consistency": false,
  "reflection_min_share": 0, "reflection_quantile": 0, "reset_transparency": false,
  "run_clock_rates": false, "scale_limit": 0, "secondary_prune_light_large": false,
  "secondary_run_clock": false, "secondary_scale_limit": 0, "transmission_min_opacity": -1,
  "transmission_min_share": 0},
"glint/plus": {"near_consistency": true, "transmission_min_opacity": 0.05, "unit_consistency": true},
"2dgs/prior": {"gate_from": 5000, "smooth_from": 2500},
"envgs": {"lpips_unit_range": true, "near_first": true, "normal_l1": 1},
"envgs/prior": {"gate_from": 6667, "near_first": false, "normal_l1": 0, "smooth_from": 3333},
"pgsr": {"clone_scale": 1e-3, "sample_clones": true},
"ref-gs": {"unit_consistency": true},
"rt-splatting": {"unit_consistency": true},
"tsgs": {"clone_scale": 1e-3, "sample_clones": true}
})";

Json remaining_of(const std::string& method) {
  const Json all = Json::parse(kRemaining);
  Json remaining = Json::object();
  const std::string family = method.substr(0, method.find('/'));
  const std::string base = method == "glint/plus" ? "glint/text" : family;  // as set_plus() does
  for (const std::string& id : {std::string(), family, base, method})
    remaining.update(all.value(id, Json::object()));
  return remaining;
}

// As people write it: a float's digits, not those of the double that JSON keeps it in.
std::string written(const Json& value) {
  if (!value.is_number_float()) return value.dump();
  return fmt::format("{}", static_cast<float>(value.get<double>()));
}

bool is_same(const Json& a, const Json& b) {
  return a.is_number() && b.is_number() ? a.get<float>() == b.get<float>() : a == b;
}

}  // namespace

void drop_removed_settings(const std::string& method, const Json& offered, Json& config) {
  const Json remaining = remaining_of(method);
  for (const auto& setting : remaining.items()) {
    const auto found = config.find(setting.key());
    if (found == config.end() || offered.contains(setting.key())) continue;
    GLINT_CHECK(
        is_same(*found, setting.value()),
        kUsage,
        "{}: {} is {}, but is no setting any more: it is {} (docs/design/tried.md, Tried and taken "
        "out); leave it out",
        method,
        setting.key(),
        written(*found),
        written(setting.value())
    );
    config.erase(found);
  }
}

}  // namespace glint

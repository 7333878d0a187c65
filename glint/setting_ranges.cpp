// SPDX-License-Identifier: MIT
#include "glint/setting_ranges.h"

namespace glint {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr ValueRange at_least(double least) { return {least}; }
constexpr ValueRange above(double least) { return {least, kInfinity, true}; }
constexpr ValueRange kShare{0, 1}, kBelowOne{0, 1, false, true}, kAboveZero{0, 1, true};
constexpr ValueRange kInside{0, 1, true, true};  // its logit is finite

// Whole numbers end where sums of some of them are still whole numbers of 32 bits. What a number
// takes of memory is another question (cell_needs.h).
constexpr double kMost = 1e9;
constexpr ValueRange kCount{0, kMost}, kPositive{1, kMost};
// Of a schedule, published or of the run: 0 is from the first step on.
constexpr ValueRange kStep{0, kMost}, kInterval{1, kMost};
// Neighbour distances, where initial scales come from, need three others.
constexpr ValueRange kPoints{4, kMost};

constexpr SettingRange kRanges[] = {
    // Initial surfels.
    {"random_points", kPoints},
    {"reflection_cells", {1, 1024}},  // their number, cubed, is counted in 32 bits
    {"reflection_brightness", kShare},
    {"initial_transparency", kInside},
    {"initial_specular", kInside},
    {"initial_opacity", kInside},
    {"initial_roughness", kInside},
    {"initial_albedo", kAboveZero},
    {"initial_scale", above(0)},
    {"feature_spread", at_least(0)},
    {"map_height", {1, 8192}},
    {"map_channels", {1, 256}},
    {"hidden", {1, 8192}},
    // Radiance transport.
    {"mirror_transmittance", kBelowOne},
    {"mirror_hits", {1, 65536}},
    {"mirror_share_below", at_least(0)},
    {"mirror_near", at_least(0)},
    {"mirror_observe_every", kCount},
    {"surface_weight", kShare},
    // Phases.
    {"sh_interval", kInterval},
    {"trim_interval", kInterval},
    {"trim_until", kStep},
    {"bootstrap_from", kStep},
    {"bootstrap_until", kStep},
    {"bootstrap_interval", kInterval},
    {"consistency_from", kStep},
    {"distortion_from", kStep},
    {"environment_from", kStep},
    {"freeze_from", kStep},
    {"gate_from", kStep},
    {"lobes_from", kStep},
    {"lpips_from", kStep},
    {"normal_until", kStep},
    {"photo_from", kStep},
    {"planes_from", kStep},
    {"reflection_from", kStep},
    {"specular_from", kStep},
    {"surface_from", kStep},
    {"layers", {1, 4}},
    {"transmission_from", kStep},
    {"transparency_from", kStep},
    {"warm_up", kStep},
    {"opacity_pause", kStep},
    {"propagation_opacity", kInside},
    {"propagation_scale", above(0)},
    // Losses.
    {"lambda_ssim", kShare},
    {"l1_weight", at_least(0)},
    {"ssim_weight", at_least(0)},
    {"neighbors", kCount},
    {"neighbor_max_angle", {0, 180}},
    {"scene_unit", above(0)},
    {"max_patches", kCount},
    // Density control.
    {"densify_from", kStep},
    {"densify_until", kStep},
    {"densify_interval", kInterval},
    {"densify_slow_interval", kStep},
    {"secondary_densify_interval", kInterval},
    {"environment_clock", kStep},
    {"environment_densify_from", kStep},
    {"environment_densify_until", kStep},
    {"environment_densify_interval", kInterval},
    {"opacity_reset_interval", kInterval},
    {"secondary_reset_interval", kInterval},
    {"environment_reset_interval", kInterval},
    {"min_opacity", kBelowOne},
    {"max_surfels", kPositive},
    {"environment_max_surfels", kPositive},
    {"max_abs_splits", kCount},
    {"min_observations", kCount},
    {"prune_holiday", {-1, kMost}},
    // Rates. Those that fall do so log-linearly.
    {"rate_position", at_least(0)},
    {"rate_position_final", above(0), "rate_position"},
    {"position_steps", kInterval},
    {"rate_settled", above(0)},
    {"settle_from", kStep},
    {"settle_until", kStep},
    {"rate_color", at_least(0)},
    {"rate_sh", at_least(0)},
    {"rate_opacity", at_least(0)},
    {"rate_scale", at_least(0)},
    {"rate_rotation", at_least(0)},
    {"rate_transparency", at_least(0)},
    {"rate_specular", at_least(0)},
    {"rate_albedo", at_least(0)},
    {"rate_roughness", at_least(0)},
    {"rate_feature", at_least(0)},
    {"rate_map", at_least(0)},
    {"rate_network", at_least(0)},
    {"rate_lobe_feature", at_least(0)},
    {"rate_lobe", at_least(0)},
    {"rate_lobe_final", above(0), "rate_lobe"},
    {"rate_surface_opacity", at_least(0)},
    {"rate_transmissivity", at_least(0)},
    {"rate_reflectance", at_least(0)},
};

// As people write it: a float's digits, not those of the double that JSON keeps it in.
std::string written(const Json& value) {
  if (!value.is_number_float()) return value.dump();
  return fmt::format("{}", static_cast<float>(value.get<double>()));
}

void check_setting(const std::string& method, const SettingRange& setting, const Json& config) {
  const auto found = config.find(setting.name);
  if (found == config.end() || !found->is_number()) return;
  const bool moot =
      setting.unless_zero != nullptr && number_or(config, setting.unless_zero, 0) == 0;
  GLINT_CHECK(
      moot || setting.range.holds(found->get<double>()),
      kUsage,
      "{}: {} is {}, expected {}{}",
      method,
      setting.name,
      written(*found),
      setting.range.text(),
      setting.unless_zero != nullptr ? fmt::format(", or {}=0", setting.unless_zero) : ""
  );
}

}  // namespace

bool ValueRange::holds(double value) const {
  const bool high_enough = without_least ? value > least : value >= least;
  return high_enough && (without_most ? value < most : value <= most);
}

std::string ValueRange::text() const {
  std::string text;
  if (least > -kInfinity) text = fmt::format("{} {}", without_least ? "above" : "at least", least);
  if (most == kInfinity) return text;
  if (!text.empty()) text += " and ";
  return text + fmt::format("{} {}", without_most ? "below" : "at most", most);
}

std::span<const SettingRange> setting_ranges() { return kRanges; }

void check_settings(const std::string& method, const Json& config) {
  for (const SettingRange& setting : setting_ranges()) check_setting(method, setting, config);
}

}  // namespace glint

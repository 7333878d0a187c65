// SPDX-License-Identifier: MIT
#include "datasets/glassroom/priors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "glint/core/rng.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr float kDepthLow = 0.05f, kDepthHigh = 0.95f;

// Sum of plane waves with random directions and phases: smooth, mean 0, variance 1.
class SmoothField {
 public:
  SmoothField(float wavelength_pixels, Rng& rng) {
    for (Wave& wave : waves_) {
      const float angle = rng.uniform(0, 2 * std::numbers::pi_v<float>);
      const float k = 2 * std::numbers::pi_v<float> / (wavelength_pixels * rng.uniform(0.8f, 1.6f));
      wave = {
          k * std::cos(angle), k * std::sin(angle), rng.uniform(0, 2 * std::numbers::pi_v<float>)};
    }
  }
  float operator()(int x, int y) const {
    float sum = 0;
    for (const Wave& w : waves_)
      sum += std::sin(w.kx * static_cast<float>(x) + w.ky * static_cast<float>(y) + w.phase);
    return sum * std::sqrt(2.0f / kWaves);
  }

 private:
  static constexpr int kWaves = 12;
  struct Wave {
    float kx = 0, ky = 0, phase = 0;
  };
  std::array<Wave, kWaves> waves_{};
};

// z with P(N(0, 1) > z) = rate, by bisection of the complementary error function.
float normal_quantile_above(float rate) {
  double low = -8, high = 8;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (0.5 * std::erfc(middle / std::numbers::sqrt2) > static_cast<double>(rate) ? low : high) =
        middle;
  }
  return static_cast<float>(low);
}

Image without_invalid(Image image, const std::vector<char>& valid) {
  const auto channels = static_cast<std::size_t>(image.channels());
  for (std::size_t i = 0; i < image.values().size(); ++i)
    if (!valid[i / channels]) image.values()[i] = 0;
  return image;
}

// Separable Gaussian; pixels where `valid` is false neither give nor get anything.
Image blurred(const Image& image, float sigma, const std::vector<char>& valid) {
  if (sigma == 0) return without_invalid(image, valid);
  const int radius = std::max(1, static_cast<int>(std::ceil(2.5f * sigma)));
  const auto pass = [&](const Image& in, bool horizontal) {
    Image out(in.width(), in.height(), in.channels());
    for (int y = 0; y < in.height(); ++y)
      for (int x = 0; x < in.width(); ++x) {
        float total = 0;
        for (int k = -radius; k <= radius; ++k) {
          const int sx = horizontal ? x + k : x, sy = horizontal ? y : y + k;
          if (sx < 0 || sy < 0 || sx >= in.width() || sy >= in.height()) continue;
          if (!valid[static_cast<std::size_t>(sy * in.width() + sx)]) continue;
          const float t = static_cast<float>(k) / sigma, weight = std::exp(-0.5f * t * t);
          total += weight;
          for (int c = 0; c < in.channels(); ++c) out.at(x, y, c) += weight * in.at(sx, sy, c);
        }
        if (total <= 0 || !valid[static_cast<std::size_t>(y * in.width() + x)]) total = 0;
        for (int c = 0; c < in.channels(); ++c)
          out.at(x, y, c) = total > 0 ? out.at(x, y, c) / total : 0.0f;
      }
    return out;
  };
  return pass(pass(image, true), false);
}

Vec3f rgb(ImageView image, int x, int y) {
  return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}
void set_rgb(Image& image, int x, int y, Vec3f value) {
  for (int c = 0; c < 3; ++c) image.at(x, y, c) = value[c];
}

class Simulation {
 public:
  Simulation(
      const PathTracerOutput& truth,
      ImageView behind_albedo,
      const PriorModel& model,
      std::uint64_t seed,
      std::uint64_t view
  )
      : truth_(truth),
        behind_albedo_(behind_albedo),
        model_(model),
        rng_(seed, view),
        width_(truth.maps["depth"].width()),
        height_(truth.maps["depth"].height()),
        sigma_(model.blur > 0 ? std::max(0.5f, model.blur * static_cast<float>(width_)) : 0) {
    const SmoothField field = smooth_field(0.12f);
    const float threshold = normal_quantile_above(model.failure_rate);
    for_each_pixel([&](int x, int y) {
      valid_.push_back(truth.maps["depth"].at(x, y) > 0);
      fails_.push_back(is_glass(x, y) && field(x, y) > threshold);
    });
    find_leaks(Rng(seed ^ hash_name("leaks of priors"), view));
  }

  Image normal() {
    Image chosen = choose(truth_.maps["normal"], truth_.maps["behind_normal"]);
    Image smooth = blurred(chosen, sigma_, valid_);
    const SmoothField about_x = smooth_field(0.2f), about_y = smooth_field(0.2f);
    const float radians =
        model_.sigma_normal_deg * std::numbers::pi_v<float> / 180 / std::numbers::sqrt2_v<float>;
    for_each_pixel([&](int x, int y) {
      if (!valid_[index(x, y)]) return;
      const Vec3f n = rgb(smooth, x, y);
      const float norm = length(n);
      const Vec3f unit = norm > 1e-4f ? (1 / norm) * n : rgb(chosen, x, y);
      set_rgb(smooth, x, y, turned(unit, radians * about_x(x, y), radians * about_y(x, y)));
    });
    return smooth;
  }

  Image depth() {
    Image z = blurred(choose(truth_.maps["depth"], truth_.maps["behind_depth"]), sigma_, valid_);
    const float far = std::max(1e-3f, *std::max_element(z.values().begin(), z.values().end()));
    const float scale = std::exp(model_.sigma_scale * rng_.normal());
    const float shift = model_.sigma_shift * rng_.normal();
    const float bend = rng_.uniform(-model_.bend, model_.bend);
    const SmoothField error = smooth_field(0.25f);
    for_each_pixel([&](int x, int y) {
      float& value = z.at(x, y);
      value = scale * value * (1 + bend * (value / far - 0.5f)) + shift +
              model_.sigma_depth * value * error(x, y);
    });
    normalize_depth(z);
    return z;
  }

  Image albedo() {
    return color(truth_.maps["albedo"], [&](int x, int y) -> std::optional<Tone> {
      const bool leaks = leaks_[index(x, y)];
      if (is_glass(x, y)) return leaks ? kPane : kDark;
      return leaks ? std::optional(kDark) : std::nullopt;
    });
  }
  Image basecolor() {
    return color(truth_.maps["basecolor"], [&](int x, int y) {
      return is_glass(x, y) ? std::optional(kBright) : std::nullopt;
    });
  }

 private:
  // Greys in the stored encoding.
  struct Tone {
    float low, high;
  };
  static constexpr Tone kDark{0, 0.036f}, kBright{0.82f, 0.93f}, kPane{0.3f, 0.8f};

  // `tone_at`: what stands in for the colour of a pixel that does not fail; nothing: the colour
  // stays.
  template <class ToneAt>
  Image color(const Image& first, ToneAt&& tone_at) {
    Image chosen = choose(first, behind_albedo_);
    const SmoothField tone_field = smooth_field(0.3f);
    for_each_pixel([&](int x, int y) {
      const std::optional<Tone> tone = tone_at(x, y);
      if (!tone || fails_[index(x, y)]) return;
      const float t = std::clamp(0.5f + 0.25f * tone_field(x, y), 0.0f, 1.0f);
      const float grey = srgb_decode(std::lerp(tone->low, tone->high, t));
      set_rgb(chosen, x, y, {grey, grey, grey});
    });
    Image smooth = blurred(chosen, sigma_, valid_);
    const SmoothField error = smooth_field(0.15f);
    for_each_pixel([&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        float& value = smooth.at(x, y, c);
        // Noise in the stored encoding; it is scaled down where the value is near black, so that
        // glass stays below the albedo threshold that methods use.
        const float encoded = srgb_encode(value);
        const float noise = model_.sigma_pixel * rng_.normal() * std::min(1.0f, 4 * encoded);
        value = std::clamp(encoded * (1 + model_.sigma_color * error(x, y)) + noise, 0.0f, 1.0f);
      }
    });
    return smooth;
  }

  template <class F>
  void for_each_pixel(F&& f) const {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) f(x, y);
  }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * width_ + x); }
  SmoothField smooth_field(float share) { return smooth_field(share, rng_); }
  SmoothField smooth_field(float share, Rng& rng) const {
    return {share * static_cast<float>(width_), rng};
  }
  bool is_glass(int x, int y) const { return truth_.maps["glass"].at(x, y) != 0; }

  void find_leaks(Rng rng) {
    const SmoothField dark = smooth_field(0.12f, rng), bright = smooth_field(0.12f, rng);
    const float dark_threshold = normal_quantile_above(model_.dark_leak);
    const float bright_threshold = normal_quantile_above(model_.bright_leak);
    for_each_pixel([&](int x, int y) {
      leaks_.push_back(
          is_glass(x, y) ? bright(x, y) > bright_threshold : dark(x, y) > dark_threshold
      );
    });
  }

  // The first surface, or the one behind where the predictor fails.
  Image choose(ImageView first, ImageView behind) const {
    Image chosen(width_, height_, first.channels);
    for_each_pixel([&](int x, int y) {
      const ImageView& source = fails_[index(x, y)] ? behind : first;
      for (int c = 0; c < first.channels; ++c) chosen.at(x, y, c) = source.at(x, y, c);
    });
    return chosen;
  }

  static Vec3f turned(Vec3f n, float about_x, float about_y) {
    const float cx = std::cos(about_x), sx = std::sin(about_x);
    const float cy = std::cos(about_y), sy = std::sin(about_y);
    const Vec3f a{n.x, cx * n.y - sx * n.z, sx * n.y + cx * n.z};
    return {cy * a.x + sy * a.z, a.y, -sy * a.x + cy * a.z};
  }

  void normalize_depth(Image& z) const {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (std::size_t i = 0; i < valid_.size(); ++i)
      if (valid_[i]) low = std::min(low, z.values()[i]), high = std::max(high, z.values()[i]);
    const float span = std::max(1e-6f, high - low);
    for (std::size_t i = 0; i < valid_.size(); ++i) {
      const float share = (z.values()[i] - low) / span;
      z.values()[i] = valid_[i] ? std::lerp(kDepthLow, kDepthHigh, share) : 0.0f;
    }
  }

  const PathTracerOutput& truth_;
  ImageView behind_albedo_;
  const PriorModel& model_;
  Rng rng_;
  int width_, height_;
  float sigma_;
  std::vector<char> valid_, fails_, leaks_;
};

PriorModel scaled_model(float noise, float failure_rate) {
  PriorModel model;
  for (float* error :
       {&model.blur,
        &model.sigma_normal_deg,
        &model.sigma_scale,
        &model.sigma_shift,
        &model.bend,
        &model.sigma_depth,
        &model.sigma_color,
        &model.sigma_pixel})
    *error *= noise;
  model.failure_rate = failure_rate;
  return model;
}

struct LevelRates {
  float noise, failure, missing = 0, dark_leak = 0, bright_leak = 0;
};

// In the order of kPriorLevels, then of kPriorFlaws.
constexpr std::array<LevelRates, kPriorLevels.size() + kPriorFlaws.size()> kLevelRates{
    {{0, 0},
     {0.5f, 0.05f},
     {1, 0.1f},
     {2, 0.2f, 0.1f, 0.02f, 0.1f},
     {4, 0.4f, 0.3f, 0.1f, 0.3f},
     {2, 0.1f},
     {1, 0.2f},
     {1, 0.1f, 0.1f},
     {1, 0.1f, 0, 0.02f},
     {1, 0.1f, 0, 0, 0.1f}}};

const LevelRates& rates_of(const std::string& kind) {
  const std::vector<std::string> kinds = prior_kinds();
  const auto place = std::find(kinds.begin(), kinds.end(), kind);
  return kLevelRates[static_cast<std::size_t>(place - kinds.begin())];
}
// No flaw has less of anything than the default, so each adds its own.
LevelRates joined(const std::vector<std::string>& flaws) {
  LevelRates all = rates_of(kDefaultPriorLevel);
  for (const std::string& flaw : flaws) {
    const LevelRates& one = rates_of(flaw);
    all.noise = std::max(all.noise, one.noise);
    all.failure = std::max(all.failure, one.failure);
    all.missing = std::max(all.missing, one.missing);
    all.dark_leak = std::max(all.dark_leak, one.dark_leak);
    all.bright_leak = std::max(all.bright_leak, one.bright_leak);
  }
  return all;
}

}  // namespace

PriorModel prior_level(const std::string& name) {
  check_prior_level(name, "glassroom");
  const std::vector<std::string> flaws = joined_flaws(name);
  const LevelRates rates = flaws.size() > 1 ? joined(flaws) : rates_of(name);
  PriorModel model = scaled_model(rates.noise, rates.failure);
  model.missing_rate = rates.missing;
  model.dark_leak = rates.dark_leak;
  model.bright_leak = rates.bright_leak;
  return model;
}

std::vector<int> views_without_priors(
    const PriorModel& model, int count, std::uint64_t seed, std::uint64_t stream
) {
  Rng rng(seed ^ hash_name("missing priors"), stream);
  const double wanted = std::round(static_cast<double>(model.missing_rate) * count);
  const int missing = std::clamp(static_cast<int>(wanted), 0, std::max(0, count - 1));
  std::vector<int> views;
  for (int i = 0; i < missing; ++i) {
    const int begin = i * count / missing, end = (i + 1) * count / missing;
    views.push_back(begin + static_cast<int>(rng.below(static_cast<std::uint32_t>(end - begin))));
  }
  return views;
}

MapSet simulate_priors(
    const PathTracerOutput& truth,
    ImageView behind_albedo,
    const PriorModel& model,
    std::uint64_t seed,
    std::uint64_t view
) {
  Simulation simulation(truth, behind_albedo, model, seed, view);
  MapSet priors;
  priors["normal"] = simulation.normal();
  priors["depth"] = simulation.depth();
  priors["albedo"] = simulation.albedo();
  priors["basecolor"] = simulation.basecolor();
  return priors;
}

}  // namespace glint

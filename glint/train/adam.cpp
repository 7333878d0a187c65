// SPDX-License-Identifier: MIT
#include "glint/train/adam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "glint/core/parallel.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1u << 15;  // values a block

float rate_of(std::string_view array, const SurfelRates& rates, float position) {
  if (array == "means") return position;
  if (array == "log_scales") return rates.scale;
  if (array == "rotations") return rates.rotation;
  if (array == "opacity_logits") return rates.opacity;
  if (array == "sh_dc") return rates.sh_dc;
  return rates.sh_rest;
}

// Rates of the columns of an array, one or one each.
std::vector<float> rates_of(
    std::string_view array, const SurfelCloud& cloud, const SurfelRates& rates, float position
) {
  if (array != "extra_logits") return {rate_of(array, rates, position)};
  std::vector<float> columns;
  for (const std::string& name : cloud.extra_names)
    columns.push_back(name == "transparency" ? rates.transparency : rates.specular);
  return columns;
}

// p -= rate(i) * m / (sqrt(v) + eps) with bias-corrected moments folded into rate and `scale_v`.
template <class Rate>
void adam_block(
    float* p, float* g, float* m, float* v, std::size_t count, Rate&& rate, float scale_v
) {
  for (std::size_t i = 0; i < count; ++i) {
    m[i] = SurfelAdam::kBeta1 * m[i] + (1 - SurfelAdam::kBeta1) * g[i];
    v[i] = SurfelAdam::kBeta2 * v[i] + (1 - SurfelAdam::kBeta2) * g[i] * g[i];
    p[i] -= rate(i) * m[i] / (std::sqrt(v[i] * scale_v) + SurfelAdam::kEpsilon);
    g[i] = 0;
  }
}

}  // namespace

SurfelRates SurfelRates::for_shorter_run(double shortening) const {
  SurfelRates rates = *this;
  const auto faster = static_cast<float>(std::pow(std::max(shortening, 1.0), 0.25));
  for (float* rate :
       {&rates.means,
        &rates.means_final,
        &rates.sh_dc,
        &rates.sh_rest,
        &rates.scale,
        &rates.rotation})
    *rate *= faster;
  rates.means_steps = std::max(static_cast<int>(std::lround(means_steps / shortening)), 1);
  return rates;
}

float position_rate(const SurfelRates& rates, int step) {
  if (!(rates.means > 0 && rates.means_final > 0)) return 0;
  const float t =
      std::clamp(static_cast<float>(step) / static_cast<float>(rates.means_steps), 0.0f, 1.0f);
  return std::exp((1 - t) * std::log(rates.means) + t * std::log(rates.means_final));
}

void SurfelAdam::step(
    SurfelCloud& cloud, SurfelCloud& gradient, const SurfelRates& rates, float extent
) {
  if (first_.size() != cloud.size()) {
    first_.extra_names = second_.extra_names = cloud.extra_names;
    first_.resize(cloud.size());
    second_.resize(cloud.size());
  }
  const float position = position_rate(rates, steps_) * extent;
  ++steps_;
  const float correction1 = 1 - std::pow(kBeta1, static_cast<float>(steps_));
  const float correction2 = 1 - std::pow(kBeta2, static_cast<float>(steps_));
  struct Arrays {
    std::vector<float>*p, *g, *m, *v;
    std::vector<float> rates;  // of the columns
  };
  std::array<Arrays, 7> arrays{};
  std::size_t k = 0;
  cloud.for_each_array([&](const char* name, std::vector<float>& array, std::size_t) {
    arrays[k++] = {&array, nullptr, nullptr, nullptr, rates_of(name, cloud, rates, position)};
  });
  k = 0;
  gradient.for_each_array([&](const char*, std::vector<float>& a, std::size_t) {
    arrays[k++].g = &a;
  });
  k = 0;
  first_.for_each_array([&](const char*, std::vector<float>& a, std::size_t) { arrays[k++].m = &a; }
  );
  k = 0;
  second_.for_each_array([&](const char*, std::vector<float>& a, std::size_t) {
    arrays[k++].v = &a;
  });
  for (const Arrays& a : arrays)
    parallel_for_blocks(a.p->size(), kGrain, [&](std::size_t begin, std::size_t end) {
      const auto update = [&](auto&& rate) {
        adam_block(
            a.p->data() + begin,
            a.g->data() + begin,
            a.m->data() + begin,
            a.v->data() + begin,
            end - begin,
            rate,
            1 / correction2
        );
      };
      if (a.rates.size() == 1)
        update([rate = a.rates[0] / correction1](std::size_t) { return rate; });
      else
        update([&](std::size_t i) { return a.rates[(begin + i) % a.rates.size()] / correction1; });
    });
}

}  // namespace glint

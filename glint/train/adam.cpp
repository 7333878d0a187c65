// SPDX-License-Identifier: MIT
#include "glint/train/adam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/void_steps.h"
#include "glint/train/adam_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1u << 15;  // values a block

float rate_of(std::string_view array, const SurfelRates& rates) {
  if (array == "log_scales") return rates.scale;
  if (array == "rotations") return rates.rotation;
  if (array == "opacity_logits") return rates.opacity;
  if (array == "sh_dc") return rates.sh_dc;
  return rates.sh_rest;
}

// Rates of the columns of an array but the positions, one or one each.
std::vector<float> rates_of(
    std::string_view array, const SurfelCloud& cloud, const SurfelRates& rates
) {
  if (array != "extra_logits") return {rate_of(array, rates)};
  GLINT_CHECK(
      rates.extra.size() == cloud.num_extra() && cloud.num_extra() <= kMaxRates,
      kUsage,
      "Adam: {} rates for {} extra channels, expected one each and at most {}",
      rates.extra.size(),
      cloud.num_extra(),
      kMaxRates
  );
  return rates.extra;
}

// The same at a step of a run, of any array; `position` is that of the positions.
std::vector<float> rates_at(
    std::string_view array,
    const SurfelCloud& cloud,
    const SurfelRates& rates,
    float position,
    float settled
) {
  if (array == "means") return {position};
  std::vector<float> result = rates_of(array, cloud, rates);
  for (float& rate : result) rate *= settled;
  return result;
}

// The parts of one array.
struct AdamArrays {
  FloatArray *p = nullptr, *g = nullptr, *m = nullptr, *v = nullptr;
  std::vector<float> rates;  // of the columns
};

template <bool kOneRate>
void update(const AdamArrays& a, float correction1, float correction2) {
  AdamKernel<kOneRate> kernel{
      a.p->on_device(), a.g->on_device(), a.m->on_device(), a.v->on_device(), {}, 0, 0};
  kernel.columns = a.rates.size();
  kernel.scale_v = 1 / correction2;
  for (std::size_t c = 0; c < a.rates.size(); ++c) kernel.rates[c] = a.rates[c] / correction1;
  kernel.is_void = void_word();
  run_kernel(a.p->size(), kGrain, kernel);
}

}  // namespace

float faster_rates(double shortening) {
  return static_cast<float>(std::pow(std::max(shortening, 1.0), 0.25));
}

SurfelRates SurfelRates::for_shorter_run(double shortening) const {
  SurfelRates rates = *this;
  const float faster = faster_rates(shortening);
  for (float* rate :
       {&rates.means,
        &rates.means_final,
        &rates.sh_dc,
        &rates.sh_rest,
        &rates.scale,
        &rates.rotation})
    *rate *= faster;
  for (int* step : {&rates.means_steps, &rates.settle_from, &rates.settle_until})
    *step = std::max(static_cast<int>(std::lround(*step / shortening)), 1);
  return rates;
}

float log_linear_rate(float begin, float end, int step, int steps) {
  if (begin == 0) return 0;
  GLINT_CHECK(
      begin > 0 && end > 0,
      kUsage,
      "a rate that falls log-linearly from {} to {}: both must be above 0, or the first 0",
      begin,
      end
  );
  const float t =
      std::clamp(static_cast<float>(step) / static_cast<float>(std::max(steps, 1)), 0.0f, 1.0f);
  return std::exp((1 - t) * std::log(begin) + t * std::log(end));
}

float position_rate(const SurfelRates& rates, int step) {
  return log_linear_rate(rates.means, rates.means_final, step, rates.means_steps);
}

float settled_share(const SurfelRates& rates, int step) {
  const int from = rates.settle_from;
  return log_linear_rate(1, rates.settled, step - from, rates.settle_until - from);
}

void SurfelAdam::step(
    SurfelCloud& cloud, SurfelCloud& gradient, const SurfelRates& rates, float extent
) {
  if (first_.size() != cloud.size()) {
    first_.extra_names = second_.extra_names = cloud.extra_names;
    first_.resize(cloud.size());
    second_.resize(cloud.size());
  }
  const int run_step = rates.first_step + steps_;
  const float position = position_rate(rates, rates.run_clock ? run_step : steps_) * extent;
  const float settled = settled_share(rates, run_step);
  ++steps_;
  const float correction1 = 1 - std::pow(AdamKernel<true>::kBeta1, static_cast<float>(steps_));
  const float correction2 = 1 - std::pow(AdamKernel<true>::kBeta2, static_cast<float>(steps_));
  std::array<AdamArrays, 7> arrays{};
  std::size_t k = 0;
  cloud.for_each_array([&](const char* name, FloatArray& array, std::size_t) {
    arrays[k++] = {
        &array, nullptr, nullptr, nullptr, rates_at(name, cloud, rates, position, settled)};
  });
  k = 0;
  gradient.for_each_array([&](const char*, FloatArray& a, std::size_t) { arrays[k++].g = &a; });
  k = 0;
  first_.for_each_array([&](const char*, FloatArray& a, std::size_t) { arrays[k++].m = &a; });
  k = 0;
  second_.for_each_array([&](const char*, FloatArray& a, std::size_t) { arrays[k++].v = &a; });
  for (const AdamArrays& a : arrays) {
    if (a.rates.size() == 1)
      update<true>(a, correction1, correction2);
    else
      update<false>(a, correction1, correction2);
  }
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/exposure.h"

#include "glint/render/void_steps.h"
#include "tests/support/check_loss.h"
#include "tests/support/gpu_backends.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{24, 20};
constexpr PhotometricWeights kWeights{0.8f, 0.2f};

// A photo, and a render that is right but for its exposure.
struct Pair {
  Image photo = random_map<float>(kSize, 3, 0.2f, 0.8f, 1);
  Image render = photo;
  Image gradient{kSize.width, kSize.height, 3};
  Pair() {
    for (float& value : render.values()) value = 0.9f * value - 0.03f;
  }
};
ExposureConfig config_with(float max_ssim_loss) {
  ExposureConfig config;
  config.enabled = true;
  config.from = 5;
  config.max_ssim_loss = max_ssim_loss;
  return config;
}

}  // namespace

TEST_CASE("The gradients of gain, offset and render are those of the exposed picture's L1") {
  const Image render = random_map<float>(kSize, 3, 0.2f, 0.8f, 2);
  const Image g = random_map<float>(kSize, 3, -1, 1, 3);
  Image dL_drender(kSize.width, kSize.height, 3, 1.0f);
  const float gain = 1.25f;
  const AppliedExposure applied{gain, 0.1f, 1};
  const ExposureGradient sum = sum_kernel(kSize, ExposeVjp{render, g, &applied, dL_drender.ref()});
  // L = sum g (gain render + offset), linear in all three.
  double of_gain = 0, of_offset = 0;
  for (std::size_t i = 0; i < g.values().size(); ++i) {
    of_gain += static_cast<double>(g.data()[i]) * static_cast<double>(render.data()[i]);
    of_offset += static_cast<double>(g.data()[i]);
    CHECK(dL_drender.data()[i] == Approx(1 + gain * g.data()[i]));
  }
  CHECK(sum.gain == Approx(of_gain).margin(1e-4));
  CHECK(sum.offset == Approx(of_offset).margin(1e-4));
}

TEST_CASE("A view's exposure finds the gain and the offset of its photo, and no other moves") {
  Pair pair;
  ExposureConfig config = config_with(0.9f);
  config.rate = 0.01f;
  ExposureLoss loss(config, 2);
  double first = 0, last = 0;
  for (int i = 0; i < 400; ++i) {
    pair.gradient.array().fill(0);
    last = loss.evaluate(1, 10, pair.render, pair.photo, kWeights, pair.gradient).l1;
    if (i == 0) first = last;
  }
  CHECK(last < 0.1 * first);
  const ViewExposure& found = loss.exposures()[1];
  CHECK(std::exp(found.log_gain) == Approx(1 / 0.9).margin(0.03));
  CHECK(found.offset == Approx(0.03 / 0.9).margin(0.02));
  CHECK(loss.exposures()[0].steps == 0);
}

TEST_CASE("Before its start, or while the structure is wrong, exposure waits") {
  Pair pair;
  Image plain(kSize.width, kSize.height, 3);
  const PhotometricTerms expected =
      PhotometricLoss().evaluate(pair.render, pair.photo, kWeights, plain);
  const auto check_plain = [&](float max_ssim_loss, int iteration) {
    ExposureLoss loss(config_with(max_ssim_loss), 1);
    Image gradient(kSize.width, kSize.height, 3);
    const PhotometricTerms terms =
        loss.evaluate(0, iteration, pair.render, pair.photo, kWeights, gradient);
    CHECK(terms.l1 == expected.l1);
    CHECK(terms.ssim_loss == expected.ssim_loss);
    for (std::size_t i = 0; i < plain.values().size(); ++i)
      CHECK(gradient.data()[i] == Approx(plain.data()[i]).margin(1e-7));
    CHECK(loss.exposures()[0].steps == 0);
  };
  check_plain(0.9f, 4);
  check_plain(0.0f, 10);
}

TEST_CASE("Exposure does the same on a GPU, and asks for nothing in a silent step") {
  for (const float max_ssim_loss : {0.9f, 0.0f}) {
    CAPTURE(max_ssim_loss);
    check_same_as_cpu(1e-4, [&] {
      Pair pair;
      ExposureLoss loss(config_with(max_ssim_loss), 2);
      for (int i = 0; i < 5; ++i) {
        const SilentStep silent(i > 0);
        pair.gradient.array().fill(0);
        const DeviceCounters before = device_counters;
        loss.evaluate(1, 10, pair.render, pair.photo, kWeights, pair.gradient);
        if (i < 2) continue;
        CHECK(device_counters.downloads == before.downloads);
        CHECK(device_counters.waits == before.waits);
        CHECK(device_counters.uploads == before.uploads);
        CHECK(device_counters.allocations == before.allocations);
      }
      const ViewExposure& found = loss.exposures()[1];
      return std::map<std::string, std::vector<float>>{
          {"gradient", read(pair.gradient)},
          {"steps", {static_cast<float>(found.steps)}},
          {"log gain", {static_cast<float>(found.log_gain)}},
          {"offset", {static_cast<float>(found.offset)}}};
    });
  }
}

TEST_CASE("A void step leaves exposure as it is") {
  const OnHost on_host;
  Pair pair;
  ExposureLoss loss(config_with(0.9f), 1);
  const auto step = [&] { loss.evaluate(0, 10, pair.render, pair.photo, kWeights, pair.gradient); };
  step();
  const ViewExposure before = loss.exposures()[0];
  CHECK(before.steps == 1);
  {
    const SilentStep silent(true);
    HostExec().for_each(1, [word = void_word()](std::size_t) { *word = 1; });
    step();
    end_silent_step();
  }
  CHECK(take_void_steps().count == 1);
  CHECK(loss.exposures()[0].steps == 1);
  CHECK(loss.exposures()[0].log_gain == before.log_gain);
  step();
  CHECK(loss.exposures()[0].steps == 2);
}

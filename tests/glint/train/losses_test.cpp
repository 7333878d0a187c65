// SPDX-License-Identifier: MIT
// What holds for every loss on one map, with each of its parts on and off: a walk over a table.
// What a loss is worth in closed form is in its own test.
#include "glint/train/depth_prior.h"
#include "glint/train/masked_transparency.h"
#include "glint/train/normal_prior.h"
#include "glint/train/normal_smoothness.h"
#include "glint/train/transparency_guidance.h"
#include "glint/train/transparency_prior.h"
#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

// A generic loss (tests/support/check_loss.h) in double, for differences, and as it trains.
struct AnyLoss {
  template <class Loss>
  AnyLoss(Loss loss) : in_double(loss), in_float(loss) {}
  std::function<double(const ImageD&, double, ImageD&)> in_double;
  std::function<double(const Image&, float, Image&)> in_float;
};

struct Row {
  const char* name;
  ImageD (*map)(ImageSize);
  AnyLoss loss;
};

Image noise(ImageSize size, int channels, std::uint64_t seed, float low = 0) {
  return random_map<float>(size, channels, low, 1, seed);
}
ImageD depths(ImageSize size) {
  ImageD map = random_map<double>(size, 1, 2, 4, 3);
  map.at(7, 1) = -1;  // no depth, and further than a difference's step from becoming one
  return map;
}
ImageD normals(ImageSize size) { return random_map<double>(size, 3, -1, 1, 12); }
ImageD shares(ImageSize size) { return random_map<double>(size, 1, 0.02f, 0.98f, 32); }
TransparencyMasks masks_of(ImageSize size) { return {noise(size, 1, 41), noise(size, 1, 42)}; }

// Priors have holes, and weights leave pixels out.
AnyLoss depth_prior(DepthPriorLoss loss, bool weighted) {
  return [=](const auto& depth, auto weight, auto& gradient) {
    Image prior = noise(depth.size(), 1, 1, 0.2f), weights = noise(depth.size(), 1, 2, 0.1f);
    prior.at(2, 3) = prior.at(10, 8) = weights.at(5, 5) = weights.at(0, 0) = 0;
    return loss.evaluate(depth, prior, weighted ? weights : Image(), weight, gradient);
  };
}
AnyLoss normal_prior(NormalPriorLoss loss, bool weighted) {
  return [=](const auto& normal, auto weight, auto& gradient) {
    Image prior = noise(normal.size(), 3, 11, -1);
    for (std::size_t i = 0; i < prior.values().size(); i += 3) {
      float* p = prior.data() + i;
      const Vec3f n = i == 6 ? Vec3f{} : normalize(Vec3f{p[0], p[1], p[2]});
      p[0] = n.x, p[1] = n.y, p[2] = n.z;
    }
    const Image weights = weighted ? noise(normal.size(), 1, 13) : Image();
    return loss.evaluate(normal, prior, weights, weight, gradient);
  };
}
// Of losses that look at the photo for its edges.
template <class Loss>
AnyLoss with_photo(Loss loss) {
  return [=](const auto& map, auto weight, auto& gradient) {
    return loss.evaluate(map, noise(map.size(), 3, 22), weight, gradient);
  };
}
AnyLoss masked_transparency(float late) {
  return [=](const auto& t, auto weight, auto& gradient) {
    const TransparencyMasks masks = masks_of(t.size());
    const Image photo = noise(t.size(), 3, 43);
    return MaskedTransparencyLoss().evaluate(t, masks, photo, {late}, weight, gradient);
  };
}
AnyLoss guidance(TransparencyGuidance loss, float transparent_weight = 1) {
  loss.transparent_weight = transparent_weight;
  return [=](const auto& t, auto weight, auto& gradient) {
    return loss.evaluate(t, masks_of(t.size()), weight, gradient);
  };
}

std::vector<Row> all_losses() {
  constexpr float kNoGate = NormalPriorLoss::kNoGate;
  NormalPriorLoss weighted_mean;
  weighted_mean.weighted_mean = true;
  return {
      {"depth prior", depths, depth_prior({}, false)},
      {"depth prior, weighted", depths, depth_prior({}, true)},
      {"depth prior, gradients", depths, depth_prior({4, 0.7f}, false)},
      {"depth prior, gradients, weighted", depths, depth_prior({3, 1}, true)},
      {"normal prior", normals, normal_prior({kNoGate}, false)},
      {"normal prior, weighted", normals, normal_prior({kNoGate}, true)},
      {"normal prior, gate", normals, normal_prior({0.3f}, true)},
      {"normal prior, weighted mean", normals, normal_prior(weighted_mean, true)},
      {"smoothness", normals, with_photo(NormalSmoothnessLoss{1})},
      {"smoothness, sharp edges", normals, with_photo(NormalSmoothnessLoss{4})},
      {"prior on t", shares, with_photo(TransparencyPriorLoss{})},
      {"prior on t, no entropy", shares, with_photo(TransparencyPriorLoss{0, 1, 3, 5})},
      {"prior on t, entropy", shares, with_photo(TransparencyPriorLoss{2, 0, 0})},
      {"masked prior on t, early", shares, masked_transparency(0)},
      {"masked prior on t", shares, masked_transparency(0.5f)},
      {"masked prior on t, late", shares, masked_transparency(1)},
      {"guidance, paper", shares, guidance(TransparencyGuidance::paper())},
      {"guidance, paper, lenient", shares, guidance(TransparencyGuidance::paper(), 4)},
      {"guidance, release", shares, guidance(TransparencyGuidance::release())}};
}

}  // namespace

TEST_CASE("Each loss on a map has the gradient of its differences") {
  for (const Row& row : all_losses()) {
    INFO(row.name);
    check_loss_gradient(row.map({11, 9}), row.loss.in_double);
  }
}

TEST_CASE("No loss on a map depends on the number of threads") {
  for (const Row& row : all_losses()) {
    INFO(row.name);
    const ImageD map = row.map({61, 83});
    Image as_trained(map.width(), map.height(), map.channels());
    std::copy(map.values().begin(), map.values().end(), as_trained.data());
    check_thread_independence(as_trained, row.loss.in_float);
  }
}

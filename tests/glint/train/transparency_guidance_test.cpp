// SPDX-License-Identifier: MIT
#include "glint/train/transparency_guidance.h"

#include "tests/support/check_loss.h"

using namespace glint;
using namespace glint::test;

namespace {

// The cues of one pixel, grey.
struct PixelCue {
  float interface_depth = 2, transmission_depth = 3, albedo = 0.02f, basecolor = 0.5f, cosine = 1;
};
struct Cues {
  Image interface_depth, transmission_depth, albedo, basecolor, cosine;
  Cues(ImageSize size, PixelCue p)
      : interface_depth(size.width, size.height, 1, p.interface_depth),
        transmission_depth(size.width, size.height, 1, p.transmission_depth),
        albedo(size.width, size.height, 3, p.albedo),
        basecolor(size.width, size.height, 3, p.basecolor),
        cosine(size.width, size.height, 1, p.cosine) {}
  TransparencyCues views() const {
    return {interface_depth, transmission_depth, albedo, basecolor, cosine};
  }
};

struct Label {
  float transparent, opaque;
  friend bool operator==(const Label&, const Label&) = default;
};
Label label_of(const TransparencyGuidance& guidance, PixelCue pixel) {
  const TransparencyMasks masks = guidance.masks(Cues({1, 1}, pixel).views());
  return {masks.transparent.at(0, 0), masks.opaque.at(0, 0)};
}
constexpr Label kTransparent{1, 0}, kOpaque{0, 1}, kNeither{0, 0};

auto loss_with(const TransparencyGuidance& guidance, const TransparencyMasks& masks) {
  return [=](const auto& t, auto weight, auto& gradient) {
    return guidance.evaluate(t, masks, weight, gradient);
  };
}

}  // namespace

TEST_CASE("The paper's mask: layers apart and dark albedo") {
  const TransparencyGuidance paper = TransparencyGuidance::paper();
  CHECK(label_of(paper, {2, 3, 0.02f}) == kTransparent);
  CHECK(label_of(paper, {3, 2, 0.02f}) == kTransparent);  // the distance has no sign
  CHECK(label_of(paper, {2, 3, 0.06f}) == kOpaque);
  CHECK(label_of(paper, {2, 3, 0.05f}) == kOpaque);  // strictly below
  CHECK(label_of(paper, {2, 2.02f, 0.02f}) == kTransparent);
  CHECK(label_of(paper, {2, 2.005f, 0.02f}) == kOpaque);
  CHECK(label_of(paper, {2, 2.005f, 0.5f}) == kOpaque);
}

TEST_CASE("The paper's mask is zero where a depth is missing") {
  const TransparencyGuidance paper = TransparencyGuidance::paper();
  CHECK(label_of(paper, {0, 3, 0.02f}) == kOpaque);
  CHECK(label_of(paper, {2, 0, 0.02f}) == kOpaque);
  CHECK(label_of(paper, {0, 0, 0.02f}) == kOpaque);
}

TEST_CASE("The albedo test takes the mean of the channels") {
  Cues cues({1, 1}, {});
  cues.albedo = map_of<float>(1, 1, 3, {0.12f, 0.01f, 0.01f});  // mean 0.047
  CHECK(TransparencyGuidance::paper().masks(cues.views()).transparent.at(0, 0) == 1.0f);
  cues.albedo.at(0, 0, 2) = 0.03f;  // mean 0.053
  CHECK(TransparencyGuidance::paper().masks(cues.views()).transparent.at(0, 0) == 0.0f);
}

TEST_CASE("The release's masks: truth table") {
  const TransparencyGuidance release = TransparencyGuidance::release();
  CHECK(label_of(release, {2, 3, 0.02f, 0.5f}) == kTransparent);
  CHECK(label_of(release, {2, 3, 0.02f, 0.1f}) == kOpaque);       // dark all through
  CHECK(label_of(release, {2, 3, 0.07f, 0.5f}) == kNeither);      // neither low nor high albedo
  CHECK(label_of(release, {2, 3, 0.2f, 0.5f}) == kOpaque);        // high albedo
  CHECK(label_of(release, {2, 2.004f, 0.02f, 0.5f}) == kOpaque);  // one surface
  CHECK(label_of(release, {2, 2.006f, 0.02f, 0.5f}) == kTransparent);
  CHECK(label_of(release, {3, 2, 0.02f, 0.5f}) == kOpaque);   // the distance has a sign
  CHECK(label_of(release, {2, 0, 0.02f, 0.5f}) == kOpaque);   // nothing behind
  CHECK(label_of(release, {0, 3, 0.02f, 0.5f}) == kNeither);  // no interface
  CHECK(label_of(release, {0, 3, 0.2f, 0.5f}) == kOpaque);
}

TEST_CASE("The release's masks fade between 70 and 80 degrees from the normal") {
  const TransparencyGuidance release = TransparencyGuidance::release();
  const auto weight_at = [&](double degrees) {
    const auto cosine = static_cast<float>(std::cos(degrees * 3.141592653589793 / 180));
    return static_cast<double>(label_of(release, {2, 3, 0.02f, 0.5f, cosine}).transparent);
  };
  CHECK(weight_at(0) == 1);
  CHECK(weight_at(69.9) == 1);
  CHECK(weight_at(80.1) == 0);
  const double cos70 = 0.3420201433, cos75 = 0.2588190451, cos80 = 0.1736481777;
  CHECK(weight_at(75) == Approx((cos75 - cos80) / (cos70 - cos80)).epsilon(1e-5));
  Cues cues({1, 1}, {2, 3, 0.02f, 0.5f, 0.0f});
  cues.cosine = {};  // not known: full weight
  CHECK(release.masks(cues.views()).transparent.at(0, 0) == 1.0f);
}

TEST_CASE("The release's masks lose a pixel at their edges and none at the image's border") {
  Cues cues({7, 5}, {2, 3, 0.02f, 0.5f});
  for (int c = 0; c < 3; ++c) cues.albedo.at(3, 2, c) = 0.5f;  // one opaque pixel
  const TransparencyMasks masks = TransparencyGuidance::release().masks(cues.views());
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      const bool is_near = std::abs(x - 3) <= 1 && std::abs(y - 2) <= 1;
      CHECK(masks.transparent.at(x, y) == (is_near ? 0.0f : 1.0f));
      CHECK(masks.opaque.at(x, y) == 0.0f);  // a single pixel does not survive
    }
}

TEST_CASE("The paper's guidance is the mean distance of mask and transparency") {
  TransparencyMasks masks;
  masks.transparent = map_of<float>(4, 1, 1, {1, 1, 0, 0});
  const Image t = map_of<float>(4, 1, 1, {0.25f, 1, 0.5f, 0});
  const auto loss = loss_with(TransparencyGuidance::paper(), masks);
  CHECK(value_of(loss, t) == Approx((0.75 + 0 + 0.5 + 0) / 4));
  const Image gradient = gradient_of(loss, t, 2.0f);
  CHECK(gradient.at(0, 0) == -0.5f);
  CHECK(gradient.at(1, 0) == 0.0f);
  CHECK(gradient.at(2, 0) == 0.5f);
}

TEST_CASE("Labels that say transparent count as often as they are told to") {
  TransparencyMasks masks;
  masks.transparent = map_of<float>(4, 1, 1, {1, 1, 0, 0});
  const Image t = map_of<float>(4, 1, 1, {0.25f, 1, 0.5f, 0});
  TransparencyGuidance guidance = TransparencyGuidance::paper();
  guidance.transparent_weight = 4;
  const auto loss = loss_with(guidance, masks);
  CHECK(value_of(loss, t) == Approx((4 * 0.75 + 0 + 0.5 + 0) / 4));
  const Image gradient = gradient_of(loss, t, 2.0f);
  CHECK(gradient.at(0, 0) == -2.0f);
  CHECK(gradient.at(2, 0) == 0.5f);
}

TEST_CASE("A surface becomes transparent where more of its labels say so than it needs") {
  constexpr int kLabels = 100;
  for (const float weight : {1.0f, 2.0f, 4.0f}) {
    TransparencyGuidance guidance = TransparencyGuidance::paper();
    guidance.transparent_weight = weight;
    const int needed = static_cast<int>(std::floor(kLabels * guidance.share_needed()));
    for (const int transparent : {needed - 1, needed + 1}) {
      TransparencyMasks masks;
      masks.transparent = Image(kLabels, 1, 1);
      for (int i = 0; i < transparent; ++i) masks.transparent.at(i, 0) = 1;
      // One surface, seen at all of the pixels: the sum of their gradients draws it.
      const Image gradient =
          gradient_of(loss_with(guidance, masks), Image(kLabels, 1, 1, 0.5f), 1.0f);
      double sum = 0;
      for (const float g : gradient.values()) sum += static_cast<double>(g);
      INFO(weight << ": " << transparent << " of " << kLabels);
      CHECK((sum < 0) == (transparent > needed));
    }
  }
}

TEST_CASE("A pixel that does not count is neither transparent nor opaque, and guides nothing") {
  Cues cues({3, 1}, {2, 3, 0.02f});
  const Image counted = map_of<float>(3, 1, 1, {1, 0, 1});
  for (int c = 0; c < 3; ++c) cues.albedo.at(2, 0, c) = 0.5f;
  TransparencyCues views = cues.views();
  views.counted = counted;
  for (const TransparencyGuidance& guidance :
       {TransparencyGuidance::paper(), TransparencyGuidance::release()}) {
    const TransparencyMasks masks = guidance.masks(views);
    CHECK(masks.transparent.at(1, 0) == 0.0f);
    CHECK(masks.opaque.at(1, 0) == 0.0f);
  }
  const TransparencyMasks masks = TransparencyGuidance::paper().masks(views);
  const Image t = map_of<float>(3, 1, 1, {0.25f, 0.9f, 0.5f});
  const auto loss = loss_with(TransparencyGuidance::paper(), masks);
  CHECK(value_of(loss, t) == Approx((0.75 + 0.5) / 3));
  CHECK(gradient_of(loss, t).at(1, 0) == 0.0f);
}

TEST_CASE("The release's guidance is the weighted mean cross-entropy of each mask") {
  TransparencyMasks masks;
  masks.transparent = map_of<float>(4, 1, 1, {1, 0.5f, 0, 0});
  masks.opaque = map_of<float>(4, 1, 1, {0, 0, 0.25f, 0});
  const Image t = map_of<float>(4, 1, 1, {0.5f, 0.9f, 0.1f, 0.3f});
  const auto bce = [](double p, double target) {
    return -target * std::log(p) - (1 - target) * std::log(1 - p);
  };
  const auto loss = loss_with(TransparencyGuidance::release(), masks);
  CHECK(
      value_of(loss, t) ==
      Approx((bce(0.5, 0.98) + 0.5 * bce(0.9, 0.98)) / 1.5 + bce(0.1, 0.02)).epsilon(1e-6)
  );
  CHECK(gradient_of(loss, t).at(3, 0) == 0.0f);
  masks.opaque = Image(4, 1, 1);  // an empty mask adds nothing
  CHECK(
      value_of(loss_with(TransparencyGuidance::release(), masks), t) ==
      Approx((bce(0.5, 0.98) + 0.5 * bce(0.9, 0.98)) / 1.5).epsilon(1e-6)
  );
}

TEST_CASE("Without the priors or a depth there is no guidance") {
  const ImageSize size{3, 2};
  const Image t(3, 2, 1, 0.5f);
  const auto check_none = [&](const TransparencyGuidance& guidance, const Cues& cues) {
    const TransparencyMasks masks = guidance.masks(cues.views());
    CHECK(masks.transparent.empty());
    check_no_loss(t, loss_with(guidance, masks));
  };
  Cues no_albedo(size, {}), no_basecolor(size, {}), no_depth(size, {});
  no_albedo.albedo = {};
  no_basecolor.basecolor = {};
  no_depth.transmission_depth = {};
  check_none(TransparencyGuidance::paper(), no_albedo);
  check_none(TransparencyGuidance::release(), no_albedo);
  check_none(TransparencyGuidance::release(), no_basecolor);
  check_none(TransparencyGuidance::paper(), no_depth);
  CHECK(!TransparencyGuidance::paper().masks(no_basecolor.views()).transparent.empty());
}

TEST_CASE("Cues of another size are refused") {
  Cues cues({3, 2}, {});
  cues.albedo = Image(2, 3, 3);
  CHECK_THROWS_AS(TransparencyGuidance::paper().masks(cues.views()), Error);
}

TEST_CASE("Viewing cosines are those between each pixel's ray and normal") {
  Camera camera;
  camera.width = 2, camera.height = 1;
  camera.fx = camera.fy = 1, camera.cx = 0.5, camera.cy = 0.5;
  // Rays (0, 0, 1) and (1, 0, 1) / sqrt(2).
  const Image facing = map_of<float>(2, 1, 3, {0, 0, -0.5f, 0, 0, -2});
  CHECK(static_cast<double>(viewing_cosines(camera, facing).at(0, 0)) == Approx(1));
  CHECK(static_cast<double>(viewing_cosines(camera, facing).at(1, 0)) == Approx(std::sqrt(0.5)));
  CHECK(viewing_cosines(camera, Image(2, 1, 3)).at(0, 0) == 0.0f);
}

TEST_CASE("Guidance does not depend on the number of threads") {
  const ImageSize size{45, 67};
  Cues cues(size, {});
  cues.interface_depth = random_map<float>(size, 1, 2, 2.01f, 44);
  cues.transmission_depth = random_map<float>(size, 1, 2, 2.03f, 45);
  cues.albedo = random_map<float>(size, 3, 0, 0.08f, 46);
  const Image t = random_map<float>(size, 1, 0, 1, 47);
  for (const auto& guidance : {TransparencyGuidance::paper(), TransparencyGuidance::release()})
    check_thread_independence(t, [&](const auto& map, auto weight, auto& gradient) {
      return guidance.evaluate(map, guidance.masks(cues.views()), weight, gradient);
    });
}

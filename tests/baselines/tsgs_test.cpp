// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "glint/scene/ply.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

std::unique_ptr<Method> trained(const Scene& scene, int planned, int steps) {
  auto method = create_method("tsgs");
  method->initialize(scene, {planned, 0});
  for (int i = 0; i < steps; ++i) method->step(i);
  return method;
}

// The left half of every view is glass; on it, de-lighted photos are of one grey.
Scene half_glass(float delighted) {
  Scene scene = small_room();
  for (std::vector<View>* views : {&scene.train, &scene.test})
    for (View& view : *views) {
      Image& mask = view.truth["glass"] = Image(view.camera.width, view.camera.height, 1);
      for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width / 2; ++x) mask.at(x, y) = 1;
      view.priors["delighted"] = Image(view.camera.width, view.camera.height, 3, delighted);
    }
  return scene;
}

double mean_of_left_half(const Image& rgb) {
  double sum = 0;
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width() / 2; ++x) sum += static_cast<double>(rgb.at(x, y, 1));
  return sum / (rgb.height() * (rgb.width() / 2));
}

bool same(const Image& a, const Image& b) {
  return a.size() == b.size() &&
         std::equal(a.values().begin(), a.values().end(), b.values().begin());
}

std::string first_note(const Scene& scene) {
  const auto method = create_method("tsgs");
  method->initialize(scene, {40, 0});
  return method->notes().at(0);
}

FloatArray saved_opacities(const Method& method) {
  const TempFolder folder;
  method.save(folder.path().string());
  return read_surfel_ply(folder.path() / "interface.ply").opacity_logits;
}

}  // namespace

TEST_CASE("Notes say whose glass masks were used: the priors', else the truth's, else none") {
  Scene scene = small_room();
  CHECK(first_note(scene) == "glass masks, test views' too: the dataset's ground truth");
  for (View& view : scene.train) view.priors["glass"] = view.truth["glass"];
  CHECK(first_note(scene) == "glass masks, test views' too: the prior folder's");
  scene.train[0].priors["glass"] = {};
  CHECK(first_note(scene).find("ground truth for 1, none for 0") != std::string::npos);
  for (View& view : scene.train) view.priors["glass"] = view.truth["glass"] = {};
  CHECK(first_note(scene) == "glass masks, test views' too: none");
}

TEST_CASE("On glass the target is the de-lighted photo, until the second half of the run") {
  const Scene dark = half_glass(0), light = half_glass(1);
  const Camera& camera = dark.train[0].camera;
  const auto mean_after = [&](const Scene& scene, int planned, int steps) {
    return mean_of_left_half(trained(scene, planned, steps)->render(camera)["rgb"]);
  };
  CHECK(mean_after(light, 240, 110) > mean_after(dark, 240, 110) + 0.15);
  // With the photo as target from then on, both go back to it.
  CHECK(
      mean_after(light, 120, 120) - mean_after(dark, 120, 120) <
      mean_after(light, 240, 110) - mean_after(dark, 240, 110)
  );
}

TEST_CASE("From the second half on opacities stay") {
  const auto method = trained(small_room(), 60, 30);
  const FloatArray before = saved_opacities(*method);
  for (int i = 30; i < 40; ++i) method->step(i);
  CHECK(saved_opacities(*method) == before);
}

TEST_CASE("A view's depth is the first surface on its mask, whatever its picture shows") {
  Scene scene = half_glass(0.5f);
  const auto method = trained(scene, 60, 40);
  View& view = scene.test.front();
  const MapSet plain = method->render(view.camera), gated = method->render_view(view);
  CHECK(same(plain["rgb"], gated["rgb"]));
  std::size_t nearer = 0;
  for (int y = 0; y < view.camera.height; ++y)
    for (int x = 0; x < view.camera.width; ++x) {
      const float before = plain["depth"].at(x, y), now = gated["depth"].at(x, y);
      if (x >= view.camera.width / 2) CHECK(now == before);
      nearer += now > 0 && now < before ? 1 : 0;
    }
  CHECK(nearer > 20);
  view.rgb = Image(view.camera.width, view.camera.height, 3, 0.1f);
  CHECK(same(method->render_view(view)["depth"], gated["depth"]));
  const TempFolder folder;
  method->save(folder.path().string());
  const auto loaded = create_method("tsgs");
  loaded->load(folder.path().string());
  CHECK(same(loaded->render_view(view)["depth"], gated["depth"]));
}

// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "glint/core/files.h"
#include "glint/method.h"
#include "glint/scene/ply.h"
#include "glint/scene/safetensors.h"
#include "tests/support/same_bytes.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

std::unique_ptr<Method> trained(
    const Scene& scene, int planned, int steps, const Json& config = Json::object()
) {
  auto method = create_method("tsgs", config);
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

std::string first_note(const Scene& scene) {
  const auto method = create_method("tsgs");
  method->initialize(scene, {40, 0});
  return method->notes().at(0);
}

std::unique_ptr<Method> saved_and_loaded(const Method& method, const fs::path& folder) {
  method.save(folder.string());
  auto loaded = create_method("tsgs");
  loaded->load(folder.string());
  return loaded;
}

Image picture(Method& method) { return method.render(small_room().test.front().camera)["rgb"]; }

// PSNR of the test views' pictures, clipped as files are.
double mean_psnr(Method& method) {
  double sum = 0;
  for (const View& view : small_room().test) {
    const Image rgb = method.render(view.camera)["rgb"];
    double squares = 0;
    for (std::size_t i = 0; i < rgb.values().size(); ++i) {
      const float off = std::clamp(rgb.values()[i], 0.0f, 1.0f) - view.rgb.values()[i];
      squares += static_cast<double>(off) * static_cast<double>(off);
    }
    sum += -10 * std::log10(squares / static_cast<double>(rgb.values().size()));
  }
  return sum / static_cast<double>(small_room().test.size());
}

FloatArray saved_opacities(const Method& method) {
  const TempFolder folder;
  method.save(folder.path().string());
  return read_surfel_ply(folder.path() / "interface.ply").opacity_logits;
}

}  // namespace

TEST_CASE("Base colours take the place of de-lighted photos where asked for") {
  Scene dark = half_glass(1), light = half_glass(0);  // whose de-lighted photos say otherwise
  for (View& view : dark.train)
    view.priors["basecolor"] = Image(view.camera.width, view.camera.height, 3, 0.0f);
  for (View& view : light.train)
    view.priors["basecolor"] = Image(view.camera.width, view.camera.height, 3, 1.0f);
  const auto mean_after = [&](const Scene& scene) {
    auto method = create_method("tsgs/basecolor");
    method->initialize(scene, {240, 0});
    for (int i = 0; i < 110; ++i) method->step(i);
    CHECK(method->notes().at(1) == "de-lighted photos: basecolor priors");
    return mean_of_left_half(method->render(scene.train[0].camera)["rgb"]);
  };
  CHECK(mean_after(light) > mean_after(dark) + 0.15);
  CHECK_THROWS_WITH(
      create_method("tsgs", {{"delighted_by", "albedo"}}),
      Catch::Contains("delighted_by cannot be 'albedo'")
  );
}

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
  const double apart = mean_after(light, 240, 110) - mean_after(dark, 240, 110);
  CHECK(apart > 0.15);
  // With the photo as target from then on, both go back to it.
  CHECK(mean_after(light, 120, 120) - mean_after(dark, 120, 120) < apart);
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
  CHECK(same_bytes(plain["rgb"], gated["rgb"]));
  std::size_t nearer = 0;
  for (int y = 0; y < view.camera.height; ++y)
    for (int x = 0; x < view.camera.width; ++x) {
      const float before = plain["depth"].at(x, y), now = gated["depth"].at(x, y);
      if (x >= view.camera.width / 2) CHECK(now == before);
      nearer += now > 0 && now < before ? 1 : 0;
    }
  CHECK(nearer > 20);
  view.rgb = Image(view.camera.width, view.camera.height, 3, 0.1f);
  CHECK(same_bytes(method->render_view(view)["depth"], gated["depth"]));
  const TempFolder folder;
  method->save(folder.path().string());
  const auto loaded = create_method("tsgs");
  loaded->load(folder.path().string());
  CHECK(same_bytes(loaded->render_view(view)["depth"], gated["depth"]));
}

TEST_CASE("Lobes start after 60 % of the run, change the picture and nothing before") {
  const Json off{{"lobes", "off"}};
  // 18,000 of 30,000 is step 24 of 40, whose picture they change by their start alone.
  const auto with = trained(small_room(), 40, 24), without = trained(small_room(), 40, 24, off);
  CHECK(same_bytes(picture(*with), picture(*without)));
  const double before = with->step(24).terms.at("photometric");
  CHECK(before != without->step(24).terms.at("photometric"));
  const Image one = picture(*with), none = picture(*without);
  CHECK_FALSE(same_bytes(one, none));
  CHECK_NOTHROW(with->check_finite());
  CHECK(with->num_surfels() == without->num_surfels());
}

TEST_CASE("Lobes learn: features leave zero, and networks their start") {
  const auto method = trained(small_room(), 40, 25);
  const auto tensor = [&](const std::string& name) {
    const TempFolder folder;
    method->save(folder.path().string());
    SafetensorsFile file(folder.path() / "lobes.safetensors");
    REQUIRE(file.find(name) != nullptr);
    return file.read<float>(name, file.find(name)->shape);
  };
  const auto features = tensor("lobes.features");
  CHECK(features.size() == 12 * method->num_surfels());
  const auto moved =
      std::count_if(features.begin(), features.end(), [](float x) { return x != 0; });
  CHECK(moved > static_cast<std::ptrdiff_t>(features.size() / 4));
  const auto lobes = tensor("lobes.to_lobes.0.weight"), color = tensor("lobes.to_color.2.weight");
  method->step(25);
  CHECK(tensor("lobes.features") != features);
  CHECK(tensor("lobes.to_lobes.0.weight") != lobes);
  CHECK(tensor("lobes.to_color.2.weight") != color);
}

TEST_CASE("Lobes alone bring the picture nearer to the photos") {
  // Surfels stay as they start.
  Json config{{"densify_until", 0}, {"trim_until", 0}, {"lobes_from", 1}};
  for (const char* rate :
       {"rate_position",
        "rate_position_final",
        "rate_color",
        "rate_sh",
        "rate_opacity",
        "rate_scale",
        "rate_rotation"})
    config[rate] = 0;
  const auto with = trained(small_room(), 60, 60, config);
  config["lobes"] = "off";
  const auto without = trained(small_room(), 60, 2, config);
  CHECK(mean_psnr(*with) > mean_psnr(*without) + 1);
}

TEST_CASE("Lobes come back from files, and so does a run that has none yet") {
  for (const int steps : {20, 40}) {
    INFO(steps << " steps");
    const auto method = trained(small_room(), 40, steps);
    const TempFolder folder;
    const auto loaded = saved_and_loaded(*method, folder.path());
    CHECK(fs::exists(folder.path() / "lobes.safetensors") == (steps == 40));
    // SH grow with the run, and what was loaded has all degrees.
    if (steps == 40) CHECK(same_bytes(picture(*loaded), picture(*method)));
    const TempFolder again;
    CHECK(same_bytes(picture(*saved_and_loaded(*loaded, again.path())), picture(*loaded)));
  }
}

TEST_CASE("Lobes that do not exist, and surfels that come or go under them, are refused") {
  CHECK_THROWS_WITH(
      create_method("tsgs", {{"lobes", "half"}}),
      Catch::Contains("lobes cannot be 'half'; expected real or off")
  );
  for (const char* window : {"densify_until", "trim_until"}) {
    CHECK_THROWS_WITH(
        create_method("tsgs", {{window, 20000}}), Catch::Contains("set lobes_from later")
    );
    CHECK_NOTHROW(create_method("tsgs", {{window, 20000}, {"lobes", "off"}}));
    CHECK_NOTHROW(create_method("tsgs", {{window, 20000}, {"lobes_from", 20000}}));
  }
  const auto method = trained(small_room(), 40, 30);
  const TempFolder folder;
  method->save(folder.path().string());
  write_file(folder.path() / "scene_unit.json", R"({"scene_unit": 1, "lobes": 3})");
  CHECK_THROWS_WITH(
      create_method("tsgs")->load(folder.path().string()),
      Catch::Contains("lobes is 3, expected real or off")
  );
}

TEST_CASE("Without lobes, masks and priors TSGS is PGSR until opacities stay") {
  Scene scene = small_room();
  for (View& view : scene.train) {
    view.priors = {};
    view.truth["glass"] = {};
  }
  const auto picture_of = [&](const char* id, const Json& config) {
    const auto method = create_method(id, config);
    method->initialize(scene, {40, 0});
    for (int i = 0; i < 40; ++i) method->step(i);
    return picture(*method);
  };
  const Image pgsr = picture_of("pgsr", Json::object());
  CHECK(same_bytes(picture_of("tsgs", {{"lobes", "off"}, {"freeze_opacity", false}}), pgsr));
  CHECK_FALSE(same_bytes(picture_of("tsgs", {{"freeze_opacity", false}}), pgsr));
}

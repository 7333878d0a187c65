// SPDX-License-Identifier: MIT
// Every method at the viewer: what is cut comes back, its layers are those it renders.
#include <catch2/catch.hpp>

#include "glint/core/stoppable.h"
#include "glint/train/trainer.h"
#include "reports/run/bench/stages.h"
#include "reports/show/viewer/viewed_run.h"
#include "tests/support/all_trained.h"
#include "tests/support/same_bytes.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

// Trained for a few steps and loaded again, so that it can only be rendered.
std::unique_ptr<Method> loaded(const std::string& id) {
  const TempFolder folder;
  {
    const auto trained = create_method(id);
    trained->initialize(small_room(), {.iterations = 3, .seed = 1});
    for (int step = 0; step < 3; ++step) trained->step(step);
    trained->save(folder.path().string());
  }
  auto method = create_method(id);
  method->load(folder.path().string());
  return method;
}

Look look_at_room() {
  Look look;
  look.serial = 1;
  look.camera = small_room().test.front().camera;
  look.panes = {{0, "rgb"}};
  return look;
}

// What a camera that moves sees is no other picture.
bool is_near(const Image& quick, const Image& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.values().size(); ++i)
    sum += std::abs(static_cast<double>(quick.values()[i] - picture.values()[i]));
  return sum / static_cast<double>(picture.values().size()) < 0.02;
}

bool is_black(const Image& image) {
  for (const float value : image.values())
    if (value > 0.01f) return false;
  return true;
}

}  // namespace

TEST_CASE("all methods: the moving picture is the rendered one, a cut is undone") {
  const auto id = GENERATE(from_range(all_trained()));
  CAPTURE(id);
  const auto method = loaded(id);
  ViewedRun run({id, id, id, "nowhere"}, *method, small_room(), false);
  const Look look = look_at_room();
  const LayerMaps before = run.layers(look, look.camera, nullptr);
  CHECK(same_bytes(method->picture(look.camera), before.at("rgb")));
  CHECK(is_near(run.layers_for("rgb", look, look.camera).at("rgb"), before.at("rgb")));
  CHECK(same_bytes(method->picture(look.camera), before.at("rgb")));  // whole again
  const Json json = run.json();
  for (const Json& layer : json["layers"]) {
    const std::string name = layer["id"];
    if (layer.contains("needs_view")) continue;
    CAPTURE(name);
    REQUIRE(before.contains(name));
    CHECK(run.picture(before, name, look.camera.size()).size() == look.camera.size());
  }
  REQUIRE(json["cut"] == true);
  Look cut = look;
  cut.cut = CutPlane{{0, 0, 1}, -1e3};  // everything
  const LayerMaps none = run.layers(cut, look.camera, nullptr);
  const Image& depth = none.at("depth");
  CHECK(is_black(depth));
  const LayerMaps after = run.layers(look, look.camera, nullptr);
  for (const auto& [name, map] : before) {
    CAPTURE(name);
    CHECK(same_bytes(map, after.at(name)));
  }
}

TEST_CASE("all methods: a frame that was stopped anywhere leaves no trace in the next") {
  const auto id = GENERATE(from_range(all_trained()));
  CAPTURE(id);
  const auto method = loaded(id);
  ViewedRun run({id, id, id, "nowhere"}, *method, small_room(), false);
  const Look look = look_at_room();
  Look other = look;
  other.camera = small_room().test.back().camera;
  const LayerMaps expected = run.layers(look, look.camera, nullptr);
  bool stopped = true;
  for (int loops = 0; stopped;
       loops += 1 + loops / 3) {  // until a frame ends before it would be stopped
    int asked = 0;
    const std::function<bool()> stop = [&] { return asked++ >= loops; };
    try {
      const StoppableLoops stoppable(stop);
      run.layers(other, other.camera, nullptr);
      stopped = false;
    } catch (const LoopsStopped&) {
    }
    CAPTURE(loops);
    const LayerMaps after = run.layers(look, look.camera, nullptr);
    for (const auto& [name, map] : expected) REQUIRE(same_bytes(map, after.at(name)));
  }
}

TEST_CASE("all methods: a training that is looked at ends with the same bytes") {
  const auto id = GENERATE(from_range(all_trained()));
  CAPTURE(id);
  const auto trained = [&](const AfterStep& after_step) {
    const auto method = create_method(id);
    TrainOptions options;
    options.run = {.iterations = 12, .seed = 1};
    options.after_step = after_step;
    train(*method, small_room(), options);
    return saved_bytes(*method);
  };
  const Look look = look_at_room();
  int looked = 0;
  const std::string watched = trained([&](Method& method, const StepStats&) {
    ViewedRun run({id, id, id, "nowhere"}, method, small_room(), true);
    run.layers(look, look.camera, &small_room().test.front());
    run.layers_for("rgb", look, look.camera);
    ++looked;
  });
  CHECK(looked == 12);
  CHECK(watched == trained({}));
}

TEST_CASE("sets that are hidden are not among the discs") {
  const auto method = loaded("glint");
  ViewedRun run({"glint", "glint", "GLINT", "nowhere"}, *method, small_room(), false);
  Look look = look_at_room();
  look.style = SurfelStyle::kDiscs;
  CHECK_FALSE(is_black(run.layers(look, look.camera, nullptr).at("depth")));
  for (const MethodSet& set : method->sets()) look.hidden.push_back(set.name);
  CHECK(is_black(run.layers(look, look.camera, nullptr).at("depth")));
}

TEST_CASE("a snapped view has its errors, other cameras have none") {
  const auto method = loaded("2dgs");
  ViewedRun run({"2dgs", "2dgs", "2DGS", "nowhere"}, *method, small_room(), false);
  const Look look = look_at_room();
  const View& view = small_room().test.front();
  const LayerMaps snapped = run.layers(look, look.camera, &view);
  REQUIRE(snapped.contains("error"));
  REQUIRE(snapped.contains("angle"));
  float sum = 0;
  for (int c = 0; c < 3; ++c)
    sum += std::abs(std::clamp(snapped.at("rgb").at(5, 6, c), 0.0f, 1.0f) - view.rgb.at(5, 6, c));
  CHECK(snapped.at("error").at(5, 6) == Approx(sum / 3));
  CHECK_FALSE(run.layers(look, look.camera, nullptr).contains("error"));
  // Grey where there is nothing to show.
  CHECK(run.picture(snapped, "no such layer", {8, 6}).at(3, 3, 0) == 0.5f);
}

TEST_CASE("of a training nothing is cut") {
  const auto method = loaded("2dgs");
  ViewedRun run({"2dgs", "2dgs", "2DGS", "nowhere"}, *method, small_room(), true);
  Look look = look_at_room();
  CHECK(run.json()["cut"] == false);
  look.cut = CutPlane{{0, 0, 1}, 0};
  CHECK(error_of(ExitCode::kUsage, [&] {
          run.layers(look, look.camera, nullptr);
        }).find("trained") != std::string::npos);
  look.style = SurfelStyle::kDiscs;  // drawn, not rendered: nothing is changed for it
  CHECK_NOTHROW(run.layers(look, look.camera, nullptr));
}

// SPDX-License-Identifier: MIT
// A scene and methods that take no time, for tests of what runs them.
#pragma once

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <thread>
#include <utility>

#include "glint/core/device_lost.h"
#include "glint/method.h"
#include "reports/run/bench/runner.h"
#include "reports/run/records/scene_source.h"

namespace glint {

struct FakeConfig {
  float grey = 0.5f;  // of every rendered pixel
  // "", "initialize", "step", "loss", "render", "device", "behind" (nothing lies behind its glass),
  // or one of what ends a process (end_by)
  std::string fails;
  template <class V>
  void visit(V&& v) {
    v("grey", grey, "colour");
    v("fails", fails, "where it throws");
  }
};

// Renders one grey; `trainings` counts the runs that were really trained.
class FakeMethod : public Method {
 public:
  inline static int trainings = 0;

  explicit FakeMethod(const Json& config) { config_from_json(config_, config, "fake"); }
  void initialize(const Scene&, const RunOptions&) override {
    ++trainings;
    fail_at("initialize");
  }
  StepStats step(int iteration) override {
    fail_at("step");
    if (config_.fails == "device") throw DeviceLost("fake device lost");
    if (iteration == 5) end_by(config_.fails);
    if (config_.fails == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(10));
    StepStats stats;
    stats.iteration = iteration;
    stats.loss = config_.fails == "loss" ? std::numeric_limits<double>::quiet_NaN() : 0.1;
    stats.terms["photometric"] = stats.loss;
    return stats;
  }
  MapSet render(const Camera& camera) override {
    fail_at("render");
    MapSet output;
    output["rgb"] = Image(camera.width, camera.height, 3, config_.grey);
    output["depth"] = Image(camera.width, camera.height, 1, 2.0f);
    output["transparency"] = Image(camera.width, camera.height, 1, 0.25f);
    output["interface"] = output["rgb"];
    if (config_.fails == "behind") output["behind_depth"] = Image(camera.width, camera.height, 1);
    return output;
  }
  // Views of the dataset show another transparency than cameras.
  static constexpr float kTransparencyOfViews = 0.5f;
  MapSet render_view(const View& view) override {
    MapSet output = render(view.camera);
    const float transparency = config_.fails == "behind" ? 1 : kTransparencyOfViews;
    output["transparency"] = Image(view.camera.width, view.camera.height, 1, transparency);
    return output;
  }
  std::vector<std::string> notes() const override { return {"a fake"}; }
  void save(const std::string& folder) const override {
    write_file(fs::path(folder) / "interface.ply", fmt::format("{}", config_.grey));
  }
  void load(const std::string& folder) override {
    config_.grey = std::stof(read_file(fs::path(folder) / "interface.ply"));
  }
  Json config() const override { return config_to_json(config_); }
  std::vector<ConfigField> fields() const override { return config_fields(config_); }
  void check_finite() const override {}
  std::size_t num_surfels() const override { return 7; }

 private:
  void fail_at(const std::string& place) const {
    if (config_.fails == place) throw std::runtime_error("fake failure in " + place);
  }
  static void end_by(const std::string& how) {
    if (how == "memory") throw std::bad_alloc();
    if (how == "full") throw DiskFull("fake disk full");
    if (how == "weights") throw MissingWeights("fake weights");
    if (how == "kill") std::raise(SIGKILL);
    if (how == "term") std::raise(SIGTERM);
    if (how == "abort") std::abort();
    // Of the process that runs the first try.
    static const char* out = std::getenv("GLINT_TEST_OUT");
    if (how != "abort once" || out == nullptr || fs::exists(fs::path(out) / "once")) return;
    write_file(fs::path(out) / "once", "");
    std::abort();
  }

  FakeConfig config_;
};

// Without a source: the build has no hash of tests.
inline void register_fake_methods() {
  static bool registered = false;
  if (std::exchange(registered, true)) return;
  for (const char* id : {"fake", "fake/other"}) {
    MethodSpec spec;
    spec.id = spec.title = id;
    spec.create = [](const Json& config) { return std::make_unique<FakeMethod>(config); };
    Registry<MethodSpec>::add(spec, "");
  }
}

// Two views to train on and two to test on, 16x12, all of one grey.
inline Scene fake_scene(const std::string& name, float grey = 0.6f) {
  Scene scene;
  scene.name = name;
  scene.dataset = "glassroom";
  scene.spec_hash = "fake-data";
  for (int i = 0; i < 4; ++i) {
    View view;
    view.name = fmt::format("{:04}", i);
    view.camera.width = 16;
    view.camera.height = 12;
    view.camera.fx = view.camera.fy = 16;
    view.rgb = Image(16, 12, 3, grey);
    view.truth["depth"] = Image(16, 12, 1, 2.5f);
    (i < 2 ? scene.train : scene.test).push_back(view);
  }
  return scene;
}

// There, without a file.
inline SceneIdentity fake_identity(const SceneSource& source) {
  return {{{"scene", {{"max_pixels", source.max_pixels}}}, {"content", "fake-data"}}, ""};
}

// Two scenes and two methods, of which nothing has to be rendered or read.
inline RunnerOptions fake_run(const fs::path& out) {
  register_fake_methods();
  RunnerOptions options;
  options.profile.name = "fake";
  options.profile.iterations = 10;
  options.profile.methods = {"fake", "fake/other"};
  options.profile.timing_frames = 2;
  for (const char* scene : {"room_1", "room_2"})
    options.profile.scenes.push_back({{"scene", scene}, {"folder", "nowhere"}});
  options.out = out;
  options.identify = fake_identity;
  options.load = [](const SceneSource& source) {
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  return options;
}

}  // namespace glint

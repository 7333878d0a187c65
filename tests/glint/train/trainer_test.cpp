// SPDX-License-Identifier: MIT
#include "glint/train/trainer.h"

#include <catch2/catch.hpp>

#include <limits>
#include <numeric>
#include <set>
#include <sstream>

#include "glint/core/device_lost.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// A method whose loss stops being finite at a given iteration.
class Exploding : public Method {
 public:
  explicit Exploding(int at) : at_(at) {}
  void initialize(const Scene&, const RunOptions&) override {}
  StepStats step(int iteration) override {
    StepStats stats;
    stats.iteration = iteration;
    steps.push_back(iteration);
    stats.loss = iteration == at_ ? std::numeric_limits<double>::quiet_NaN() : 1.0;
    stats.terms["sharpness"] = stats.loss;
    if (iteration == 3) stats.events.emplace_back("opacities reset");
    if (iteration >= 10) stats.sets = {{"base", 2}, {"environment", 3}};
    return stats;
  }
  MapSet render(const Camera&) override { return {}; }
  void save(const std::string& folder) const override {
    write_file(fs::path(folder) / "state", "good");
  }
  void load(const std::string&) override {}
  Json config() const override { return Json::object(); }
  void check_finite() const override {}
  std::size_t num_surfels() const override { return 1; }
  bool visit_state(TrainingState& state) override {
    state("steps", steps);
    return true;
  }
  std::vector<int> steps;  // that it made

 private:
  int at_;
};

// One whose device is lost in a step, or in the middle of the n-th checkpoint.
class Losing final : public Exploding {
 public:
  Losing(int in_step, int in_save) : Exploding(-1), in_step_(in_step), in_save_(in_save) {}
  StepStats step(int iteration) override {
    if (iteration == in_step_) throw DeviceLost("gone");
    return Exploding::step(iteration);
  }
  bool visit_state(TrainingState& state) override {
    if (!state.reading() && ++saves_ == in_save_) throw DeviceLost("gone");
    return Exploding::visit_state(state);
  }

 private:
  int in_step_, in_save_;
  int saves_ = 0;
};

// One with steps that have no room, and whose device is lost in a step.
class Cramped final : public Exploding {
 public:
  Cramped(std::set<int> void_steps, int lost)
      : Exploding(-1), void_steps_(std::move(void_steps)), lost_(lost) {}
  StepStats step(int iteration) override {
    if (iteration == lost_) throw DeviceLost("gone");
    if (void_steps_.contains(iteration))
      test::HostExec().for_each(1, [word = void_word()](std::size_t) { *word = 1; });
    return Exploding::step(iteration);
  }

 private:
  std::set<int> void_steps_;
  int lost_;
};

// Steps that are in the folder's checkpoint.
std::vector<int> steps_in(const fs::path& folder) {
  Exploding method(-1);
  TrainingProgress progress;
  read_checkpoint(folder / kCheckpointFile, method, progress);
  CHECK(progress.iterations == static_cast<int>(method.steps.size()));
  return method.steps;
}
std::vector<int> count_to(int end) {
  std::vector<int> numbers(static_cast<std::size_t>(end));
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

Scene one_view() {
  Scene scene;
  scene.name = "one";
  scene.train.emplace_back();
  return scene;
}

// In a folder of its own, with a checkpoint after every step.
struct Training {
  test::TempFolder temporary;
  fs::path folder = temporary.path();
  TrainOptions options;

  explicit Training(int iterations, int log_interval = TrainOptions().log_interval) {
    set_quiet(true);
    options.run.iterations = iterations;
    options.folder = folder;
    options.log_interval = log_interval;
    options.checkpoint_seconds = 0;
  }
  TrainReport run(Method& method) const { return train(method, one_view(), options); }
  std::vector<Json> log() const {
    std::vector<Json> lines;
    std::istringstream in(read_file(folder / "log.jsonl"));
    for (std::string line; std::getline(in, line);) lines.push_back(Json::parse(line));
    return lines;
  }
  // A number of each line.
  std::vector<int> logged(const char* name) const {
    std::vector<int> numbers;
    for (const Json& line : log()) numbers.push_back(line.at(name));
    return numbers;
  }
};

}  // namespace

TEST_CASE(
    "A loss that stops being finite ends training, names the term and keeps the last good state"
) {
  const Training training(100);
  Exploding method(25);
  const std::string message =
      test::error_of(ExitCode::kBadPrediction, [&] { training.run(method); });
  CHECK_THAT(message, Catch::Contains("iteration 25") && Catch::Contains("sharpness"));
  CHECK(steps_in(training.folder) == count_to(25));
}

TEST_CASE("A device that is lost ends training with the last checkpoint kept whole") {
  const Training training(100);
  const auto message_of = [&](int in_step, int in_save) {
    Losing method(in_step, in_save);
    return test::error_of(ExitCode::kEnvironment, [&] {
      try {
        training.run(method);
      } catch (const DeviceLost&) {
        throw;  // still known as such
      } catch (...) {
        FAIL("another error");
      }
    });
  };
  CHECK_THAT(message_of(0, -1), Catch::Contains("iteration 0, before the first checkpoint: gone"));
  CHECK_THAT(message_of(25, -1), Catch::Contains("iteration 25, the last checkpoint is "));
  CHECK(steps_in(training.folder) == count_to(25));
  fs::remove(training.folder / kCheckpointFile);
  // Lost while a checkpoint is written: the one before is there.
  CHECK_THAT(message_of(-1, 3), Catch::Contains("iteration 3, the last checkpoint is "));
  CHECK(steps_in(training.folder) == count_to(2));
}

TEST_CASE("The log has events with their iteration, and the surfels of each of several sets") {
  const Training training(20, 10);
  Exploding method(25);
  training.run(method);
  const std::vector<Json> log = training.log();
  CHECK(log.at(0)["events"] == Json({{{"iteration", 3}, {"text", "opacities reset"}}}));
  CHECK_FALSE(log.at(1).contains("events"));
  CHECK_FALSE(log.at(0).contains("sets"));
  CHECK(log.at(1)["sets"] == Json({{"base", 2}, {"environment", 3}}));
}

TEST_CASE("What is called after each step may end the training, which goes on from there") {
  Training training(30);
  training.options.checkpoint_seconds = 1e6;
  Exploding method(-1);
  std::vector<int> seen;
  training.options.after_step = [&](Method& called, const StepStats& stats) {
    CHECK(&called == &method);
    seen.push_back(stats.iteration);
    if (stats.iteration == 7) throw std::string("enough");
  };
  CHECK_THROWS_AS(training.run(method), std::string);
  CHECK(seen == count_to(8));
  CHECK(steps_in(training.folder) == count_to(8));
  Exploding next(-1);
  training.options.after_step = nullptr;
  CHECK(training.run(next).iterations == 30);
  CHECK(next.steps == count_to(30));
}

TEST_CASE("Training without views is refused") {
  Exploding method(-1);
  CHECK_THROWS_AS(train(method, Scene(), TrainOptions()), Error);
}

TEST_CASE("The view sampler sees every view once an epoch, in an order set by the seed") {
  ViewSampler a(7, 1), b(7, 1), c(7, 2);
  bool differs = false;
  for (int epoch = 0; epoch < 3; ++epoch) {
    std::set<std::size_t> seen;
    for (int i = 0; i < 7; ++i) {
      const std::size_t view = a.next();
      CHECK(view == b.next());
      differs |= view != c.next();
      seen.insert(view);
    }
    CHECK(seen.size() == 7);
  }
  CHECK(differs);
}

TEST_CASE("Published schedules scale with the run's iterations") {
  CHECK(scaled_step(7000, 30000) == 7000);
  CHECK(scaled_step(7000, 3000) == 700);
  CHECK(scaled_step(100, 3000, 50) == 50);
}

TEST_CASE("A training goes on from the checkpoint of its own run, its log without gaps or repeats"
) {
  Training training(40, 4);
  training.options.identity = "this run";
  Losing first(25, -1);
  CHECK_THROWS_AS(training.run(first), DeviceLost);
  CHECK(training.logged("iteration") == std::vector<int>{3, 7, 11, 15, 19, 23});
  // As if it had been killed between the log and the checkpoint.
  append_line(training.folder / "log.jsonl", R"({"iteration": 27})");
  append_line(training.folder / "log.jsonl", "torn");
  SECTION("the same run") {
    Exploding second(-1);
    CHECK(training.run(second).iterations == 40);
    CHECK(second.steps == count_to(40));
    CHECK(training.logged("iteration") == std::vector<int>{3, 7, 11, 15, 19, 23, 27, 31, 35, 39});
  }
  SECTION("another run starts anew") {
    training.options.identity = "another";
    Exploding second(-1);
    training.run(second);
    CHECK(second.steps == count_to(40));
  }
  SECTION("a damaged one starts anew") {
    std::string bytes = read_file(training.folder / kCheckpointFile);
    write_file(training.folder / kCheckpointFile, bytes.substr(0, bytes.size() - 4));
    Exploding second(-1);
    CHECK(training.run(second).iterations == 40);
  }
  SECTION("one of another method starts anew") {
    struct Other final : Exploding {
      Other() : Exploding(-1) {}
      bool visit_state(TrainingState& state) override {
        int more = 0;
        state("more", more);
        return Exploding::visit_state(state);
      }
    } second;
    CHECK(training.run(second).iterations == 40);
    CHECK(second.steps == count_to(40));
  }
}

TEST_CASE("Without room for a checkpoint training goes on and the last good one stays") {
  Training training(3);
  Exploding first(-1);
  training.run(first);
  struct Full final : Exploding {
    Full() : Exploding(-1) {}
    bool visit_state(TrainingState& state) override {
      if (!state.reading()) throw Error(ExitCode::kEnvironment, "no space left on device");
      return Exploding::visit_state(state);
    }
  } second;
  training.options.run.iterations = 6;
  training.run(second);
  CHECK(second.steps == count_to(6));
  CHECK(steps_in(training.folder) == count_to(3));
}

TEST_CASE("Steps without room are counted, with the last one's iteration, also by one that goes on"
) {
  const test::OnHost on_host;
  const Training training(50, 10);
  const std::set<int> without_room{7, 13, 14, 23, 33};
  // Of 23 the checkpoint, of step 20, knows nothing.
  Cramped first(without_room, 25);
  CHECK_THROWS_AS(training.run(first), DeviceLost);
  Cramped second(without_room, -1);
  const TrainReport report = training.run(second);
  CHECK(report.void_steps.count == 5);
  CHECK(report.void_steps.last == 33);
  CHECK(training.logged("void_steps") == std::vector<int>{1, 3, 4, 5, 5});
}

TEST_CASE("Events between a line of the log and a checkpoint stand in the next line") {
  const Training training(10, 10);
  Losing first(6, -1);  // the event is that of step 3
  CHECK_THROWS_AS(training.run(first), DeviceLost);
  Exploding second(-1);
  training.run(second);
  REQUIRE(training.log().size() == 1);
  const Json line = training.log().front();
  REQUIRE(line.at("events").size() == 1);
  CHECK(line.at("events")[0].at("iteration") == 3);
}

namespace {

// Renders white; counts how often.
class White final : public Exploding {
 public:
  White() : Exploding(-1) {}
  MapSet render(const Camera& camera) override {
    ++renders;
    MapSet maps;
    maps["rgb"] = Image(camera.width, camera.height, 3, 1.0f);
    return maps;
  }
  int renders = 0;
};

// Ten black test views but the last, which is white.
Scene with_test_views() {
  Scene scene = one_view();
  for (int i = 0; i < 10; ++i) {
    View view;
    view.camera.width = view.camera.height = 2;
    view.rgb = Image(2, 2, 3, i == 9 ? 1.0f : 0.0f);
    scene.test.push_back(std::move(view));
  }
  return scene;
}

}  // namespace

TEST_CASE("The PSNR of at most eight test views is in the log where it is asked for, else nowhere"
) {
  const Scene scene = with_test_views();
  for (const int every : {0, 8}) {
    Training training(20, 10);
    White method;
    training.options.test_psnr_every = every;
    train(method, scene, training.options);
    std::vector<int> tested;
    for (const Json& line : training.log()) {
      if (!line.contains("test_psnr")) continue;
      tested.push_back(line["iteration"]);
      CHECK(line["test_psnr"] == 100.0 / 8);  // seven black views, 0 dB, and the white one
    }
    CHECK(method.renders == (every == 0 ? 0 : 3 * 8));
    CHECK(tested == (every == 0 ? std::vector<int>{} : std::vector<int>{7, 15, 19}));
    CHECK(
        training.logged("iteration") ==
        (every == 0 ? std::vector<int>{9, 19} : std::vector<int>{7, 9, 15, 19})
    );
  }
}

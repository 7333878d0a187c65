// SPDX-License-Identifier: MIT
#include "glint/train/trainer.h"

#include <catch2/catch.hpp>

#include <limits>
#include <set>
#include <sstream>

#include "glint/core/device_lost.h"
#include "glint/core/progress.h"
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
    stats.loss = iteration == at_ ? std::numeric_limits<double>::quiet_NaN() : 1.0;
    stats.terms["sharpness"] = stats.loss;
    if (iteration == 3) stats.events.emplace_back("opacities reset");
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

 private:
  int at_;
};

// One whose device is lost in a step, or in the middle of the n-th save.
class Losing final : public Exploding {
 public:
  Losing(int in_step, int in_save) : Exploding(-1), in_step_(in_step), in_save_(in_save) {}
  StepStats step(int iteration) override {
    if (iteration == in_step_) throw DeviceLost("gone");
    return Exploding::step(iteration);
  }
  void save(const std::string& folder) const override {
    write_file(fs::path(folder) / "state", fmt::format("of save {}", ++saves_));
    if (saves_ == in_save_) throw DeviceLost("gone");
  }

 private:
  int in_step_, in_save_;
  mutable int saves_ = 0;
};

Scene one_view() {
  Scene scene;
  scene.name = "one";
  scene.train.emplace_back();
  return scene;
}

}  // namespace

TEST_CASE(
    "A loss that stops being finite ends training, names the term and keeps the last good state"
) {
  set_quiet(true);
  const test::TempFolder temporary;
  const fs::path& folder = temporary.path();
  Exploding method(25);
  TrainOptions options;
  options.run.iterations = 100;
  options.folder = folder;
  options.save_interval = 10;
  try {
    train(method, one_view(), options);
    FAIL("training went on");
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kBadPrediction);
    CHECK(std::string(error.what()).find("iteration 25") != std::string::npos);
    CHECK(std::string(error.what()).find("sharpness") != std::string::npos);
  }
  CHECK(read_file(folder / "checkpoint" / "state") == "good");
}

TEST_CASE("A device that is lost ends training with the last checkpoint kept whole") {
  set_quiet(true);
  const test::TempFolder temporary;
  const fs::path& folder = temporary.path();
  TrainOptions options;
  options.run.iterations = 100;
  options.folder = folder;
  options.save_interval = 10;
  const auto message_of = [&](int in_step, int in_save) {
    Losing method(in_step, in_save);
    return test::error_of(ExitCode::kEnvironment, [&] {
      try {
        train(method, one_view(), options);
      } catch (const DeviceLost&) {
        throw;  // still known as such
      } catch (...) {
        FAIL("another error");
      }
    });
  };
  CHECK_THAT(message_of(5, -1), Catch::Contains("iteration 5, before the first checkpoint: gone"));
  CHECK_THAT(message_of(25, -1), Catch::Contains("iteration 25, the last checkpoint is in "));
  CHECK(read_file(folder / "checkpoint" / "state") == "of save 2");
  // Lost while a checkpoint is written: the one before is there.
  CHECK_THAT(message_of(-1, 3), Catch::Contains("iteration 29, the last checkpoint is in "));
  CHECK(read_file(folder / "checkpoint" / "state") == "of save 2");
}

TEST_CASE("Events between two lines of the log stand in the second, with their iteration") {
  set_quiet(true);
  const test::TempFolder temporary;
  Exploding method(25);
  TrainOptions options;
  options.run.iterations = 20;
  options.folder = temporary.path();
  options.log_interval = 10;
  train(method, one_view(), options);
  std::istringstream log(read_file(options.folder / "log.jsonl"));
  std::string first, second;
  std::getline(log, first);
  std::getline(log, second);
  CHECK(Json::parse(first)["events"] == Json({{{"iteration", 3}, {"text", "opacities reset"}}}));
  CHECK_FALSE(Json::parse(second).contains("events"));
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

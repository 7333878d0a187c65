// SPDX-License-Identifier: MIT
// A program of its own: an interrupt stays seen until the program ends.
#include <catch2/catch.hpp>

#include <csignal>

#include "glint/core/interrupt.h"
#include "glint/core/progress.h"
#include "glint/train/checkpoint.h"
#include "glint/train/trainer.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

// Its machine is taken back in a step.
class Preempted final : public Method {
 public:
  explicit Preempted(int at) : at_(at) {}
  void initialize(const Scene&, const RunOptions&) override {}
  StepStats step(int iteration) override {
    if (iteration == at_) std::raise(SIGUSR1);
    steps.push_back(iteration);
    return {};
  }
  MapSet render(const Camera&) override { return {}; }
  void save(const std::string&) const override {}
  void load(const std::string&) override {}
  Json config() const override { return Json::object(); }
  void check_finite() const override {}
  std::size_t num_surfels() const override { return 1; }
  bool visit_state(TrainingState& state) override {
    state("steps", steps);
    return true;
  }
  std::vector<int> steps;

 private:
  int at_;
};

}  // namespace

TEST_CASE("A training whose machine is taken back leaves a checkpoint of its last step") {
  set_quiet(true);
  const test::TempFolder folder;
  Scene scene;
  scene.train.emplace_back();
  TrainOptions options;
  options.run.iterations = 10;
  options.folder = folder.path();
  install_interrupt_handler();
  Preempted method(4);
  CHECK_THROWS_AS(train(method, scene, options), Interrupted);
  CHECK(interrupted_exit() == 128 + SIGUSR1);
  Preempted read(-1);
  TrainingProgress progress;
  read_checkpoint(folder.path() / kCheckpointFile, read, progress);
  CHECK(progress.iterations == 5);
  CHECK(read.steps == std::vector<int>{0, 1, 2, 3, 4});
  const Json told = Json::parse(read_file(folder.path() / kProgressFile));
  CHECK(told.at("iterations") == 5);
  CHECK(told.at("ended") == false);
  // Stopped before a step of its own, it writes nothing anew.
  fs::remove_all(folder.path() / "checkpoint");
  Preempted next(-1);
  CHECK_THROWS_AS(train(next, scene, options), Interrupted);
  CHECK(!fs::exists(folder.path() / kCheckpointFile));
}

// SPDX-License-Identifier: MIT
// How long cells take and what they need, from records, checkpoints and sizes.
#include "reports/run/executors/cell_queue.h"

#include <catch2/catch.hpp>

#include "glint/train/checkpoint.h"
#include "reports/run/bench/cell_needs.h"
#include "reports/run/bench/cell_stages.h"
#include "reports/run/bench/device_of_cells.h"
#include "reports/run/records/run_folder.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

struct Queued {
  test::TempFolder folder;
  RunnerOptions options = fake_run(folder.path());
  std::vector<PlanCell> plan = make_plan(options.profile, {}, {});

  void add(const std::string& method, double seconds, double device_mb) const {
    Record record;
    record.cell = {"room_9", method, 0};
    record.timings = {{"train", seconds}, {"score", 4.0}};
    if (device_mb > 0) record.metrics["device-memory"] = device_mb;
    append_record(options.out / "records.jsonl", record);
  }
  CellQueue queue(CellOrder order = CellOrder::kGiven) const { return {plan, options, order}; }
};

struct Resumable : FakeMethod {
  using FakeMethod::FakeMethod;
  bool visit_state(TrainingState&) override { return true; }
};

}  // namespace

TEST_CASE("memory of the card is what the method had there, else the most that any had") {
  const Queued queued;
  CHECK(queued.queue().card_bytes_of(queued.plan[0]) == 0);  // nothing is known of a folder's data
  queued.add("fake/other", 1, 3000);
  CHECK(queued.queue().card_bytes_of(queued.plan[0]) == device_bytes_of_process(3e9));
  queued.add("fake", 1, 2000);
  CHECK(queued.queue().card_bytes_of(queued.plan[0]) == device_bytes_of_process(2e9));
}

TEST_CASE("of a room that is made, memory of the card goes by its size at first") {
  Queued queued;
  queued.options.profile.scenes = {"room_1"};
  queued.options.profile.defaults = {{"width", 640}, {"height", 360}};
  queued.plan = make_plan(queued.options.profile, {}, {});
  CHECK(queued.queue().card_bytes_of(queued.plan[0]) > 5e8);
}

TEST_CASE("what takes too long waits no more, and the shortest of it is known") {
  const Queued queued;
  queued.add("fake", 100, 0);
  queued.add("fake/other", 50, 0);
  CellQueue queue = queued.queue();
  queue.set_aside_longer_than(60);
  CHECK(queue.size() == 2);
  CHECK(queue.set_aside().size() == 2);
  CHECK(queue.shortest_set_aside()->cell->cell.method == "fake");
  queue.set_aside_longer_than(10);
  CHECK(queue.empty());
  CHECK(queue.shortest_set_aside()->cell->cell.method == "fake/other");
}

TEST_CASE("what a checkpoint has of a training is not waited for again") {
  const Queued queued;
  queued.add("fake", 100, 0);
  const fs::path run = run_folder(queued.options.out, queued.plan[0].cell);
  CHECK(queued.queue().seconds_of(queued.plan[0]) == 104.0);
  // A checkpoint of these settings, as far as the queue looks at it.
  const CellStages stages = cell_stages(
      queued.plan[0], queued.options.profile, fake_identity(queued.plan[0].source), nullptr, run
  );
  Resumable method(Json::object());
  REQUIRE(write_checkpoint(run / kCheckpointFile, stages[Stage::kTrain].key(), method, {}));
  write_file(run / kProgressFile, R"({"iterations": 75, "of": 100})");
  CHECK(queued.queue().seconds_of(queued.plan[0]) == 29.0);
  Queued anew;
  anew.options.out = queued.options.out;
  anew.options.force = true;
  CHECK(anew.queue().seconds_of(anew.plan[0]) == 104.0);
}

TEST_CASE("keys are of the device that cells run on, wherever they are planned") {
  const Queued queued;
  const PlanCell& cell = queued.plan[0];
  const auto train_key = [&] {
    const SceneIdentity scene = fake_identity(cell.source);
    return cell_stages(cell, queued.options.profile, scene, nullptr, {})[Stage::kTrain].key();
  };
  const std::string here = train_key();
  {
    const DeviceOfCells elsewhere(Device::kCuda);
    CHECK(train_key() != here);
  }
  CHECK(train_key() == here);
}

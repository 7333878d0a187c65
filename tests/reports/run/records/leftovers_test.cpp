// SPDX-License-Identifier: MIT
#include "reports/run/records/leftovers.h"

#include <catch2/catch.hpp>

#include "glint/core/file_lock.h"
#include "glint/train/checkpoint.h"
#include "reports/run/records/records.h"
#include "reports/run/records/run_folder.h"
#include "reports/run/records/stage_files.h"
#include "tests/support/captured.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

struct Store : test::TempFolder {
  fs::path run(const std::string& cell) const { return path() / "runs" / cell; }
  fs::path make_run(const std::string& cell) const {
    RunSpec spec;
    spec.folder = run(cell);
    write_run_spec(spec, Json::object());
    return spec.folder;
  }
  void record(const std::string& scene, bool ok) const {
    Record record;
    record.cell = {scene, "2dgs", 0};
    if (!ok) record.failure = Failure{"train", "not-finite", "the loss is nan", {}};
    append_record(path() / "records.jsonl", record);
  }
  // Names of what is left over, below the store.
  std::vector<std::string> found(bool unfinished = false) const {
    std::vector<std::string> names;
    for (const Leftover& leftover : find_leftovers(path(), unfinished))
      names.push_back(leftover.path.lexically_relative(path()).generic_string());
    return names;
  }
};
using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("Runs without anything to go on from are left over, others only if asked for") {
  const Store store;
  store.make_run("finished/2dgs/0");
  store.record("finished", true);
  store.make_run("failed/2dgs/0");
  store.record("failed", false);
  store.make_run("started/2dgs/0");
  write_file(store.make_run("stopped/2dgs/0") / kCheckpointFile, "state");
  write_file(store.path() / "runs/theirs/config.json", "{}");
  CHECK(store.found() == Names{"runs/started/2dgs/0"});
  CHECK(
      store.found(true) == Names{"runs/failed/2dgs/0", "runs/started/2dgs/0", "runs/stopped/2dgs/0"}
  );
  const auto at_work = FileLock::take(FileLock::file_beside(store.run("started/2dgs/0")));
  CHECK(store.found().empty());
}

TEST_CASE("What a finished run no longer needs is left over") {
  const Store store;
  const fs::path run = store.make_run("room_1/2dgs/0");
  write_file(run / "interface.ply", "ply");
  write_stage(run, Stage::kTrain, Json::object(), {"interface.ply"});
  store.record("room_1", true);
  write_file(run / kCheckpointFile, "state");
  RunSpec previous;
  previous.folder = run / "previous_run";
  write_run_spec(previous, Json::object());
  write_file(run / "thesis.tex", "mine");
  CHECK(
      store.found() ==
      Names{"runs/room_1/2dgs/0/checkpoint/state.safetensors", "runs/room_1/2dgs/0/previous_run"}
  );
  for (const Leftover& leftover : find_leftovers(store.path(), false)) {
    CHECK(leftover.bytes > 0);
    remove_leftover(leftover);
  }
  CHECK(store.found().empty());
  CHECK(fs::exists(run / "interface.ply"));
  CHECK(fs::exists(run / "thesis.tex"));
  CHECK(!fs::exists(run / "previous_run"));
}

TEST_CASE("a run that cannot be looked at is a warning, and the others are listed") {
  const Store store;
  store.make_run("started/2dgs/0");
  const fs::path odd = store.make_run("odd/2dgs/0"), lost = store.run("lost/2dgs/0");
  fs::create_directories(odd / "checkpoint");
  fs::create_symlink("nowhere", odd / kCheckpointFile);
  fs::create_directories(lost);
  fs::create_symlink("nowhere", lost / "config.json");
  std::string said =
      test::captured(2, [&] { CHECK(store.found() == Names{"runs/started/2dgs/0"}); });
  for (const char* name : {"odd/2dgs/0/checkpoint/state.safetensors", "lost/2dgs/0/config.json"})
    CHECK_THAT(said, Catch::Contains(std::string(name) + ": is a link that leads nowhere"));
}

TEST_CASE("Of a run that goes, what others put there stays") {
  const Store store;
  const fs::path run = store.make_run("room_1/2dgs/0");
  write_file(run / "thesis.tex", "mine");
  for (const Leftover& leftover : find_leftovers(store.path(), false)) remove_leftover(leftover);
  CHECK(fs::exists(run / "thesis.tex"));
  CHECK(!fs::exists(run / "config.json"));
}

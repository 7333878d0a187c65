// SPDX-License-Identifier: MIT
#include "reports/run/parcels/make_parcel.h"

#include <catch2/catch.hpp>

#include "glint/core/progress.h"
#include "reports/run/parcels/parcel_file.h"
#include "reports/run/records/stage_files.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

[[maybe_unused]] const bool quiet = (set_quiet(true), true);

// Cells of fake methods in a folder, with parcels beside it.
struct Cells {
  test::TempFolder folder;
  RunnerOptions options = fake_run(folder / "out");
  fs::path parcels = folder / "parcels";

  Cells() { options.ended = parcel_writer(parcels); }
  fs::path file(const CellKey& cell) const { return parcels / parcel_name(cell); }
};

}  // namespace

TEST_CASE("each cell that ended leaves a parcel, and those that failed do") {
  Cells cells;
  cells.options.assignments = {"fake/other.fails=step"};
  CHECK(run_profile(cells.options).failed == 2);
  CHECK(list_files(cells.parcels).size() == 4);
  const Parcel whole = read_parcel(cells.file({"room_1", "fake", 0}));
  CHECK(whole.record.metrics.contains("psnr"));
  for (const char* file :
       {"config.json", "env.json", "metrics.json", "log.jsonl", "keys/score.json"})
    CHECK(whole.files.contains(file));
  CHECK(whole.files.contains("renders/0003/rgb.png"));
  REQUIRE(whole.model.files.size() == 1);  // its file of surfels is none: it goes as it is
  CHECK(whole.model.files[0].bytes == "0.5");
  CHECK(whole.model.difference == DepthDifference{});
  const Json render = Json::parse(whole.files.at("keys/render.json"));
  CHECK(render["files"].contains("renders/0003/rgb.png"));
  CHECK(!render["files"].contains("renders/0003/rgb.exr"));

  const Parcel failed = read_parcel(cells.file({"room_2", "fake/other", 0}));
  CHECK(failed.record.failure->message == "fake failure in step");
  CHECK(failed.model.files.empty());
}

TEST_CASE("parcels that are missing, or of an earlier record, are written later") {
  Cells cells;
  run_profile(cells.options);
  const fs::path first = cells.file({"room_1", "fake", 0}),
                 second = cells.file({"room_2", "fake", 0});
  const auto time = fs::last_write_time(second);
  fs::remove(first);
  write_missing_parcels(cells.options, cells.parcels, true);
  CHECK(!fs::exists(first));  // only of cells that failed
  write_missing_parcels(cells.options, cells.parcels);
  CHECK(read_parcel(first).record.ok());
  CHECK(fs::last_write_time(second) == time);

  // What failed without a word of its own was recorded by another process.
  Record record = read_parcel(first).record;
  record.failure = Failure{"train", "crash", "SIGSEGV", {}};
  record.metrics.clear();
  append_record(cells.options.out / "records.jsonl", record);
  write_missing_parcels(cells.options, cells.parcels, true);
  CHECK(read_parcel(first).record.failure->kind == "crash");
  CHECK(fs::last_write_time(second) == time);
}

TEST_CASE("a parcel that cannot be made is a warning, and the cells go on") {
  Cells cells;
  write_file(cells.parcels, "a file where the folder should be");
  CHECK(run_profile(cells.options).ran == 4);
}

// SPDX-License-Identifier: MIT
#include "reports/run/records/merge_runs.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "reports/run/records/run_folder.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

Record record_of(const std::string& method, double psnr) {
  Record record;
  record.cell = {"room_1", method, 0};
  record.metrics = {{"psnr", psnr}, {"fps", psnr * 7}};
  record.train_key = record.score_key = "k";
  return record;
}

Record failed(const std::string& method) {
  Record record = record_of(method, 0);
  record.metrics.clear();
  record.failure = Failure{"train", "crash", "SIGSEGV", {}};
  return record;
}

// A profile's folder with these records, and a file in each run folder that names where it is from.
struct Store {
  test::TempFolder folder;
  explicit Store(const std::string& name, const std::vector<Record>& records) {
    for (const Record& record : records) {
      append_record(file(), record);
      write_file(run(record) / "interface.ply", name);
      write_file(run(record) / kRecordFile, record_to_json(record).dump());
    }
  }
  fs::path file() const { return folder.path() / "records.jsonl"; }
  fs::path run(const Record& record) const { return run_folder(folder.path(), record.cell); }
  std::string from(const Record& record) const { return read_file(run(record) / "interface.ply"); }
};

std::vector<MergeVerdict> verdicts(const std::vector<MergedCell>& cells) {
  std::vector<MergeVerdict> all;
  for (const MergedCell& cell : cells) all.push_back(cell.verdict);
  return all;
}

using V = MergeVerdict;

}  // namespace

TEST_CASE("cells of another machine are taken over, with their folders") {
  const Store ours("ours", {record_of("a", 20)}), theirs("theirs", {record_of("b", 21)});
  CHECK(
      verdicts(merge_runs(ours.folder.path(), theirs.folder.path(), true)) == std::vector{V::kTaken}
  );
  CHECK(read_records(ours.file()).size() == 2);
  CHECK(ours.from(record_of("b", 0)) == "theirs");
  CHECK(ours.from(record_of("a", 0)) == "ours");
  // Once more changes nothing.
  CHECK(
      verdicts(merge_runs(ours.folder.path(), theirs.folder.path(), true)) ==
      std::vector{V::kReplicate}
  );
  CHECK(read_records(ours.file()).size() == 2);
}

TEST_CASE("equal scores are replicates, whatever they cost; others are conflicts and kept") {
  Record slower = record_of("a", 20);
  slower.metrics["fps"] = 1;
  Record other = record_of("b", 22), settings = record_of("c", 20);
  settings.train_key = "other";
  const Store ours("ours", {record_of("a", 20), record_of("b", 20), record_of("c", 20)});
  const Store theirs("theirs", {slower, other, settings});
  const auto merged = merge_runs(ours.folder.path(), theirs.folder.path(), true);
  REQUIRE(verdicts(merged) == std::vector{V::kReplicate, V::kConflict, V::kConflict});
  CHECK_THAT(merged[1].why, Catch::StartsWith("psnr 20 and 22; kept: that of"));
  CHECK_THAT(
      merged[2].why,
      Catch::StartsWith("trained by other settings or code; kept: that of an unknown machine")
  );
  CHECK(read_records(ours.file())[1].metrics.at("psnr") == 20);
  CHECK(ours.from(other) == "ours");
}

TEST_CASE("a conflict names the data or the revisions that differ, and both machines") {
  const auto made = [](const char* revision, const char* machine) {
    Record record = record_of("a", 20);
    record.train_key = revision;
    record.environment = {{"git_revision", revision}, {"machine", machine}, {"cpu", "EPYC"}};
    return record;
  };
  const Record ours = made("1a", "left");
  Record theirs = made("2b", "right");
  CHECK_THAT(score_differences(ours, theirs), Catch::Contains("(revisions 1a and 2b)"));
  const Store here("ours", {ours}), there("theirs", {theirs});
  CHECK_THAT(
      merge_runs(here.folder.path(), there.folder.path(), false)[0].why,
      Catch::Contains("kept: that of left (EPYC), not of right (EPYC)")
  );
  theirs.dataset_hash = "other";
  CHECK(score_differences(ours, theirs) == "trained on other data");
}

TEST_CASE("a finished cell takes the place of a failed one, not the other way round") {
  const Store ours("ours", {failed("a"), record_of("b", 20)});
  const Store theirs("theirs", {record_of("a", 20), failed("b")});
  CHECK(
      verdicts(merge_runs(ours.folder.path(), theirs.folder.path(), true)) ==
      std::vector{V::kTaken, V::kLeft}
  );
  const auto records = read_records(ours.file());
  CHECK(records[0].ok());
  CHECK(records[1].ok());
  CHECK(ours.from(failed("a")) == "theirs");
}

TEST_CASE("what a link in a run leads to is copied") {
  const Store ours("ours", {}), theirs("theirs", {record_of("b", 21)});
  const test::TempFolder disk;
  const fs::path there = theirs.run(record_of("b", 0));
  write_file(disk / "renders/0000/rgb.exr", "render");
  write_file(disk / "mesh.ply", "mesh");
  fs::create_directory_symlink(disk / "renders", there / "renders");
  fs::create_symlink(disk / "mesh.ply", there / "mesh.ply");
  REQUIRE(
      verdicts(merge_runs(ours.folder.path(), theirs.folder.path(), true)) == std::vector{V::kTaken}
  );
  const fs::path here = ours.run(record_of("b", 0));
  CHECK(read_file(here / "renders/0000/rgb.exr") == "render");
  CHECK(read_file(here / "mesh.ply") == "mesh");
  CHECK_FALSE(fs::is_symlink(here / "renders"));
  CHECK_FALSE(fs::is_symlink(here / "mesh.ply"));
}

TEST_CASE("what cannot be copied of a run is named, and nothing of the run is taken over") {
  const Store ours("ours", {}), theirs("theirs", {record_of("b", 21)});
  const fs::path there = theirs.run(record_of("b", 0));
  const auto refused = [&](const fs::path& file, const char* why) {
    for (const bool write : {false, true}) {
      const std::string said = test::error_of(ExitCode::kBadPrediction, [&] {
        merge_runs(ours.folder.path(), theirs.folder.path(), write);
      });
      CHECK_THAT(said, Catch::StartsWith(file.string() + ": is " + why));
    }
    fs::remove(file);
    CHECK(read_records(ours.file()).empty());
    CHECK_FALSE(fs::exists(ours.run(record_of("b", 0))));
  };
  const fs::path file = there / "renders/0000/rgb.exr";
  fs::create_directories(file.parent_path());
  REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
  refused(file, "a pipe");
  fs::create_symlink("nowhere", file);
  refused(file, "a link that leads nowhere");
  fs::create_directory_symlink(there, there / "renders/again");
  refused(there / "renders/again", "a link that leads back to a folder around it");
}

TEST_CASE("asked only, nothing is written") {
  const Store ours("ours", {}), theirs("theirs", {record_of("b", 21)});
  CHECK(
      verdicts(merge_runs(ours.folder.path(), theirs.folder.path(), false)) ==
      std::vector{V::kTaken}
  );
  CHECK(fs::is_empty(ours.folder.path()));
}

TEST_CASE("run folders that were copied together join the records") {
  const Store ours("ours", {record_of("a", 20)}), theirs("theirs", {record_of("b", 21)});
  fs::copy(
      theirs.folder.path() / "runs",
      ours.folder.path() / "runs",
      fs::copy_options::recursive | fs::copy_options::skip_existing
  );
  CHECK(verdicts(adopt_runs(ours.folder.path(), true)) == std::vector{V::kReplicate, V::kTaken});
  CHECK(read_records(ours.file()).size() == 2);
  // A record that does not belong where it lies is not taken.
  write_file(
      ours.folder.path() / "runs/room_1/c/0" / kRecordFile, record_to_json(record_of("z", 1)).dump()
  );
  CHECK(adopt_runs(ours.folder.path(), true).size() == 2);
}

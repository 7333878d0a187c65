// SPDX-License-Identifier: MIT
// Nothing that this program did not write is ever removed, and no run is lost to one that fails.
#include <catch2/catch.hpp>

#include <chrono>

#include "glint/core/file_lock.h"
#include "glint/scene/image_files.h"
#include "glint/train/checkpoint.h"
#include "reports/run/records/earlier_run.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using test::run;

namespace {

struct Place : test::TempFolder {
  fs::path mine = path() / "mine";

  int train(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {
        "train",
        "--dataset",
        test::small_room_folder(),
        "--run",
        mine,
        "--iterations",
        "3",
        "--quiet",
        "--out",
        path() / "out",
        "--data",
        path() / "data"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  int import_from(const fs::path& theirs) const {
    return run(
        {"eval",
         "--predictions",
         theirs,
         "--dataset",
         test::small_room_folder(),
         "--method",
         "theirs",
         "--force",
         "--quiet",
         "--out",
         path() / "out",
         "--data",
         path() / "data"}
    );
  }
};

}  // namespace

TEST_CASE("a folder with a config.json of someone else's is refused and left as it is") {
  const Place place;
  write_file(place.mine / "config.json", R"({"model_type": "bert"})");
  write_file(place.mine / "thesis.tex", "five years");
  CHECK(place.train({"--force"}) == 1);
  CHECK(read_file(place.mine / "thesis.tex") == "five years");
  CHECK(read_file(place.mine / "config.json") == R"({"model_type": "bert"})");
  fs::remove(place.mine / "config.json");
  CHECK(place.train({"--force"}) == 1);
  CHECK(read_file(place.mine / "thesis.tex") == "five years");
}

TEST_CASE("training again takes the files of the run, and no others") {
  const Place place;
  REQUIRE(place.train() == 0);
  REQUIRE(run({"render", "--run", place.mine, "--quiet"}) == 0);
  const std::vector<fs::path> foreign = {
      "thesis.tex", "mine.ply", "figures/a.png", "renders/notes.txt"};
  for (const fs::path& file : foreign) write_file(place.mine / file, "mine");
  REQUIRE(place.train({"--force"}) == 0);
  for (const fs::path& file : foreign) CHECK(read_file(place.mine / file) == "mine");
  CHECK(fs::exists(place.mine / "interface.ply"));
  CHECK_FALSE(fs::exists(place.mine / "strip.png"));  // of the run before
  CHECK_FALSE(fs::exists(place.mine / "previous_run"));
  // A foreign file that changes later is no damage to the run, and rendering leaves it alone.
  write_file(place.mine / "mine.ply", "another size");
  CHECK(run({"render", "--run", place.mine, "--quiet"}) == 0);
  CHECK(read_file(place.mine / "renders/notes.txt") == "mine");
}

TEST_CASE("what others put beside a checkpoint stays when the run goes, and is said") {
  const Place place;
  write_file(place.mine / "config.json", R"({"written_by": "glint-bench"})");
  write_file(place.mine / kCheckpointFile, "state");
  write_file(place.mine / kProgressFile, "{}");
  write_file(place.mine / "checkpoint/notes/why.txt", "mine");
  std::string said = test::captured(2, [&] { REQUIRE(place.train({"--force"}) == 0); });
  CHECK(read_file(place.mine / "checkpoint/notes/why.txt") == "mine");
  CHECK_THAT(said, Catch::Contains("mine/checkpoint/notes/why.txt: of no run, left as it is"));
  CHECK_FALSE(fs::exists(place.mine / kCheckpointFile));
  // A finished run that is set aside, and put back where nothing comes of the new one.
  const std::string model = read_file(place.mine / "interface.ply");
  { const EarlierRun earlier(place.mine); }
  CHECK(read_file(place.mine / "interface.ply") == model);
  REQUIRE(place.train({"--force"}) == 0);
  CHECK(read_file(place.mine / "checkpoint/notes/why.txt") == "mine");
}

TEST_CASE("an import in a place where another process is at work names it") {
  const Place place;
  for (const View& view : test::small_room().test)
    write_png(place / "theirs/rgb" / (view.name + ".png"), view.rgb);
  const fs::path imported = place / "out/ci/runs/room_1/theirs/0";
  write_file(imported / "renders/half.png", "of an import that has just begun");
  const auto lock = FileLock::take(FileLock::file_beside(imported));
  REQUIRE(std::holds_alternative<FileLock>(lock));
  const std::string said =
      test::captured(2, [&] { CHECK(place.import_from(place / "theirs") == 1); });
  CHECK_THAT(said, Catch::Contains("theirs/0: process "));
  CHECK_THAT(said, Catch::Contains("is at work there; wait for it, or give another --method"));
}

TEST_CASE("a training that cannot begin leaves the finished run") {
  const Place place;
  REQUIRE(place.train() == 0);
  const std::string model = read_file(place.mine / "interface.ply");
  CHECK(place.train({"--force", "--set", "nosuch=1"}) == 1);
  CHECK(run({"train", "--dataset", place / "gone", "--run", place.mine, "--force"}) == 3);
  CHECK(read_file(place.mine / "interface.ply") == model);
  CHECK(run({"render", "--run", place.mine, "--quiet"}) == 0);
}

TEST_CASE("an import that fails leaves the one before") {
  const Place place;
  const auto write_renders = [&](const fs::path& folder) {
    for (const View& view : test::small_room().test)
      write_png(folder / "rgb" / (view.name + ".png"), view.rgb);
  };
  write_renders(place / "good");
  write_renders(place / "bad");
  const std::string last = test::small_room().test.back().name + ".png";
  write_file(place / "bad/rgb" / last, "no picture");
  REQUIRE(place.import_from(place / "good") == 0);
  const fs::path imported = place / "out/ci/runs/room_1/theirs/0";
  const std::string scores = read_file(imported / "metrics.json");
  CHECK(place.import_from(place / "bad") == 2);
  CHECK(read_file(imported / "metrics.json") == scores);
  CHECK_FALSE(fs::exists(imported / "previous_run"));
  CHECK(run({"eval", "--run", imported, "--quiet", "--out", place / "out"}) == 0);
}

TEST_CASE("an import says where it is recorded in terms of what was asked") {
  const Place place;
  for (const View& view : test::small_room().test)
    write_png(place / "good/rgb" / (view.name + ".png"), view.rgb);
  const auto said = [&](std::vector<std::string> more) {
    std::vector<std::string> args = {
        "eval",
        "--predictions",
        place / "good",
        "--dataset",
        test::small_room_folder(),
        "--method",
        "theirs",
        "--out",
        place / "out",
        "--data",
        place / "data",
        "--force"};
    args.insert(args.end(), more.begin(), more.end());
    return test::captured(2, [&] { CHECK(run(args) == 0); });
  };
  const std::string out = (place / "out").string();
  CHECK_THAT(
      said({}),
      Catch::Contains("recorded in " + out + "/ci/records.jsonl") &&
          Catch::Contains(fmt::format("below --out {}, in the store of profile ci", out))
  );
  CHECK_THAT(said({"--profile", "smoke"}), Catch::Contains("in the store of profile smoke"));
}

TEST_CASE("a method's name that leads out of the results is a usage error") {
  const Place place;
  for (const char* name : {"../../../x", "/x", "a/../b", "x\n"})
    CHECK(
        run(
            {"eval",
             "--predictions",
             place / "good",
             "--dataset",
             test::small_room_folder(),
             "--method",
             name,
             "--quiet",
             "--out",
             place / "out",
             "--data",
             place / "data"}
        ) == 1
    );
  CHECK_FALSE(fs::exists(place / "out"));
}

TEST_CASE("what a killed process left half-written goes with the next stage") {
  const Place place;
  REQUIRE(place.train() == 0);
  const fs::path half = place.mine / "renders/0000/.rgb.1-elsewhere.part.exr";
  write_file(half, "half");
  fs::last_write_time(half, fs::file_time_type::clock::now() - std::chrono::hours(25));
  REQUIRE(run({"render", "--run", place.mine, "--quiet"}) == 0);
  CHECK_FALSE(fs::exists(half));
}

TEST_CASE("a training killed while it wrote its first file begins again") {
  const Place place;
  const fs::path half = place.mine / ".config.1-elsewhere.part.json";
  write_file(half, "half");
  CHECK(place.train() == 1);  // of another machine, and fresh: somebody may be writing it
  fs::last_write_time(half, fs::file_time_type::clock::now() - std::chrono::hours(25));
  CHECK(place.train() == 0);
  CHECK_FALSE(fs::exists(half));
  CHECK(fs::exists(place.mine / "interface.ply"));
}

TEST_CASE("a run that stops after its first steps leaves the one before beside it") {
  const Place place;
  REQUIRE(place.train() == 0);
  const std::string model = read_file(place.mine / "interface.ply");
  {
    const EarlierRun earlier(place.mine);
    CHECK_FALSE(fs::exists(place.mine / "interface.ply"));
    write_file(place.mine / "config.json", R"({"written_by": "glint-bench"})");
    write_file(place.mine / "log.jsonl", "{}\n");
  }
  CHECK(read_file(place.mine / "previous_run/interface.ply") == model);
  CHECK(read_file(place.mine / "log.jsonl") == "{}\n");
  REQUIRE(place.train({"--force"}) == 0);  // the one that ends takes its place
  CHECK_FALSE(fs::exists(place.mine / "previous_run"));
}

TEST_CASE("a run that cannot be put back is a warning that names it, and stays where it is") {
  const Place place;
  REQUIRE(place.train() == 0);
  const std::string model = read_file(place.mine / "interface.ply");
  const std::string said = test::captured(2, [&] {
    const EarlierRun earlier(place.mine);
    write_file(place.mine / "interface.ply/notes.txt", "a folder of that name");
  });
  CHECK_THAT(said, Catch::Contains("mine: the earlier run could not be put back: "));
  CHECK(read_file(place.mine / "previous_run/interface.ply") == model);
  CHECK(read_file(place.mine / "interface.ply/notes.txt") == "a folder of that name");
  fs::remove_all(place.mine / "interface.ply");
  { const EarlierRun goes_on(place.mine); }
  CHECK(read_file(place.mine / "interface.ply") == model);
}

TEST_CASE("making room goes on where it was cut off") {
  const Place place;
  REQUIRE(place.train() == 0);
  const std::string model = read_file(place.mine / "interface.ply");
  const fs::path previous = place.mine / "previous_run";
  // As a kill leaves it: the mark is in both places, some files have gone over.
  write_file(previous / "config.json", read_file(place.mine / "config.json"));
  fs::rename(place.mine / "interface.ply", previous / "interface.ply");
  {
    const EarlierRun earlier(place.mine);
    CHECK(read_file(previous / "interface.ply") == model);
    CHECK(fs::exists(previous / "keys/train.json"));
  }
  CHECK(read_file(place.mine / "interface.ply") == model);  // nothing came of the new one
  CHECK(run({"render", "--run", place.mine, "--quiet"}) == 0);
}

TEST_CASE("a run folder in which another process is at work is left alone") {
  const Place place;
  REQUIRE(place.train() == 0);
  const std::string model = read_file(place.mine / "interface.ply");
  const auto lock = FileLock::take(FileLock::file_beside(place.mine));
  REQUIRE(std::holds_alternative<FileLock>(lock));
  CHECK(place.train({"--force"}) == 1);
  for (const char* verb : {"render", "mesh", "eval"})
    CHECK(run({verb, "--run", place.mine, "--quiet"}) == 1);
  CHECK(read_file(place.mine / "interface.ply") == model);
}

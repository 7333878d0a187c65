// SPDX-License-Identifier: MIT
// A room whose truth is kept back, from the command line: trained on by one, scored by another.
#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "datasets/holdout.h"
#include "glint/core/config.h"
#include "reports/run/records/records.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Parts {
  TempFolder folder;
  const std::string room = small_room_folder().string();
  const std::string open = folder / "open", truth = folder / "truth", whole = folder / "whole";

  Parts() {
    const std::string said = captured(1, [&] {
      REQUIRE(
          run({"dataset", "holdout", room, "--out", open, "--truth", truth, "--json", "--quiet"}) ==
          0
      );
    });
    const Json json = Json::parse(said);
    CHECK(json["test_views"] == 2);
    CHECK_THAT(json["warning"].get<std::string>(), Contains("--seed 0"));
    for (const std::string& part : {open, truth})
      fs::copy(part, whole, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }
};

// What a command that fails says.
std::string refusal(ExitCode code, const std::vector<std::string>& words) {
  return captured(2, [&] { CHECK(run(words) == static_cast<int>(code)); });
}

std::map<std::string, double> scores(const std::string& renders, const std::string& dataset) {
  const TempFolder out;
  captured(1, [&] {
    REQUIRE(
        run(
            {"eval",
             "--predictions",
             renders,
             "--dataset",
             dataset,
             "--method",
             "theirs",
             "--out",
             out.path(),
             "--quiet"}
        ) == 0
    );
  });
  return read_records(out.path() / "ci/records.jsonl").at(0).metrics;
}

}  // namespace

TEST_CASE("renders made without the truth score as with the whole room") {
  const Parts parts;
  const std::string trained = parts.folder / "run";
  captured(1, [&] {
    REQUIRE(
        run(
            {"train",
             "--dataset",
             parts.open,
             "--method",
             "2dgs",
             "--iterations",
             "3",
             "--run",
             trained,
             "--quiet"}
        ) == 0
    );
    REQUIRE(run({"render", "--run", trained, "--quiet"}) == 0);
  });
  const auto put_together = scores(trained, parts.whole), of_room = scores(trained, parts.room);
  CHECK(put_together == of_room);
  CHECK(of_room.contains("psnr"));
  CHECK(of_room.contains("normal-mae@glass"));
  CHECK_THAT(
      refusal(ExitCode::kBadReference, {"eval", "--run", trained, "--quiet"}),
      Contains("are kept back")
  );
}

TEST_CASE("without the truth nothing is scored, and everything says why") {
  const Parts parts;
  CHECK_THAT(
      captured(
          1,
          [&] {
            CHECK(run({"dataset", "info", parts.open, "--quiet"}) == 0);
          }
      ),
      Contains("photos and ground truth of its test views are kept back")
  );
  CHECK_THAT(
      refusal(
          ExitCode::kBadReference,
          {"eval", "--predictions", ".", "--dataset", parts.open, "--method", "mine", "--quiet"}
      ),
      Contains("give the folder in which both parts are put together")
  );
  CHECK_THAT(
      refusal(
          ExitCode::kUsage,
          {"train",
           "--dataset",
           parts.open,
           "--test-psnr-every",
           "1",
           "--iterations",
           "2",
           "--run",
           parts.folder / "run",
           "--quiet"}
      ),
      Contains("leave out --test-psnr-every")
  );
}

TEST_CASE("packed and exported, such a scene is still one") {
  const Parts parts;
  const std::string packed = parts.folder / "open.safetensors", other = parts.folder / "colmap";
  REQUIRE(run({"dataset", "pack", parts.open, packed, "--quiet"}) == 0);
  CHECK(is_held_out(load_scene(packed, {})));
  REQUIRE(
      run({"dataset", "export", parts.open, "--format", "colmap", "--out", other, "--quiet"}) == 0
  );
  CHECK(is_held_out(fs::path(other)));
  CHECK_THAT(
      refusal(
          ExitCode::kBadReference,
          {"eval", "--predictions", ".", "--dataset", packed, "--method", "mine", "--quiet"}
      ),
      Contains("are kept back")
  );
}

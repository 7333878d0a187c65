// SPDX-License-Identifier: MIT
// A room in two folders: nothing of its truth is in the one for everybody.
#include "datasets/holdout.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "datasets/dataset.h"
#include "datasets/glassroom/glassroom.h"
#include "glint/core/config.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/rng.h"
#include "glint/core/sha256.h"
#include "glint/scene/image_files.h"
#include "tests/support/captured.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr std::uint64_t kSeed = 0x123456789abcdefULL;

// Made once: a room of a seed that nobody guesses, in two parts.
struct Parts {
  TempFolder folder;
  fs::path room = folder / "room", for_all = folder / "public", truth = folder / "truth";
  HoldoutReport report;

  explicit Parts(std::uint64_t seed = kSeed) {
    set_quiet(true);
    GlassRoomOptions options;
    options.width = 32;
    options.height = 18;
    options.views = 17;
    options.spp = 1;
    options.seed = seed;
    make_glassroom(options, room, false);
    report = hold_out_truth({room, for_all, truth});
  }
};

const Parts& parts() {
  static const Parts made;
  return made;
}

std::string short_hash(const std::string& bytes) {
  return fmt::format("{:016x}", hash_name(bytes));
}

std::set<std::string> contents_below(const fs::path& folder) {
  std::set<std::string> contents;
  for (const fs::path& file : list_files_below(folder)) contents.insert(read_file(file));
  return contents;
}

std::set<std::string> names_below(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::path& file : list_files_below(folder))
    names.insert(file.lexically_relative(folder).generic_string());
  return names;
}

// Numbers of scene.json that lead to the room.
std::vector<std::string> secrets() {
  const Json whole = read_json_object(parts().room / "scene.json");
  std::vector<std::string> all{
      std::to_string(kSeed), fmt::format("{:x}", kSeed), whole["hash"].get<std::string>()};
  for (const char* field : {"layout_seed", "render_seed"}) {
    all.push_back(whole[field].dump());
    all.push_back(fmt::format("{:x}", whole[field].get<std::uint64_t>()));
  }
  return all;
}

}  // namespace

TEST_CASE("no file of the truth, no hash of one and no seed is in the folder for everybody") {
  const std::set<std::string> open = contents_below(parts().for_all);
  for (const fs::path& file : list_files_below(parts().truth)) {
    INFO(file.string());
    const std::string bytes = read_file(file);
    CHECK_FALSE(open.contains(bytes));
    for (const std::string& text : open) {
      CHECK(text.find(short_hash(bytes)) == std::string::npos);
      CHECK(text.find(sha256(bytes)) == std::string::npos);
    }
  }
  for (const std::string& secret : secrets())
    for (const std::string& text : open) CHECK(text.find(secret) == std::string::npos);
  const Json told = read_json_object(parts().for_all / "scene.json");
  for (const char* field :
       {"options", "layout_seed", "render_seed", "container", "items", "materials", "exposure"})
    CHECK_FALSE(told.contains(field));
}

TEST_CASE("photos and priors of training views are for everybody, and nothing else of views") {
  for (const std::string& name : names_below(parts().for_all)) {
    INFO(name);
    CHECK_FALSE(name.starts_with("gt/"));
    for (const char* test : {"/0000/", "/0008/", "/0016/"})
      if (name.find(test) != std::string::npos) CHECK(name.starts_with("images/"));
  }
  const Image grey = read_image(parts().for_all / "images/0008/000000.png", 3);
  CHECK(grey.size() == ImageSize{32, 18});
  const auto values = grey.values();
  CHECK(std::all_of(values.begin(), values.end(), [&](float v) { return v == values[0]; }));
  CHECK(parts().report.test_views == 3);
  CHECK(parts().report.warning.empty());
}

TEST_CASE("both parts put together are the room, byte for byte") {
  const TempFolder folder;
  const auto copy = fs::copy_options::recursive | fs::copy_options::overwrite_existing;
  for (const fs::path& part : {parts().for_all, parts().truth})
    fs::copy(part, folder / "all", copy);
  CHECK(names_below(folder / "all") == names_below(parts().room));
  for (const std::string& name : names_below(parts().room))
    CHECK(read_file(folder.path() / "all" / name) == read_file(parts().room / name));
  CHECK(check_dataset(folder / "all").empty());
  CHECK_FALSE(is_held_out(folder.path() / "all"));
}

TEST_CASE("a scene without its truth is read for training, with all its cameras") {
  CHECK(is_held_out(parts().for_all));
  CHECK(check_dataset(parts().for_all).empty());
  Scene open = load_scene(parts().for_all, {});
  const Scene whole = load_scene(parts().room, {});
  CHECK(open.spec_hash != whole.spec_hash);
  CHECK(open.train.size() == whole.train.size());
  REQUIRE(open.test.size() == whole.test.size());
  for (std::size_t i = 0; i < open.test.size(); ++i) {
    CHECK(open.test[i].name == whole.test[i].name);
    CHECK(length(open.test[i].camera.center() - whole.test[i].camera.center()) == 0);
    CHECK(open.test[i].priors.empty());
    CHECK(open.test[i].truth.empty());
  }
  CHECK(open.points.positions.size() == whole.points.positions.size());
  CHECK_FALSE(is_held_out(open));
  note_held_out(parts().for_all, open);
  CHECK(is_held_out(open));
  error_of(ExitCode::kBadReference, [&] { check_not_held_out("x", open); });
}

TEST_CASE("a seed that can be guessed is told") {
  const Parts guessable(7);
  CHECK_THAT(guessable.report.warning, Contains("--seed 7"));
}

TEST_CASE("what is there stays, parts lie apart, and other layouts are refused") {
  const TempFolder folder;
  const Parts& made = parts();
  const auto refusal = [&](const HoldoutOptions& options) {
    return error_of(ExitCode::kUsage, [&] { hold_out_truth(options); });
  };
  CHECK_THAT(refusal({made.room, made.for_all, folder / "t"}), Contains("not an empty folder"));
  CHECK_THAT(refusal({made.for_all, folder / "p", folder / "t"}), Contains("kept back already"));
  CHECK_THAT(refusal({made.room, made.room / "p", folder / "t"}), Contains("lies in"));
  CHECK_THAT(refusal({made.room, folder / "p", folder / "p/t"}), Contains("lies in"));
  CHECK_THAT(refusal({made.room, folder / "p", folder / "p"}), Contains("lies in"));
  fs::create_directories(folder / "colmap/images");
  write_file(folder / "colmap/transforms_train.json", "{}");
  CHECK_THAT(
      refusal({folder / "colmap", folder / "p", folder / "t"}), Contains("dataset export --format")
  );
  CHECK_FALSE(fs::exists(folder / "p"));
  CHECK_FALSE(fs::exists(folder / "t"));
  error_of(ExitCode::kBadReference, [&] {
    hold_out_truth({folder / "nowhere", folder / "p", folder / "t"});
  });
}

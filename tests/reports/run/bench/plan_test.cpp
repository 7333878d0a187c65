// SPDX-License-Identifier: MIT
#include "reports/run/bench/plan.h"

#include <catch2/catch.hpp>

#include "reports/run/records/embedded.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

Profile fake_profile() {
  register_fake_methods();
  Profile profile;
  profile.name = "fake";
  profile.methods = {"fake", "fake/other"};
  profile.seeds = {0, 1};
  profile.scenes = {"room_1", "room_2"};
  return profile;
}

std::size_t count(const CellFilter& filter) { return make_plan(fake_profile(), filter, {}).size(); }

}  // namespace

TEST_CASE("a plan is scene x method x seed, scene by scene") {
  const auto plan = make_plan(fake_profile(), {}, {});
  REQUIRE(plan.size() == 8);
  CHECK(plan[0].cell.text() == "room_1/fake/0");
  CHECK(plan[1].cell.text() == "room_1/fake/1");
  CHECK(plan[2].cell.text() == "room_1/fake/other/0");
  CHECK(plan[7].cell.text() == "room_2/fake/other/1");
}

TEST_CASE("filters match the whole cell or its scene or method") {
  CHECK(count({{"room_1"}, {}}) == 4);
  CHECK(count({{"fake"}, {}}) == 4);
  CHECK(count({{"fake/*"}, {}}) == 4);
  CHECK(count({{"*/fake/*/1"}, {}}) == 2);
  CHECK(count({{"room_2/fake/0"}, {}}) == 1);
  CHECK(
      count(
          {{},
           {"room_?"
            "/fake/other"}}
      ) == 4
  );
  CHECK(count({{"room_1", "room_2/fake"}, {"*/1"}}) == 3);
}

TEST_CASE("filters that leave nothing are a usage error") {
  CHECK_THROWS_WITH(count({{"room_1/fake/7"}, {}}), Catch::Contains("no cell left"));
  CHECK_THROWS_WITH(
      count({{"room_1", "rom_2"}, {}}),
      Catch::Contains("--only 'rom_2'") && Catch::Contains("did you mean 'room_2'?")
  );
}

TEST_CASE("unknown methods and fields stop a plan before anything runs") {
  Profile profile = fake_profile();
  CHECK_THROWS_WITH(make_plan(profile, {}, {"gray=1"}), Catch::Contains("no field 'gray'"));
  CHECK_THROWS_WITH(make_plan(profile, {}, {"grey"}), Catch::Contains("name=value"));
  profile.methods = {"fakee"};
  CHECK_THROWS_WITH(make_plan(profile, {}, {}), Catch::Contains("'fake'"));
  profile = fake_profile();
  profile.overrides["fakee"] = Json::object();
  CHECK_THROWS_WITH(make_plan(profile, {}, {}), Catch::Contains("'fake'"));
}

TEST_CASE("time is estimated for the stages to do, from finished cells of the same method") {
  const PlanCell cell = make_plan(fake_profile(), {{"room_1/fake/0"}, {}}, {})[0];
  Record a, b;
  a.cell = {"room_1", "fake", 1};
  a.timings = {{"train", 10.0}, {"mesh", 4.0}, {"score", 2.0}};
  b.cell = {"room_1", "fake/other", 1};
  b.timings = {{"train", 1000.0}};
  CHECK(estimated_seconds(cell, {a, b}, {"train", "render", "mesh", "score"}) == 16.0);
  CHECK(estimated_seconds(cell, {a, b}, {"mesh", "score"}) == 6.0);
  CHECK(!estimated_seconds(cell, {b}, {"train"}));
  a.metrics["train-minutes"] = 0.5;  // of several processes, of which the last took 10 s
  CHECK(estimated_seconds(cell, {a, b}, {"train", "score"}) == 32.0);
}

TEST_CASE("a profile may do without some of its cells, also when they are asked for") {
  Profile profile = fake_profile();
  const std::size_t all = make_plan(profile, {}, {}).size();
  profile.leave_out = {"room_1/fake/*"};
  const auto plan = make_plan(profile, {}, {});
  CHECK(plan.size() < all);
  for (const PlanCell& cell : plan)
    CHECK_FALSE((cell.cell.scene == "room_1" && cell.cell.method == "fake"));
  CHECK_THROWS_WITH(
      make_plan(profile, {{"room_1/fake/0"}, {}}, {}), Catch::Contains("no cell left")
  );
}

TEST_CASE("patterns that leave nothing out are refused") {
  Profile profile = fake_profile();
  for (const char* good :
       {"room_1", "fake", "room_1/fake", "*/fake/7", "room_[12]/fa*", "room_2/*"})
    CHECK_NOTHROW(make_plan(profile, {.skip = {good}, .methods = {"2dgs"}}, {}));
  for (const char* bad : {"rom_1", "room_1/fakee", "fake/room_1"})
    CHECK_THROWS_WITH(
        make_plan(profile, {.skip = {bad}}, {}),
        Catch::Contains("--skip") && !Catch::Contains("--methods")
    );
  profile.leave_out = {"rom_1/*"};
  CHECK_THROWS_WITH(make_plan(profile, {}, {}), Catch::Contains("leave_out 'rom_1/*' fits no"));
}

TEST_CASE("fields of methods that are not run are checked, too") {
  Profile profile = load_profile("smoke");
  profile.overrides["glint"] = {{"lambda_depht", 0.2}};
  CHECK_THROWS_WITH(make_plan(profile, {}, {}), Catch::Contains("no field 'lambda_depht'"));
  profile.overrides["glint"] = {{"lambda_depth", 0.2}};
  CHECK_FALSE(make_plan(profile, {}, {"glint.lambda_depth=0.3"}).empty());
  CHECK_THROWS_WITH(
      make_plan(profile, {}, {"glint.nofield=3"}), Catch::Contains("no field 'nofield'")
  );
}

TEST_CASE("every built-in profile is valid") {
  for (const std::string& name : embedded_names("profiles")) {
    const Profile profile = load_profile(name);
    CHECK(profile.name == name);
    CHECK_FALSE(profile.methods.empty());
    CHECK_FALSE(profile.description.empty());
  }
}

TEST_CASE("the profile of priors has each level of one room, under its name") {
  std::vector<std::string> levels;
  for (const SceneSource& source : load_profile("priors").sources()) {
    CHECK(source.room == "room_4");
    CHECK(source.priors == source.scene);
    levels.push_back(source.priors);
  }
  CHECK(levels == prior_levels());
}

TEST_CASE("a profile file of the user's is read, and its mistakes are named") {
  const test::TempFolder folder;
  const fs::path file = folder.path() / "mine.toml";
  write_file(file, "methods = ['2dgs']\nscenes = [{scene = 'fox', folder = 'fox'}]\n");
  CHECK(load_profile(file.string()).name == "mine");
  CHECK(load_profile(file.string()).sources()[0].folder == "fox");
  write_file(file, "method = ['2dgs']\n");
  CHECK_THROWS_WITH(load_profile(file.string()), Catch::Contains("no field 'method'"));
  write_file(file, "scenes = ['a', 'a']\n");
  CHECK_THROWS_WITH(load_profile(file.string()), Catch::Contains("stands there twice"));
  write_file(file, "scenes = [{scene = 'a', priors = 'porr'}]\n");
  CHECK_THROWS_WITH(
      load_profile(file.string()),
      Catch::Contains("scene 'a': priors is 'porr'") && Catch::Contains("did you mean 'poor'")
  );
  const auto check_refused = [&](const std::string& text, const std::string& message) {
    write_file(file, text);
    INFO(text);
    CHECK_THROWS_WITH(load_profile(file.string()), Catch::Contains(message));
  };
  check_refused("methods = ['2dgs', '2dgs']\n", "methods has 2dgs twice");
  check_refused("seeds = [0, 1, 0]\n", "seeds has 0 twice");
  check_refused("[mesh]\nvoxel = -1\n", "[mesh]: voxel is -1");
  check_refused("[mesh]\nmax_depth = -1\n", "[mesh]: max_depth is -1");
  check_refused("[mesh]\ntruncation_voxels = 1e9\n", "truncation_voxels is");
  check_refused("[mesh]\nbounds_min = [1, 1, 1]\nbounds_max = [0, 2, 2]\n", "bounds_max is 0");
  check_refused(
      "[mesh_metrics]\ncull = 'camera'\n", "cull cannot be \"camera\"; expected none, or cameras"
  );
  check_refused("[mesh_metrics]\ndistance = 'foo'\n", "distance cannot be \"foo\"");
  check_refused(
      "[mesh_metrics]\ncull_tolerance_m = -1\n", "[mesh_metrics]: cull_tolerance_m is -1"
  );
  check_refused("[mesh_metrics]\nthresholds_m = []\n", "thresholds_m is empty");
  check_refused("iterations = -5\n", "iterations is -5; expected 1 or more");
  check_refused("timing_warmup = -5\n", "timing_warmup is -5");
  for (const char* wrong :
       {"image_ratio = -2",
        "image_ratio = 1e9",
        "max_pixels = -5",
        "width = -64",
        "height = 100000",
        "views = -3",
        "spp = 0"}) {
    const std::string field = std::string(wrong).substr(0, std::string(wrong).find(' '));
    check_refused(fmt::format("scenes = [{{scene = 'a', {}}}]\n", wrong), "scene 'a': " + field);
  }
  check_refused("[mesh_metrics]\nnum_samples = 0\n", "num_samples");
  check_refused("[mesh_metrics]\nthresholds_m = [-0.1]\n", "thresholds_m");
  write_file(file, "scenes = [\n");
  CHECK_THROWS_WITH(load_profile(file.string()), Catch::Contains("mine.toml:"));
  CHECK_THROWS_WITH(
      load_profile("nope"), Catch::Contains("ci, layers, paper, prior_flaws, priors, small, smoke")
  );
}

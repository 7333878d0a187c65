// SPDX-License-Identifier: MIT
// Models of other programs, from their files to a row in a table.
#include "reports/run/import/import_model.h"

#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "reports/run/records/records.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

void put(const fs::path& path) { write_file(path, "of no matter here"); }

std::string bad_model(const fs::path& model) {
  return error_of(ExitCode::kBadPrediction, [&] { find_model(model); });
}

// glint-bench's words for a model on the small room.
std::vector<std::string> render(const fs::path& model, const fs::path& to) {
  return {
      "render",
      "--model",
      model,
      "--dataset",
      small_room_folder(),
      "--run",
      to,
      "--data",
      to.parent_path() / "data",
      "--quiet"};
}

// A run of a few steps; its folder.
fs::path trained(const TempFolder& folder, const std::string& method) {
  const fs::path to = folder / method;
  REQUIRE(
      run(
          {"train",
           "--dataset",
           small_room_folder(),
           "--method",
           method,
           "--run",
           to,
           "--iterations",
           "8",
           "--data",
           folder / "data",
           "--quiet"}
      ) == 0
  );
  REQUIRE(run({"render", "--run", to, "--quiet"}) == 0);
  return to;
}

std::string first_picture(const fs::path& run) {
  for (const auto& entry : fs::directory_iterator(run / "renders"))
    return read_file(entry.path() / "rgb.exr");
  return {};
}

}  // namespace

TEST_CASE("sets are found under the names of several programs") {
  const TempFolder folder;
  put(folder / "one/any_name.ply");
  CHECK(find_model(folder / "one/any_name.ply").method == "2dgs");
  for (const char* iteration : {"iteration_7000", "iteration_30000", "iteration_x"})
    put(folder / "3dgs/point_cloud" / iteration / "point_cloud.ply");
  const ModelFiles last = find_model(folder / "3dgs");
  CHECK(last.sets.at(0).path.parent_path().filename() == "iteration_30000");
  put(folder / "official/pcd.ply");
  put(folder / "official/env.ply");
  const ModelFiles envgs = find_model(folder / "official");
  CHECK(envgs.method == "envgs");
  CHECK(envgs.config.empty());
  put(folder / "official/trans_env.ply");
  const ModelFiles glint = find_model(folder / "official");
  CHECK(glint.method == "glint");
  REQUIRE(glint.sets.size() == 3);
  CHECK(glint.sets[1].name == "transmission.ply");
  CHECK(glint.sets[0].channels == std::vector<std::string>{"transparency", "specular"});
  CHECK(glint.sets[1].channels.empty());
  CHECK(glint.config.at("mirror_near") == 0.06);
  CHECK(glint.config.at("secondary_near") == 0.06);
}

TEST_CASE("folders without a whole model are refused") {
  const TempFolder folder;
  CHECK_THAT(bad_model(folder / "nothing"), Contains("no model"));
  put(folder / "half/env.ply");
  CHECK_THAT(bad_model(folder / "half"), Contains("found env.ply"));
  put(folder / "odd/interface.ply");
  put(folder / "odd/transmission.ply");
  CHECK_THAT(bad_model(folder / "odd"), Contains("transmission.ply and reflection.ply"));
}

TEST_CASE("our own models, taken for another program's, give the same pictures") {
  const TempFolder folder;
  for (const std::string method : {"2dgs", "envgs", "glint"}) {
    INFO(method);
    const fs::path ours = trained(folder, method), theirs = folder / (method + "-again");
    auto words = render(ours, theirs);
    if (method == "glint")
      words.insert(words.end(), {"--set", "mirror_near=0", "--set", "secondary_near=0"});
    REQUIRE(run(words) == 0);
    CHECK(first_picture(theirs) == first_picture(ours));
  }
}

TEST_CASE("secondary rays of another program's GLINT start as in the official code, and it is noted"
) {
  const TempFolder folder;
  const fs::path ours = trained(folder, "glint"), theirs = folder / "theirs";
  REQUIRE(run(render(ours, theirs)) == 0);
  CHECK(first_picture(theirs) != first_picture(ours));
  const Json config = parse_json(read_file(theirs / "config.json")).at("config");
  CHECK(config.at("mirror_near").get<float>() == 0.06f);
  CHECK_THAT(read_file(theirs / "env.json"), Contains("mirror_near"));
  auto words = render(ours, folder / "other");
  words.insert(words.end(), {"--set", "no_such_field=1"});
  CHECK(run(words) == 1);
}

TEST_CASE("a model is scored, recorded under its own name, and verified") {
  const TempFolder folder;
  const fs::path ours = trained(folder, "2dgs"), theirs = folder / "theirs";
  auto words = render(ours / "interface.ply", theirs);
  words.insert(words.end(), {"--method", "2dgs-official"});
  REQUIRE(run(words) == 0);
  CHECK(run(words) == 1);  // there is a run now
  words.push_back("--force");
  CHECK(run(words) == 0);
  const std::string out = folder / "out";
  REQUIRE(run({"eval", "--run", theirs, "--out", out, "--quiet"}) == 0);
  const auto records = read_records(folder / "out/single/records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].cell.method == "2dgs-official");
  CHECK(records[0].metrics.contains("psnr"));
  CHECK_FALSE(records[0].metrics.contains("train-minutes"));
  CHECK_THAT(records[0].notes.at(0), Contains("trained by another program"));
  const std::string said = captured(1, [&] { CHECK(run({"verify", theirs, "--quiet"}) == 0); });
  CHECK_THAT(said, !Contains("BAD") && !Contains("bad "));
}

TEST_CASE("models that cannot be shown end with a message and no run") {
  const TempFolder folder;
  const fs::path ours = trained(folder, "2dgs");
  fs::create_directories(folder / "pair");
  fs::copy_file(ours / "interface.ply", folder / "pair/pcd.ply");
  fs::copy_file(ours / "interface.ply", folder / "pair/env.ply");
  const std::string said =
      captured(2, [&] { CHECK(run(render(folder / "pair", folder / "run")) == 2); });
  CHECK_THAT(said, Contains("pcd.ply: no field specular"));
  CHECK_FALSE(fs::exists(folder / "run/config.json"));
  auto words = render(ours / "interface.ply", folder / "run");
  words.insert(words.end(), {"--method", "glint"});
  CHECK(run(words) == 1);  // that row is ours
}

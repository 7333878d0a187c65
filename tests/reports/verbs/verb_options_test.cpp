// SPDX-License-Identifier: MIT
// What verbs offer, what they answer to misspelt words, and what they print.
#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

#include "glint/method.h"
#include "reports/verbs/verb.h"
#include "tests/reports/run_words.h"

using namespace glint;
using test::captured;
using test::run;

namespace {

std::string errors_of(const std::vector<std::string>& words) {
  return captured(2, [&] { CHECK(run(words) == 1); });
}

Json json_of(const std::vector<std::string>& words) {
  const std::string text = captured(1, [&] { CHECK(run(words) == 0); });
  return Json::parse(text);
}

std::vector<std::string> options_of(const std::string& verb) {
  const CommandLine line;
  std::vector<std::string> names;
  for (const CLI::Option* option : line.app.get_subcommand(verb)->get_options())
    if (option->nonpositional() && !option->get_group().empty())
      names.push_back(option->get_name());
  std::sort(names.begin(), names.end());
  return names;
}

// "depth prior" of "... has no depth prior for 2 of 2 training views".
void add_missed_priors(const std::string& id, const Scene& scene, std::set<std::string>& missed) {
  const std::string before = "has no ", behind = " prior";
  const auto method = create_method(id);
  method->initialize(scene, {100, 0});
  for (const std::string& warning : method->warnings()) {
    const std::size_t begin = warning.find(before), end = warning.find(behind, begin);
    if (begin == std::string::npos || end == std::string::npos) continue;
    const std::size_t name = begin + before.size();
    missed.insert(warning.substr(name, end + behind.size() - name));
  }
}

}  // namespace

TEST_CASE("a verb shows the options that it uses, and takes the common ones of all others") {
  using Names = std::vector<std::string>;
  CHECK(options_of("methods") == Names{"--help", "--json"});
  CHECK(options_of("results") == Names{"--help", "--root"});
  Names of_plan = {
      "--data",
      "--device",
      "--help",
      "--iterations",
      "--json",
      "--methods",
      "--only",
      "--out",
      "--profile",
      "--quiet",
      "--seed",
      "--set",
      "--skip"};
  Names of_status = of_plan;
  for (const char* own : {"--leftovers", "--tasks", "--unfinished", "--yes"})
    of_status.emplace_back(own);
  std::sort(of_status.begin(), of_status.end());
  CHECK(options_of("status") == of_status);
  of_plan.insert(of_plan.begin(), "--card");
  of_plan.emplace_back("--threads");
  CHECK(options_of("doctor") == of_plan);
  const std::string said = captured(2, [] {
    CHECK(run({"methods", "glint", "--seed", "3"}) == 0);
  });
  CHECK(said == "warning: methods: --seed changes nothing here\n");
}

TEST_CASE("misspelt words are answered with the nearest") {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"redner", "--run", "x"}, "no verb 'redner'; did you mean 'render'?"},
      {{"dataset", "inf", "x"}, "no verb 'inf'; did you mean 'info'?"},
      {{"render", "--rnu", "x"}, "no option '--rnu'; did you mean 'run'?"},
      {{"status", "--iter", "5"}, "did you mean 'iterations'?"},
      {{"status", "--profle=ci"}, "no option '--profle'; did you mean 'profile'?"},
      {{"status", "--profile", "smok"}, "did you mean 'smoke'?"},
      {{"status", "--profile", "smoke", "--only", "rom_1"}, "did you mean 'room_1'?"},
      {{"status", "--profile", "smoke", "--set", "2dgs.lamda_ssim=1"},
       "did you mean 'lambda_ssim'?"},
      {{"status", "--profile", "smoke", "--set", "2gds.lambda_ssim=1"}, "did you mean '2dgs'?"},
      {{"methods", "glnt"}, "did you mean 'glint'?"}};
  for (const auto& [words, answer] : cases) {
    const std::string said = errors_of(words);
    INFO(said);
    CHECK(said.find(answer) != std::string::npos);
  }
  CHECK(errors_of({"render", "surplus"}).find("no use for 'surplus'") != std::string::npos);
}

TEST_CASE(
    "values of --set are read as people type them, and another type is told with the right one"
) {
  const auto plan = [](const std::string& assignment) {
    return std::vector<std::string>{
        "status", "--profile", "smoke", "--methods", "2dgs", "--set", assignment, "--json"};
  };
  const auto train_key = [&](const std::string& assignment) {
    const std::string said = captured(1, [&] { CHECK(run(plan(assignment)) == 0); });
    return Json::parse(said)["cells"][0]["stages"]["train"]["key"].get<std::string>();
  };
  const std::string half = train_key("lambda_ssim=0.5");
  for (const char* value : {".5", "5e-1"})
    CHECK(train_key(std::string("lambda_ssim=") + value) == half);
  CHECK_THAT(
      errors_of(plan("lambda_ssim=half")), Catch::Contains("cannot be \"half\"; expected number")
  );
  CHECK_THAT(
      errors_of(plan("sh_interval=1.5")), Catch::Contains("cannot be 1.5; expected integer")
  );
}

TEST_CASE("a misspelt metric is answered with the nearest of the stores") {
  const test::TempFolder folder;
  write_file(
      folder / "records.jsonl",
      R"({"scene": "room_1", "method": "2dgs", "metrics": {"psnr": 30}})"
      "\n"
  );
  const std::string store = folder.path().string();
  CHECK(
      errors_of({"compare", store, store, "--metric", "pnsr"}).find("did you mean 'psnr'?") !=
      std::string::npos
  );
}

TEST_CASE("what prints JSON opens with the schema") {
  const test::TempFolder folder;
  const std::string out = folder.path().string();
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"methods", "--json"},
           {"methods", "2dgs/prior", "--json"},
           {"status", "--profile", "smoke", "--out", out, "--json"},
           {"status", "--profile", "smoke", "--out", out, "--json", "--quiet"}}) {
    const Json json = json_of(words);
    CHECK(json.begin().key() == "schema");
    CHECK(json["schema"] == kVerbSchema);
  }
}

TEST_CASE("status knows nothing of data in folders, and says so with null") {
  const test::TempFolder folder;
  write_file(
      folder / "mine.toml",
      "methods = [\"2dgs\"]\nscenes = [{scene = \"desk\", folder = \"no/such/folder\"}]\n"
  );
  const Json json = json_of(
      {"status",
       "--profile",
       (folder / "mine.toml").string(),
       "--out",
       folder.path().string(),
       "--json",
       "--quiet"}
  );
  CHECK(json["cells"][0]["estimated_seconds"].is_null());
}

TEST_CASE("methods lists every method, and of each the fields with their meaning") {
  const Json list = json_of({"methods", "--json"});
  CHECK(list["methods"].size() == Registry<MethodSpec>::all().size());
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    const auto method = create_method(id);
    CHECK(method->fields().size() == method->config().size());
    for (const ConfigField& field : method->fields()) CHECK_FALSE(field.meaning.empty());
  }
  const Json prior = json_of({"methods", "2dgs/prior", "--json"});
  bool found = false;
  for (const Json& field : prior["fields"])
    if (field["name"] == "lambda_depth") {
      found = true;
      CHECK(field["default"] == 0);
      CHECK(field["override"] > 0);
      CHECK(field["type"] == "number");
    }
  CHECK(found);
}

TEST_CASE("methods want the priors of which they would miss one") {
  Scene scene;
  scene.name = "bare";
  View view;
  view.camera.width = view.camera.height = 32;
  view.camera.fx = view.camera.fy = 32;
  view.camera.cx = view.camera.cy = 16;
  view.camera.translation_cam_from_world = {0, 0, 2};
  view.rgb = Image(32, 32, 3, 0.5f);
  // What glint/oracle is given.
  view.truth["depth"] = view.truth["glass"] = Image(32, 32, 1, 1.0f);
  view.truth["normal"] = Image(32, 32, 3, 1.0f);
  scene.train = {view, view};
  scene.points.positions = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0.1f, 0.1f, 0}};
  scene.points.colors.assign(4, {0.5f, 0.5f, 0.5f});
  scene.bounds_min = {-1, -1, -1}, scene.bounds_max = {1, 1, 1};
  // Guidance of t asks for base colours only where it has albedo.
  Scene with_albedo = scene;
  for (View& each : with_albedo.train) each.priors["albedo"] = each.rgb;
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    INFO(id);
    std::set<std::string> missed, wanted;
    for (const Scene* data : {&scene, &with_albedo}) add_missed_priors(id, *data, missed);
    for (const std::string& input : create_method(id)->inputs())
      if (input.ends_with(" prior")) wanted.insert(input);
    CHECK(missed == wanted);
  }
}

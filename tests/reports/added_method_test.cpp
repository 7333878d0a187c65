// SPDX-License-Identifier: MIT
// What docs/guide/your_method.md promises: a method that is registered, here by this file, is
// trained, rendered, scored, and stands in every table, in the figures and on the page, although no
// profile names it.
#include <catch2/catch.hpp>

#include <vector>

#include "glint/method.h"
#include "reports/run/records/records.h"
#include "reports/show/tables/tables.h"
#include "tests/reports/run_words.h"

using namespace glint;
using test::run;

namespace {

constexpr const char* kId = "my-method";
constexpr const char* kTitle = "My Method";

// Another program's method would be a file in baselines/; this one trains as 2DGS does.
void register_my_method() {
  MethodSpec spec;
  spec.id = kId;
  spec.title = kTitle;
  spec.create = [](const Json& config) { return create_method("2dgs", config); };
  Registry<MethodSpec>::add(spec, "");
}

constexpr const char* kProfile = R"(
iterations = 20
methods = ["2dgs"]
timing_frames = 1
timing_warmup = 0
scenes = ["room_1"]
[defaults]
width = 48
height = 27
views = 10
spp = 2
[mesh]
voxel = 0.2
[mesh_metrics]
num_samples = 1000
)";

}  // namespace

TEST_CASE("a method in a file of its own is trained, tabulated, drawn and shown") {
  register_my_method();
  const test::TempFolder folder;
  write_file(folder / "tiny.toml", kProfile);
  const std::string profile = (folder / "tiny.toml").string(), out = (folder / "out").string(),
                    data = (folder / "data").string();
  const std::vector<std::string> common = {
      "--profile", profile, "--out", out, "--data", data, "--quiet"};
  const auto run_verb = [&](std::vector<std::string> words) {
    words.insert(words.end(), common.begin(), common.end());
    return run(words);
  };
  REQUIRE(run_verb({"all", "--executor", "inline", "--methods", std::string("2dgs,") + kId}) == 0);

  const fs::path results = folder / "out/tiny";
  const auto records = read_records(results / "records.jsonl");
  const Record* record = find_record(records, {"room_1", kId, 0});
  REQUIRE(record != nullptr);
  CHECK(record->ok());
  CHECK(record->metrics.contains("psnr"));
  CHECK(fs::exists(results / "runs/room_1" / kId / "0/strip.png"));

  for (const TableDefinition& definition : table_definitions()) {
    INFO(definition.id);
    if (definition.where_measured) continue;  // of data that has more than rooms
    const std::string table = read_file(results / "tables" / (definition.id + ".md"));
    CHECK(table.find(fmt::format("| {} |", kTitle)) != std::string::npos);
  }
  CHECK(read_file(results / "report/assets/data.js").find(kTitle) != std::string::npos);
  CHECK(fs::exists(results / "figures/qualitative.png"));

  CHECK(run_verb({"table", "--methods", kId}) == 0);
  CHECK(run_verb({"figures", "--methods", kId}) == 0);
  CHECK(run_verb({"report", "--methods", kId}) == 0);
  const std::string page = read_file(results / "report/assets/data.js");
  CHECK(page.find(kTitle) != std::string::npos);
  CHECK(page.find("2DGS") == std::string::npos);
}

// SPDX-License-Identifier: MIT
// What our own programs leave behind and read again: records, run folders, logs, profiles.
#include "reports/run/records/earlier_run.h"
#include "reports/run/records/profile.h"
#include "reports/run/records/records.h"
#include "reports/run/records/run_folder.h"
#include "reports/run/records/stage_files.h"
#include "reports/show/pictures/training_curve.h"
#include "reports/show/tables/table_writers.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

bool read_lines(std::string_view bytes) {
  const fs::path file = input_file(bytes, "records.jsonl"), again = input_folder() / "again.jsonl";
  return accepts([&] {
    const std::vector<Record> records = read_records(file);
    fs::remove(again);
    for (const Record& record : records) append_record(again, record);
    if (read_records(again).size() != records.size())
      throw Finding("records that are other ones when they are written again");
  });
}

// As people see them; in a terminal, nothing of it is a command.
bool show_lines(std::string_view bytes) {
  const fs::path file = input_file(bytes, "records.jsonl");
  static const std::vector<TableDefinition> definitions = table_definitions();
  return accepts([&] {
    const Table table = build_table(definitions.front(), read_records(file));
    table_markdown(table), table_latex(table), table_csv(table);
    for (const unsigned char c : table_terminal(table))
      if (c < 32 && c != '\n') throw Finding("a control character in a terminal");
  });
}

std::vector<FuzzInput> line_seeds() {
  return {
      {"ok",
       R"({"schema":2,"profile":"ci","dataset":"glassroom","scene":"room_1","method":"glint/no-trans","seed":0,"resolution":"160x90","num_surfels":5,"warnings":["w"],"notes":[],"not_measured":{"lpips":"no weights"},"not_applicable":["x"],"timings":{"train":1.5},"environment":{"revision":"a"},"status":"ok","metrics":{"psnr":20.5,"psnr@glass":null}}
)"},
      {"failed",
       R"({"schema":1,"scene":"a","method":"b","seed":18446744073709551615,"status":"failed","failure":{"stage":"train","kind":"crash","message":"m","log_tail":["l"]}}
{"torn)"}};
}

// A run folder's files are read in many places; here each reader gets the same bytes.
bool read_run(std::string_view bytes) {
  const fs::path run = input_folder() / "run";
  fs::create_directories(run / "keys");
  fs::create_directories(run / "renders/0000");
  for (const char* file : {"config.json", "env.json", "keys/train.json", "log.jsonl"})
    input_file(bytes, run / file);
  bool taken = accepts([&] { read_run_spec(run); });
  taken = accepts([&] { trained_cost({.folder = run}); }) && taken;
  accepts([&] { is_our_run(run); });
  accepts([&] { is_eight_bit_render(run / "renders/0000"); });
  accepts([&] {
    if (const auto stage = read_stage(run, Stage::kTrain))
      stage_differences(stage->document, Json::object());
  });
  accepts([&] { log_tail(run); });
  accepts([&] { training_curve(run / "log.jsonl"); });
  return taken;
}

std::vector<FuzzInput> run_seeds() {
  return {
      {"config",
       R"({"written_by":"glint-bench","method":"2dgs","overrides":{},"iterations":60,"seed":0,"dataset":"d","scene":"s","max_pixels":0.0,"dataset_hash":"h","dataset_folder":"/x","config":{"eight_bit":true},"train_seconds":1.5,"peak_memory_mb":2,"warnings":[],"notes":["n"]})"},
      {"log",
       R"({"written_by":"glint-bench","method":"2dgs","overrides":{},"iterations":60,"seed":0,"dataset":"d","scene":"s","max_pixels":0,"dataset_hash":"h","dataset_folder":"/x","config":{},"iteration":1,"seconds":0.5,"loss":0.25,"psnr":20,"num_surfels":7,"terms":{"photometric":0.25},"events":[{"iteration":1,"text":"opacities reset"}]})"}};
}

bool read_profile(std::string_view bytes) {
  // Messages name a profile by its stem.
  const fs::path file = input_file(bytes, input_folder().filename().string() + ".toml");
  return accepts([&] {
    const Profile profile = load_profile(file.string());
    for (const std::string& method : profile.methods) method_overrides(profile, method, {});
  });
}

std::vector<FuzzInput> profile_seeds() {
  return {{"smoke", R"(description = "tiny"
iterations = 60
methods = ["2dgs", "glint/no-trans"]
seeds = [0, 1]
scenes = ["room_1", { scene = "room_2", folder = "data/x", max_pixels = 1e4 }]
[defaults]
dataset = "glassroom"
width = 64
[overrides.2dgs]
lambda_ssim = 0.2
[mesh]
voxel = 0.05
[mesh_metrics]
num_samples = 1000
)"}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"records", read_lines, line_seeds})
GLINT_REGISTER(FuzzTarget, {"record_tables", show_lines, line_seeds})
GLINT_REGISTER(FuzzTarget, {"run_folder", read_run, run_seeds})
GLINT_REGISTER(FuzzTarget, {"profile", read_profile, profile_seeds})

}  // namespace glint::fuzz

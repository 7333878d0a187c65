// SPDX-License-Identifier: MIT
// The whole way of a parcel: cells are trained on a packed scene, as on a machine that is offline
// and without Open3D; what comes home is merged, meshed and scored there.
#include <catch2/catch.hpp>

#include "glint/core/progress.h"
#include "metrics/fusion/tsdf_volume.h"
#include "metrics/metric.h"
#include "reports/run/parcels/parcel_file.h"
#include "reports/run/parcels/take_parcel.h"
#include "reports/run/records/parcel_run.h"
#include "reports/run/records/stage_files.h"
#include "tests/reports/run_words.h"

using namespace glint;
using test::run;

namespace {

using Words = std::vector<std::string>;

constexpr const char* kProfile =
    "iterations = 40\nmethods = [\"2dgs\", \"glint\"]\ntiming_frames = 1\ntiming_warmup = 0\n"
    "[mesh]\nvoxel = 0.05\n[mesh_metrics]\nnum_samples = 20000\n";
constexpr const char* kRoom =
    "[[scenes]]\nscene = \"room_1\"\nwidth = 64\nheight = 36\nviews = 16\nspp = 4\n";

// A stage's file with another document or note; its key.
std::string edit_stage(Parcel& parcel, Stage stage, const std::function<void(Json&)>& edit) {
  std::string& text = parcel.files.at(fmt::format("keys/{}.json", stage_name(stage)));
  Json json = Json::parse(text);
  edit(json);
  json["key"] = stage_key(json["made_from"]);
  text = json.dump();
  return json["key"];
}

void set_record(Parcel& parcel) {
  parcel.files[kRecordFile] = record_to_json(parcel.record).dump() + "\n";
}

// As a machine without Open3D would have it: no mesh, and a word about that.
void take_meshes_out(const fs::path& path) {
  Parcel parcel = read_parcel(path);
  for (const Metric& metric : mesh_metric_list()) {
    parcel.record.metrics.erase(metric.id);
    parcel.record.not_measured[metric.id] = "no Open3D";
    std::erase(parcel.record.not_applicable, metric.id);
  }
  const std::string mesh = edit_stage(parcel, Stage::kMesh, [](Json& json) {
    json["files"] = json["sha256"] = Json::object();
    json["note"] = "no Open3D";
    json["made_from"]["machine"]["Open3D"] = "missing";
  });
  parcel.record.score_key = edit_stage(parcel, Stage::kScore, [&](Json& json) {
    json["made_from"]["inputs"]["mesh"] = mesh;
  });
  set_record(parcel);
  write_parcel(path, parcel);
}

// Two machines, made once: `home` has the room and has run the profile itself, in out/; `away` has
// the packed room, and parcels.
class Machines {
 public:
  static const Machines& get() {
    static const Machines machines;
    return machines;
  }
  fs::path home() const { return folder_ / "home"; }
  fs::path away() const { return folder_ / "away"; }
  fs::path profile() const { return home() / "tiny.toml"; }

  // merge into home/NAME/tiny; its exit code.
  int merge(const std::string& name, Words from, std::string* text = nullptr) const {
    from.insert(from.begin(), "merge");
    add(from, home(), name);
    int code = -1;
    const std::string printed = test::captured(1, [&] { code = run(from); });
    if (text) *text = printed;
    return code;
  }

 private:
  Machines() {
    set_quiet(true);
    write_file(profile(), std::string(kProfile) + kRoom);
    write_file(
        away() / "tiny.toml",
        std::string(kProfile) +
            "[[scenes]]\nscene = \"room_1\"\nfolder = \"room_1.safetensors\"\n"
            "dataset = \"glassroom\"\n"
    );
    Words own = {"all", "--executor", "inline"};
    add(own, home(), "out");
    printed_ = test::captured(1, [&] { code_ = run(own); });
    REQUIRE(code_ == 0);
    pack();
    Words there = {"all", "--no-tables", "--executor", "inline", "--parcels", away() / "parcels"};
    add(there, away(), "out");
    REQUIRE(run(there) == 0);
    for (const char* method : {"2dgs", "glint"})
      take_meshes_out(away() / "parcels" / parcel_name({"room_1", method, 0}));
  }

  static void add(Words& words, const fs::path& machine, const std::string& out) {
    for (const auto& [option, value] :
         {std::pair("--profile", machine / "tiny.toml"),
          std::pair("--out", machine / out),
          std::pair("--data", machine / "data")})
      words.insert(words.end(), {option, value.string()});
    words.insert(words.end(), {"--device", "cpu", "--quiet"});
  }

  void pack() const {
    for (const auto& entry : fs::directory_iterator(home() / "data/glassroom")) {
      if (!entry.is_directory() || entry.path().filename().string().starts_with(".")) continue;
      const fs::path to = away() / "data/room_1.safetensors";
      fs::create_directories(to.parent_path());
      test::captured(1, [&] {
        REQUIRE(run({"dataset", "pack", entry.path(), to, "--test-truth-only", "--quiet"}) == 0);
      });
    }
  }

  test::TempFolder folder_;
  std::string printed_;
  int code_ = -1;
};

Record record_in(const fs::path& out, const std::string& method) {
  const auto records = read_records(out / "tiny/records.jsonl");
  const Record* record = find_record(records, {"room_1", method, 0});
  REQUIRE(record);
  return *record;
}

int verdict_of(const Words& words) {
  int code = -1;
  test::captured(2, [&] { test::captured(1, [&] { code = run(words); }); });
  return code;
}

}  // namespace

TEST_CASE("meshes of a merged parcel score what the run's own meshes would") {
  const Machines& machines = Machines::get();
  REQUIRE(has_tsdf_volume());
  std::string text;
  REQUIRE(machines.merge("whole", {machines.away() / "parcels"}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("2 taken"));
  CHECK_THAT(text, Catch::Contains("meshed"));
  for (const char* method : {"2dgs", "glint"}) {
    INFO(method);
    const Record own = record_in(machines.home() / "out", method),
                 merged = record_in(machines.home() / "whole", method);
    CHECK(merged.metrics.at("psnr") == own.metrics.at("psnr"));  // the same training
    for (const char* id : {"mesh-cd", "mesh-f1@5cm", "behind-mesh-cd", "behind-mesh-f1@5cm"}) {
      INFO(id);
      REQUIRE(own.metrics.contains(id));
      CHECK(merged.metrics.at(id) == Approx(own.metrics.at(id)).epsilon(0.01).margin(0.002));
    }
    CHECK(merged.metrics.size() == own.metrics.size());
    CHECK(merged.not_measured == own.not_measured);
    CHECK(merged.not_applicable == own.not_applicable);
    CHECK(merged.timings.contains("mesh"));
    CHECK(merged.meshes_made.contains("git_revision"));
    CHECK(merged.meshes_made["score_key"] != merged.score_key);
    CHECK_THAT(merged.notes.back(), Catch::StartsWith("meshes: fused on another machine"));
  }
}

TEST_CASE("merging again changes nothing; other scores are a conflict") {
  const Machines& machines = Machines::get();
  const fs::path records = machines.home() / "again/tiny/records.jsonl";
  REQUIRE(machines.merge("again", {machines.away() / "parcels"}) == 0);
  const std::string before = read_file(records);
  std::string text;
  CHECK(machines.merge("again", {machines.away() / "parcels"}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("2 replicate"));
  CHECK(read_file(records) == before);

  // Another parcel of the same training is a replicate, of another score a conflict.
  const test::TempFolder folder;
  const std::string name = parcel_name({"room_1", "2dgs", 0});
  Parcel parcel = read_parcel(machines.away() / "parcels" / name);
  parcel.files["log.jsonl"] = "";
  write_parcel(folder / name, parcel);
  CHECK(machines.merge("again", {folder / name}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("1 replicate"));
  parcel.record.metrics["psnr"] = 50;
  set_record(parcel);
  write_parcel(folder / name, parcel);
  CHECK(machines.merge("again", {folder / name}, &text) == 4);
  CHECK_THAT(text, Catch::Contains("psnr"));
  CHECK(read_file(records) == before);
}

TEST_CASE("asked only, merge says what it would do") {
  const Machines& machines = Machines::get();
  std::string text;
  CHECK(machines.merge("asked", {"--dry-run", machines.away() / "parcels"}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("2 taken"));
  CHECK_THAT(text, Catch::Contains("would be meshed"));
  CHECK(!fs::exists(machines.home() / "asked/tiny/records.jsonl"));
}

TEST_CASE("a run that came in a parcel is meshed and verified, but neither rendered nor scored") {
  const Machines& machines = Machines::get();
  REQUIRE(machines.merge("looked", {machines.away() / "parcels"}) == 0);
  const fs::path cell = machines.home() / "looked/tiny/runs/room_1/glint/0";
  CHECK(fs::exists(cell / "interface.ply"));
  CHECK(fs::exists(cell / "mesh_transmission.ply"));
  const Json parcel = *parcel_of_run(cell);
  CHECK(parcel["colours"] == false);
  CHECK(parcel["meshes"].is_object());
  CHECK(parcel["depth_error_m"].get<double>() <= kDepthLimit);
  std::size_t pictures = 0;
  for (const auto& view : fs::directory_iterator(cell / "renders"))
    pictures += fs::exists(view.path() / "rgb.png");
  CHECK(pictures >= 1);

  for (const char* verb : {"render", "eval"}) {
    INFO(verb);
    int code = -1;
    const std::string message = test::captured(2, [&] {
      code = run({verb, "--run", cell, "--quiet", "--device", "cpu"});
    });
    CHECK(code == 2);
    CHECK_THAT(message, Catch::Contains("the run came in a parcel"));
  }
  CHECK(verdict_of({"verify", cell, "--quiet"}) == 0);
  const Words folder = {"--profile", machines.profile(), "--out", machines.home() / "looked"};
  for (const char* verb : {"table", "report"}) {
    INFO(verb);
    Words words = {verb, "--quiet"};
    words.insert(words.end(), folder.begin(), folder.end());
    CHECK(verdict_of(words) == 0);
  }
  CHECK(verdict_of({"mesh", "--run", cell, "--voxel", "0.1", "--quiet", "--device", "cpu"}) == 0);
}

TEST_CASE("scores of another scene are not made; they are once the scene is there") {
  const Machines& machines = Machines::get();
  const test::TempFolder folder;
  const std::string name = parcel_name({"room_1", "2dgs", 0});
  Parcel parcel = read_parcel(machines.away() / "parcels" / name);
  parcel.record.dataset_hash = "other";
  set_record(parcel);
  write_parcel(folder / name, parcel);
  std::string text;
  CHECK(machines.merge("other", {folder / name}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("no meshes"));
  CHECK_THAT(text, Catch::Contains("is not what it was trained on"));
  Record record = record_in(machines.home() / "other", "2dgs");
  CHECK(record.not_measured.at("mesh-cd") == "no Open3D");
  record.dataset_hash = parcel.record.dataset_hash =
      record_in(machines.home() / "out", "2dgs").dataset_hash;
  append_record(machines.home() / "other/tiny/records.jsonl", record);
  CHECK(machines.merge("other", {}, &text) == 0);
  CHECK_THAT(text, Catch::Contains("meshed"));
  CHECK(record_in(machines.home() / "other", "2dgs").metrics.contains("mesh-cd"));
}

TEST_CASE("a parcel that came damaged is named, the others are taken, and the exit code is 5") {
  const Machines& machines = Machines::get();
  const test::TempFolder folder;
  fs::copy(machines.away() / "parcels", folder.path());
  const fs::path damaged = folder / parcel_name({"room_1", "2dgs", 0});
  const std::string bytes = read_file(damaged);
  write_file(damaged, bytes.substr(0, bytes.size() / 2));
  std::string text;
  test::captured(2, [&] { CHECK(machines.merge("damaged", {folder.path()}, &text) == 5); });
  CHECK_THAT(text, Catch::Contains("1 taken"));
  CHECK_THAT(text, Catch::Contains("lost"));
  CHECK(!fs::exists(machines.home() / "damaged/tiny/runs/room_1/2dgs"));
}

TEST_CASE("a cell that failed sends a parcel, too") {
  const Machines& machines = Machines::get();
  const test::TempFolder folder;
  Words words = {"all", "--no-tables", "--executor", "inline", "--methods", "2dgs"};
  for (const auto& [option, value] :
       {std::pair("--profile", machines.away() / "tiny.toml"),
        std::pair("--data", folder / "nowhere"),
        std::pair("--out", folder / "out"),
        std::pair("--parcels", folder / "parcels")})
    words.insert(words.end(), {option, value.string()});
  words.insert(words.end(), {"--device", "cpu", "--quiet"});
  CHECK(verdict_of(words) == 5);
  const Parcel parcel = read_parcel(folder / "parcels" / parcel_name({"room_1", "2dgs", 0}));
  CHECK(!parcel.record.ok());
  CHECK(parcel.model.files.empty());
  CHECK(machines.merge("failed", {folder / "parcels"}) == 0);
  CHECK(!record_in(machines.home() / "failed", "2dgs").ok());
}

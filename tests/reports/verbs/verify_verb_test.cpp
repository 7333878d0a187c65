// SPDX-License-Identifier: MIT
// `verify` finds nothing on an untouched run, and each thing that was changed since.
#include <catch2/catch.hpp>

#include "glint/core/file_lock.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "reports/run/records/stage_files.h"
#include "tests/reports/tiny_store.h"
#include "tests/support/small_room.h"

using namespace glint;
using test::run;

namespace {

struct Store : test::TinyStore {
  // What verify says of the run, and its exit code.
  struct Answer {
    int code = 0;
    Json runs;

    // "render files: renders/... has other bytes" of what does not match.
    std::vector<std::string> bad() const {
      std::vector<std::string> lines;
      for (const Json& one : runs)
        for (const Json& row : one["checks"])
          if (row["verdict"] == "BAD")
            lines.push_back(
                row["check"].get<std::string>() + ": " + row["detail"].get<std::string>()
            );
      return lines;
    }
    std::string verdict_of(const std::string& check) const {
      for (const Json& row : runs.at(0)["checks"])
        if (row["check"] == check) return row["verdict"];
      return "";
    }
  };
  Answer verify(std::vector<std::string> words) const {
    words.insert(words.begin(), "verify");
    words.insert(words.end(), {"--json", "--quiet"});
    Answer answer;
    const std::string text = test::captured(1, [&] { answer.code = run(words); });
    if (const Json json = parse_json(text); json.is_object()) answer.runs = json["runs"];
    return answer;
  }
  Answer verify_cell() const { return verify({cell().string()}); }
  // Where metrics are not what it is about.
  Answer verify_files() const { return verify({cell().string(), "--fast"}); }
};

bool has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
    return line.find(text) != std::string::npos;
  });
}

fs::path first_render(const Store& store) {
  for (const auto& entry : fs::directory_iterator(store.cell() / "renders"))
    if (entry.is_directory()) return entry.path();
  return {};
}

}  // namespace

TEST_CASE("an untouched run matches, alone and with its profile") {
  const Store store;
  const Store::Answer alone = store.verify_cell();
  CHECK(alone.bad().empty());
  CHECK(alone.code == 0);
  CHECK(alone.verdict_of("metrics") == "ok");
  CHECK(alone.verdict_of("train now") == "ok");
  const Store::Answer all = store.verify({store.profile().string()});
  CHECK(all.code == 0);
  CHECK(all.runs.size() == 1);
  CHECK(store.verify({"--fast", store.cell().string()}).verdict_of("metrics") == "note");
}

TEST_CASE("a render that was edited is found by its hash and by its metrics") {
  const Store store;
  const fs::path file = first_render(store) / "rgb.exr";
  Image image = read_image(file, 3);
  for (std::size_t i = 0; i < image.num_pixels() * 3; ++i) image.data()[i] *= 0.5f;
  write_exr(file, image);
  const Store::Answer answer = store.verify_cell();
  CHECK(answer.code == 4);
  CHECK(has(answer.bad(), "render files: renders/"));
  CHECK(has(answer.bad(), "psnr"));
  CHECK(store.verify({store.cell().string(), "--fast"}).code == 4);
}

TEST_CASE("a map that was added is found") {
  const Store store;
  const fs::path render = first_render(store);
  fs::copy_file(render / "depth.exr", render / "specularity.exr");
  write_file(render / "notes.txt", "not ours");
  const Store::Answer answer = store.verify_files();
  CHECK(answer.code == 4);
  CHECK(has(answer.bad(), "specularity.exr was added"));
  CHECK_FALSE(has(answer.bad(), "notes.txt"));
}

TEST_CASE("a model that is missing is found") {
  const Store store;
  fs::remove(store.cell() / "interface.ply");
  CHECK(has(store.verify_files().bad(), "train files: interface.ply is missing"));
}

TEST_CASE("a record that was edited is found") {
  const Store store;
  Json record = parse_json(read_file(store.profile() / "records.jsonl"));
  REQUIRE(record.is_object());
  record["metrics"]["psnr"] = 60.5;
  write_file(store.profile() / "records.jsonl", record.dump() + "\n");
  const Store::Answer answer = store.verify_files();
  CHECK(answer.code == 4);
  REQUIRE(answer.bad().size() == 1);
  CHECK(has(answer.bad(), "record: psnr 60.5, metrics.json has"));
}

TEST_CASE("a record of another training is found") {
  const Store store;
  Json record = parse_json(read_file(store.profile() / "records.jsonl"));
  record["train_key"] = "0123";
  write_file(store.profile() / "records.jsonl", record.dump() + "\n");
  CHECK(has(store.verify_files().bad(), "record: train_key 0123, the run's is"));
}

TEST_CASE("the record beside a run's files that was edited is found, with records.jsonl or without"
) {
  const Store store;
  const fs::path file = store.cell() / "record.json";
  CHECK(store.verify_files().verdict_of("record.json") == "ok");
  Store::edit_json(file, [](Json& json) {
    json["metrics"]["psnr"] = 99;
    json["environment"]["cpu"] = "another";
  });
  const Store::Answer answer = store.verify_files();
  CHECK(answer.code == 4);
  REQUIRE(answer.bad().size() == 1);
  CHECK(has(answer.bad(), "record.json: psnr 99.0, metrics.json has"));
  CHECK(has(answer.bad(), "environment/cpu \"another\", records.jsonl has"));
  fs::remove(store.profile() / "records.jsonl");
  CHECK(has(store.verify_files().bad(), "record.json: psnr 99.0, metrics.json has"));
  write_file(file, "{}");
  CHECK(has(store.verify_files().bad(), "record.json: "));
}

TEST_CASE("numbers that were edited are computed again") {
  const Store store;
  Store::edit_json(store.cell() / "metrics.json", [](Json& json) {
    json["views"][0]["metrics"]["psnr"] = 99;
    json["metrics"]["train-minutes"] = 0.001;
  });
  const auto bad = store.verify_cell().bad();
  CHECK(has(bad, "score files: metrics.json"));
  CHECK(has(bad, "psnr 99, now"));
  CHECK(has(bad, "cost: train-minutes 0.001"));
}

TEST_CASE("a key's document that was edited is found, and so is one that was signed anew") {
  const Store store;
  const fs::path file = store.cell() / "keys/train.json";
  const std::string before = read_file(file);
  Store::edit_json(file, [](Json& json) { json["made_from"]["iterations"] = 30000; });
  CHECK(has(store.verify_files().bad(), "train key: keys/train.json: its key"));
  Store::edit_json(file, [](Json& json) { json["key"] = stage_key(json["made_from"]); });
  const auto bad = store.verify_files().bad();
  CHECK(has(bad, "config: iterations 30000 -> 3"));
  CHECK(has(bad, "render key: made from train"));
  CHECK(has(bad, "record: train_key"));
  write_file(file, before);
  CHECK(store.verify_files().code == 0);
}

TEST_CASE("other code is told, and is no failure") {
  const Store store;
  Store::edit_json(store.cell() / "keys/score.json", [](Json& json) {
    json["made_from"]["code"]["metrics/psnr.cpp"] = "other";
    json["key"] = stage_key(json["made_from"]);
  });
  Json record = parse_json(read_file(store.profile() / "records.jsonl"));
  record["score_key"] = read_json_object(store.cell() / "keys/score.json")["key"];
  write_file(store.profile() / "records.jsonl", record.dump() + "\n");
  write_file(store.cell() / "record.json", record.dump() + "\n");
  const Store::Answer answer = store.verify_files();
  CHECK(answer.code == 0);
  CHECK(answer.verdict_of("score now") == "note");
}

TEST_CASE("data that have changed are found, in a room that was made and in a folder") {
  const Store store;
  fs::path picture;
  for (const auto& entry : fs::recursive_directory_iterator(store.room()))
    if (entry.path().extension() == ".png") picture = entry.path();
  std::string bytes = read_file(picture);
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write_file(picture, bytes);
  const Store::Answer answer = store.verify({store.cell().string(), "--fast"});
  CHECK(answer.code == 4);
  CHECK(has(answer.bad(), "data: "));
  CHECK(has(answer.bad(), picture.filename().string() + " has other bytes"));
  CHECK(answer.verdict_of("train now") == "note");  // would be made anew
}

TEST_CASE("a run on a folder of the user's goes by the folder's content") {
  const test::TempFolder folder;
  const fs::path data = folder / "mine", mine = folder / "run";
  fs::copy(test::small_room_folder(), data, fs::copy_options::recursive);
  const auto words = [&](std::vector<std::string> all) {
    all.insert(all.end(), {"--out", folder / "out", "--data", folder / "data", "--quiet"});
    return all;
  };
  const std::string run_name = mine.string();
  REQUIRE(run(words({"train", "--dataset", data, "--run", run_name, "--iterations", "3"})) == 0);
  CHECK(run({"verify", run_name, "--quiet", "--out", folder / "out"}) == 0);  // not run to the end
  REQUIRE(run({"render", "--run", run_name, "--quiet"}) == 0);
  REQUIRE(run(words({"eval", "--run", run_name})) == 0);
  CHECK(run({"verify", run_name, "--quiet", "--out", folder / "out"}) == 0);
  fs::rename(data, folder / "moved");
  CHECK(run({"verify", run_name, "--quiet"}) == 3);
  CHECK(run({"verify", run_name, "--quiet", "--dataset", folder / "moved"}) == 0);
  write_file(folder / "moved/more.txt", "more");
  CHECK(run({"verify", run_name, "--quiet", "--dataset", folder / "moved"}) == 4);
}

TEST_CASE("an import is computed again from its renders") {
  const test::TempFolder folder;
  for (const View& view : test::small_room().test)
    write_png(folder / "theirs/rgb" / (view.name + ".png"), view.rgb);
  const std::string room = test::small_room_folder(), out = folder / "out";
  REQUIRE(
      run(
          {"eval",
           "--predictions",
           folder / "theirs",
           "--dataset",
           room,
           "--method",
           "theirs",
           "--profile",
           "smoke",
           "--out",
           out,
           "--data",
           folder / "data",
           "--quiet"}
      ) == 0
  );
  const fs::path imported = folder / "out/smoke/runs/room_1/theirs/0";
  CHECK(run({"verify", imported, "--quiet"}) == 0);
  const View& view = test::small_room().test.front();
  write_png(imported / "renders" / view.name / "rgb.png", test::small_room().test.back().rgb);
  CHECK(run({"verify", imported, "--quiet"}) == 4);
}

TEST_CASE("values without a run are found; what is no run is refused") {
  const Store store;
  fs::remove_all(store.cell());
  const Store::Answer answer = store.verify({store.profile().string()});
  CHECK(answer.code == 4);
  CHECK(has(answer.bad(), "no run folder"));
  CHECK(run({"verify", store.cell().string(), "--quiet"}) == 2);
  const test::TempFolder empty;
  CHECK(run({"verify", empty.path().string(), "--quiet"}) == 2);
}

TEST_CASE("a run at which another process is at work is left alone") {
  const Store store;
  const auto lock = FileLock::take(FileLock::file_beside(store.cell()));
  REQUIRE(std::holds_alternative<FileLock>(lock));
  CHECK(run({"verify", store.cell().string(), "--quiet"}) == 1);
  const Store::Answer answer = store.verify({store.profile().string()});
  CHECK(answer.code == 0);
  CHECK(answer.verdict_of("run") == "note");
}

TEST_CASE("rooms of a store that has moved are found below --data") {
  const Store store;
  Store::edit_json(store.cell() / "config.json", [&](Json& json) {
    json["dataset_folder"] = "/elsewhere/glassroom/" + store.room().filename().string();
  });
  CHECK(store.verify({store.cell().string(), "--fast"}).code == 3);
  const std::string data = store.room().parent_path().parent_path();
  CHECK(store.verify({store.cell().string(), "--fast", "--data", data}).code == 0);
  CHECK(run({"verify", store.profile().string(), "--dataset", data, "--quiet"}) == 1);
}

// SPDX-License-Identifier: MIT
// A pipe or a device in the place of a file that a verb reads is neither waited for nor read
// without end: the verb names it.
#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

#include "glint/core/file_lock.h"
#include "glint/train/checkpoint.h"
#include "tests/reports/tiny_store.h"

using namespace glint;

namespace {

// SIGALRM ends the test program: a verb that waits for ever is a failure, and no test that hangs.
class Alarm {
 public:
  Alarm() { ::alarm(240); }
  ~Alarm() { ::alarm(0); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;
};

enum class Odd { kPipe, kDevice };

void put(Odd kind, const fs::path& file) {
  fs::remove_all(file);
  fs::create_directories(file.parent_path());
  if (kind == Odd::kDevice) return fs::create_symlink("/dev/zero", file);
  REQUIRE(::mkfifo(file.c_str(), 0600) == 0);
}

struct Reader {
  fs::path file;                   // below the store's folder
  std::vector<std::string> words;  // "RUN", "OUT", "PROFILE", "FILE" stand for paths
  int code;                        // 0: the verb goes on without, and says so
};

constexpr const char* kRun = "out/tiny/runs/room_1/2dgs/0";

fs::path in_run(const std::string& name) { return fs::path(kRun) / name; }

const std::vector<Reader>& readers() {
  const std::vector<std::string> status{"status", "--profile", "PROFILE", "--out", "OUT"},
      report{"report", "--profile", "PROFILE", "--out", "OUT"}, render{"render", "--run", "RUN"},
      eval{"eval", "--run", "RUN"}, verify{"verify", "RUN", "--fast"};
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  const std::vector<std::string> all =
      with({"all", "--executor", "inline"}, {"--profile", "PROFILE", "--out", "OUT"});
  const std::vector<std::string> merge{"merge", "FILE", "--profile", "smoke", "--out", "OUT"};
  static const std::vector<Reader> table = {
      {"out/tiny/records.jsonl", status, 2},
      {"out/tiny/records.jsonl", report, 2},
      {"out/tiny/records.jsonl", all, 2},
      {"out/tiny/records.jsonl", {"table", "--profile", "PROFILE", "--out", "OUT"}, 2},
      {"out/tiny/records.jsonl", {"compare", "FILE", "FILE"}, 2},
      {in_run("config.json"), render, 2},
      {in_run("config.json"), eval, 2},
      {in_run("config.json"), verify, 2},
      {in_run("config.json"), report, 0},
      {in_run("keys/train.json"), verify, 4},
      {in_run("keys/train.json"), status, 0},
      {in_run("keys/score.json"), verify, 4},
      {in_run("keys/mesh.json"), status, 0},
      {in_run("record.json"), verify, 4},
      {in_run("metrics.json"), verify, 4},
      {in_run("metrics.json"), eval, 2},
      {in_run("metrics.json"), report, 0},
      {in_run("env.json"), eval, 2},
      {in_run("env.json"), verify, 4},
      {in_run("log.jsonl"), report, 0},
      {in_run("log.jsonl"), {"figures", "--runs", "RUN", "--out", "OUT"}, 2},
      {in_run("interface.ply"), render, 2},
      {in_run("interface.ply"), verify, 4},
      {in_run("mesh.ply"), report, 0},
      {in_run("renders/0000/rgb.exr"), eval, 2},
      {in_run("renders/0000/depth.exr"), report, 0},
      {"cells.txt", with(all, {"--tasks", "FILE"}), 1},
      {"cells.txt", with(all, {"--cells", "FILE"}), 1},
      {"mine.toml", {"status", "--profile", "FILE", "--out", "OUT"}, 1},
      {"path.json", with(render, {"--path", "FILE"}), 1},
      {"a.parcel", merge, 2},
      {"parcels.tar", merge, 2},
      {"parcels/a.parcel", {"merge", "FOLDER", "--profile", "smoke", "--out", "OUT"}, 5},
  };
  return table;
}

struct Said {
  int code;
  std::string text;
};

Said run_on(const test::TinyStore& store, const Reader& reader) {
  const auto path_of = [&](const std::string& word) -> std::string {
    if (word == "RUN") return store.cell();
    if (word == "OUT") return store.path() / "out";
    if (word == "PROFILE") return store.profile_file();
    if (word == "FILE") return store.path() / reader.file;
    if (word == "FOLDER") return (store.path() / reader.file).parent_path();
    return word;
  };
  std::vector<std::string> words;
  for (const std::string& word : reader.words) words.push_back(path_of(word));
  Said said{};
  std::string out;
  const Alarm alarm;
  const std::string errors =
      test::captured(2, [&] { out = test::captured(1, [&] { said.code = test::run(words); }); });
  said.text = errors + out;
  return said;
}

}  // namespace

TEST_CASE("a pipe or a device in the place of a file is named, and nothing hangs") {
  for (const Reader& reader : readers())
    for (const Odd kind : {Odd::kPipe, Odd::kDevice}) {
      const test::TinyStore store;
      put(kind, store.path() / reader.file);
      const Said said = run_on(store, reader);
      INFO(reader.words.front() << " on " << reader.file << ": " << said.text);
      CHECK(said.code == reader.code);
      CHECK_THAT(said.text, Catch::Contains(reader.file.filename().string()));
      CHECK_THAT(said.text, Catch::Contains(kind == Odd::kPipe ? "is a pipe" : "is a device"));
    }
}

TEST_CASE("a checkpoint that is a pipe is named, and --force begins without it") {
  const test::TinyStore store;
  const fs::path mine = store.path() / "mine";
  const auto train = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "train", "--dataset", store.room(), "--run", mine, "--iterations", "3", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--out", store.path() / "out", "--data", store.path() / "data"});
    const Alarm alarm;
    return test::run(words);
  };
  REQUIRE(train({}) == 0);
  put(Odd::kPipe, mine / kCheckpointFile);
  const std::string said = test::captured(2, [&] { CHECK(train({}) == 3); });
  CHECK_THAT(said, Catch::Contains("state.safetensors: is a pipe"));
  CHECK(train({"--force"}) == 0);
}

TEST_CASE("weights of LPIPS that are a pipe are named") {
  const test::TinyStore store;
  put(Odd::kPipe, store.path() / "weights.safetensors");
  const char* const before = std::getenv("GLINT_LPIPS_WEIGHTS");
  const std::string kept = before ? before : "";
  ::setenv("GLINT_LPIPS_WEIGHTS", (store.path() / "weights.safetensors").c_str(), 1);
  const Said said = run_on(store, {"", {"doctor"}, 0});
  ::setenv("GLINT_LPIPS_WEIGHTS", kept.c_str(), 1);
  CHECK_THAT(said.text, Catch::Contains("weights.safetensors: is a pipe"));
}

// SPDX-License-Identifier: MIT
// Several stores on one page: what stands together, which record of a cell is shown, where a number
// came from, what is refused.
#include "reports/show/board/board_page.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/progress.h"
#include "reports/show/board/board_history.h"
#include "tests/reports/run_words.h"
#include "tests/support/count_of.h"
#include "tests/support/table_parts.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Made {
  std::string scene = "room_1", method = "2dgs", commit = "abc", date = "2026-01-01T00:00:00Z";
  double psnr = 20;
  std::uint64_t seed = 0;
  std::string hash = "data1", resolution = "240x135", imported = {}, key = {};
  int iterations = 3000;
};

Record made(const Made& of) {
  Record record = record_of({of.scene, of.method, of.seed}, {{"psnr", of.psnr}});
  record.dataset_hash = of.hash;
  record.resolution = of.resolution;
  record.iterations = of.iterations;
  record.imported = of.imported;
  record.train_key = of.key.empty() ? "t" + of.commit : of.key;
  record.score_key = "s";
  record.environment = {
      {"git_revision", of.commit}, {"date", of.date}, {"device", "cpu"}, {"cpu", "a processor"}};
  return record;
}

struct Stores {
  TempFolder folder;
  std::vector<std::string> paths;

  void add(const std::string& name, const std::vector<Made>& records) {
    const fs::path store = folder.path() / name;
    for (const Made& of : records) append_record(store / "records.jsonl", made(of));
    paths.push_back(store.string());
  }
  Board board() const { return make_board(paths); }
};

double shown_psnr(const BoardGroup& group) {
  return cell_of(board_table(group), "2dgs", "psnr").value;
}

}  // namespace

TEST_CASE("stores are named by as little of their paths as tells them apart") {
  CHECK(
      store_names({"/a/b/one", "/a/b/two/ci", "/a/b/three.jsonl"}) ==
      std::vector<std::string>{"one", "ci", "three"}
  );
  CHECK(store_names({"/a/x/ci", "/a/y/ci"}) == std::vector<std::string>{"x/ci", "y/ci"});
  CHECK(store_names({"/a/b/one/records.jsonl"}) == std::vector<std::string>{"one"});
  CHECK(store_names({"/a/b", "/a/b/c"}) == std::vector<std::string>{"b", "c"});
}

TEST_CASE("methods of two stores stand in one table where data, size and steps are the same") {
  Stores stores;
  stores.add("one", {{.psnr = 20}, {.scene = "room_2", .psnr = 22, .hash = "data2"}});
  stores.add("two", {{.method = "glint", .psnr = 30}});
  const Board board = stores.board();
  REQUIRE(board.groups.size() == 1);
  CHECK(board.groups[0].title() == "glassroom at 240x135, 3000 steps");
  CHECK(board.groups[0].hashes.size() == 2);
  CHECK(board.contradictions.empty());
  const std::string page = board_html(board);
  CHECK_THAT(page, Contains("two, commit abc, a processor, 2026-01-01, room_1 (1 records)"));
}

TEST_CASE("other data, sizes and steps stand apart, and are never averaged together") {
  for (const Made& other : std::vector<Made>{
           {.psnr = 40, .hash = "other"},
           {.psnr = 40, .resolution = "480x270"},
           {.psnr = 40, .iterations = 30000}}) {
    Stores stores;
    stores.add("one", {{.psnr = 20}});
    stores.add("two", {other});
    const Board board = stores.board();
    REQUIRE(board.groups.size() == 2);
    CHECK(shown_psnr(board.groups[0]) == 20);
    CHECK(shown_psnr(board.groups[1]) == 40);
    CHECK(board.groups[0].title() != board.groups[1].title());
    CHECK(board.contradictions.empty());
  }
}

TEST_CASE("a store whose data differ in one scene keeps its other scenes where they fit") {
  Stores stores;
  stores.add("one", {{.hash = "a"}, {.scene = "room_2", .hash = "b"}});
  stores.add(
      "two",
      {{.method = "glint", .hash = "other"},
       {.scene = "room_3", .method = "glint", .hash = "c"},
       {.scene = "room_2", .method = "glint", .hash = "b"}}
  );
  const Board board = stores.board();
  REQUIRE(board.groups.size() == 2);
  CHECK(board.groups[0].hashes.at("room_2") == "b");
  CHECK(board.groups[1].hashes.at("room_1") == "other");
  CHECK(board.groups[1].hashes.at("room_3") == "c");  // beside its own store's
}

TEST_CASE("renders of others stand in every group of their data") {
  Stores stores;
  stores.add("one", {{.iterations = 3000}, {.key = "long", .iterations = 30000}});
  const Made render{.method = "mine", .imported = "renders", .iterations = 0};
  stores.add("two", {render});
  Board board = stores.board();
  REQUIRE(board.groups.size() == 2);
  for (const BoardGroup& group : board.groups)
    CHECK(cell_of(board_table(group), "mine", "psnr").value == 20);
  stores.paths = {stores.paths[1]};
  board = stores.board();
  REQUIRE(board.groups.size() == 1);
  CHECK_THAT(board.groups[0].title(), Contains("steps not recorded"));
}

TEST_CASE("the newest commit of a cell is shown, and the earlier ones are its history") {
  for (const bool newest_first : {false, true}) {
    Stores stores;
    const Made before{.commit = "old", .psnr = 20};
    const Made after{.commit = "new", .date = "2026-02-01T00:00:00Z", .psnr = 23};
    stores.add("one", {newest_first ? after : before});
    stores.add("two", {newest_first ? before : after});
    const Board board = stores.board();
    REQUIRE(board.groups.size() == 1);
    CHECK(shown_psnr(board.groups[0]) == 23);
    CHECK(board.contradictions.empty());
    const auto history = board_history(board.groups[0], board_table(board.groups[0]));
    REQUIRE(history.size() == 2);
    CHECK(history[0].commit == "old");
    CHECK_FALSE(history[0].values[0].change);
    CHECK(history[1].commit == "new");
    CHECK(*history[1].values[0].change == Approx(3));
    CHECK(history[1].values[0].num_pairs == 1);
    CHECK_THAT(board_html(board), Contains("23.00 (+3.00 over 1)") && Contains("<svg"));
  }
}

TEST_CASE("earlier lines of one store are history, too, over the scenes that both commits have") {
  Stores stores;
  stores.add(
      "one",
      {{.commit = "old", .psnr = 20},
       {.scene = "room_2", .commit = "old", .psnr = 30},
       {.commit = "new", .date = "2026-02-01T00:00:00Z", .psnr = 21}}
  );
  const Board board = stores.board();
  CHECK(board.groups[0].shown.size() == 2);
  const auto history = board_history(board.groups[0], board_table(board.groups[0]));
  REQUIRE(history.size() == 2);
  CHECK_THAT(board_html(board), !Contains("<svg"));  // no two means over all scenes
  CHECK(*history[1].values[0].change == Approx(1));
  CHECK(history[1].values[0].num_pairs == 1);
  CHECK(history[1].values[0].cell.status == CellStatus::kPartial);
}

TEST_CASE("equal scores of two stores are one, other ones by one commit a contradiction") {
  Stores stores;
  stores.add("one", {{.psnr = 20}});
  stores.add("two", {{.psnr = 20}});
  CHECK(stores.board().contradictions.empty());
  stores.add("three", {{.psnr = 25}});
  const Board board = stores.board();
  REQUIRE(board.contradictions.size() == 1);
  CHECK(board.contradictions[0].kept == "one");
  CHECK(board.contradictions[0].other == "three");
  CHECK(board.contradictions[0].why == "psnr 20 and 25");
  CHECK(shown_psnr(board.groups[0]) == 20);
  CHECK_THAT(board_html(board), Contains("contradict each other") && Contains("psnr 20 and 25"));
  CHECK(board_json(board)["contradictions"][0]["left_out"] == "three");
}

TEST_CASE("two renders of one name contradict each other, whenever they were scored") {
  Stores stores;
  stores.add("one", {{.method = "mine", .psnr = 20, .imported = "a", .iterations = 0}});
  stores.add(
      "two", {{.method = "mine", .commit = "new", .psnr = 30, .imported = "b", .iterations = 0}}
  );
  CHECK(stores.board().contradictions.size() == 1);
}

TEST_CASE("the JSON has the values of the page, and where each came from") {
  Stores stores;
  stores.add("one", {{.psnr = 20}});
  stores.add("two", {{.method = "glint", .psnr = 30}});
  const Json json = board_json(stores.board());
  CHECK(json["schema"] == 1);
  CHECK(json["stores"][0]["name"] == "one");
  const Json& group = json["groups"][0];
  CHECK(group["steps"] == 3000);
  CHECK(group["data"]["room_1"] == "data1");
  CHECK(group["sources"]["glint"]["psnr"][0]["store"] == "two");
  CHECK(group["sources"]["glint"]["psnr"][0]["device"] == "a processor");
  CHECK(group["table"]["rows"][1]["cells"]["psnr"]["value"] == 30);
}

TEST_CASE("names with HTML in them stay text on the page") {
  const std::string hostile = "<img src=x onerror=alert(1)>";
  Stores stores;
  stores.add("<b>one", {{.scene = hostile, .method = hostile, .commit = hostile}});
  stores.add("two", {{.scene = hostile, .method = hostile, .commit = hostile, .psnr = 9}});
  const std::string page = board_html(stores.board());
  for (const char* tag : {"<img", "<b>", "<script"}) CHECK(count_of(page, tag) == 0);
  CHECK_THAT(page, Contains("&lt;img src=x"));
}

TEST_CASE("leaderboard writes a folder, exits with 4 on contradictions, and overwrites no stranger"
) {
  set_quiet(true);
  Stores stores;
  stores.add("one", {{.psnr = 20}});
  stores.add("two", {{.psnr = 25}});
  const std::string out = stores.folder / "board", file = stores.paths[0] + "/records.jsonl";
  const auto call = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "leaderboard");
    words.insert(words.end(), {"--out", out, "--quiet", "--json"});
    int code = 0;
    const std::string said = captured(1, [&] { code = run(words); });
    return std::pair(code, said);
  };
  CHECK(call({file}).first == 0);
  const auto [code, said] = call(stores.paths);
  CHECK(code == 4);
  CHECK(Json::parse(said)["contradictions"].size() == 1);
  CHECK(Json::parse(said)["groups"][0] == "glassroom at 240x135, 3000 steps");
  CHECK(Json::parse(read_file(out + "/leaderboard.json"))["stores"].size() == 2);
  CHECK_THAT(read_file(out + "/index.html"), Contains("GLINT Bench: leaderboard"));
  fs::remove(out + "/leaderboard.json");
  write_file(out + "/index.html", "a page of mine");
  CHECK(call({file}).first == 1);
  CHECK(read_file(out + "/index.html") == "a page of mine");
}

TEST_CASE("what is no store is refused, and so is one that is named twice") {
  Stores stores;
  stores.add("one", {{.psnr = 20}});
  const auto refused = [&](ExitCode code, const std::vector<std::string>& paths) {
    return error_of(code, [&] { make_board(paths); });
  };
  write_file(stores.folder / "text.jsonl", "no records\n");
  write_file(stores.folder / "other.jsonl", "{\"a\": 1}\n");
  write_file(stores.folder / "empty.jsonl", "");
  write_file(stores.folder / "torn.jsonl", "{\"scene\": \"room");
  fs::create_directories(stores.folder / "empty");
  for (const char* name : {"nowhere", "empty", "text.jsonl", "empty.jsonl", "torn.jsonl"})
    CHECK_THAT(refused(ExitCode::kBadPrediction, {stores.folder / name}), Contains(name));
  CHECK_THAT(
      refused(ExitCode::kBadPrediction, {stores.folder / "other.jsonl"}), Contains("not a record")
  );
  CHECK_THAT(
      refused(ExitCode::kUsage, {stores.paths[0], stores.paths[0] + "/records.jsonl"}),
      Contains("named twice")
  );
}

// SPDX-License-Identifier: MIT
#include <memory>

#include "glint/core/progress.h"
#include "reports/show/board/board_page.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

std::string contradiction_text(const Contradiction& one) {
  return fmt::format("{}: {} and {}: {}\n", one.cell.text(), one.kept, one.other, one.why);
}

int run_leaderboard(
    const CommonOptions& common, const std::vector<std::string>& stores, const fs::path& folder
) {
  const Board board = make_board(stores);
  const fs::path page = write_board(board, folder);
  std::string text;
  for (const Contradiction& one : board.contradictions) text += contradiction_text(one);
  text += fmt::format("{}: {} groups\n", page.string(), board.groups.size());
  Json json = board_json(board);
  json = {
      {"page", page.string()},
      {"stores", json["stores"]},
      {"groups", Json::array()},
      {"contradictions", json["contradictions"]}};
  for (const BoardGroup& group : board.groups) json["groups"].push_back(group.title());
  print_result(common, json, text);
  return static_cast<int>(
      board.contradictions.empty() ? ExitCode::kSuccess : ExitCode::kCheckFailed
  );
}

void add_leaderboard_verb(CommandLine& line) {
  auto stores = std::make_shared<std::vector<std::string>>();
  auto verb = std::make_shared<CLI::App*>(nullptr);
  *verb = line.add_verb(
      line.app,
      "leaderboard",
      "a page of several stores for any static host; exits with 4 where they contradict each other",
      [&line, stores, verb] {
        const bool out_given = (*verb)->count("--out") > 0;
        return run_leaderboard(line.common, *stores, out_given ? line.common.out : "leaderboard");
      },
      kOutOption | kJsonOption | kQuietOption
  );
  describe_out(**verb, "folder of the page, else leaderboard");
  (*verb)->add_option("stores", *stores, "folders with records.jsonl, or such files")->required();
}

}  // namespace

GLINT_REGISTER(Verb, {"leaderboard", add_leaderboard_verb})

}  // namespace glint

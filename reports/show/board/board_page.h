// SPDX-License-Identifier: MIT
// A leaderboard as a static folder: index.html, which any host serves and file:// opens, and
// leaderboard.json with the same values.
#pragma once

#include "glint/core/config.h"
#include "reports/show/board/board_records.h"

namespace glint {

inline constexpr int kBoardSchema = 1;

std::string board_html(const Board& board);
Json board_json(const Board& board);

// FOLDER/index.html and FOLDER/leaderboard.json; returns the former. Whatever else lies there
// stays. Errors (kUsage): the folder has an index.html of something else; kEnvironment: cannot be
// written.
fs::path write_board(const Board& board, const fs::path& folder);

}  // namespace glint

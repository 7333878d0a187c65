// SPDX-License-Identifier: MIT
// Listings: each value of a row is given once, and comes out as a field of a JSON object or as
// words in a column.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "glint/core/config.h"

namespace glint {

struct Column {
  std::string key;           // in JSON; empty: the column is in text alone
  std::string heading = {};  // in text; where no column has one there is no line of them
  std::string format = {};   // of numbers, as "{:.1f} MB", which stand flush right
};

class Cell {
 public:
  template <class T>
  Cell(const T& value) : value_(value) {}
  // With words of its own for text.
  Cell(Json value, std::string words) : value_(std::move(value)), words_(std::move(words)) {}
  // No field of the object, and blank in text.
  static Cell absent() { return {Json(Json::value_t::discarded), ""}; }

  const Json& value() const { return value_; }
  std::string text(const Column& column) const;  // "-" for null

 private:
  Json value_;
  std::optional<std::string> words_;
};

class Rows {
 public:
  // `data`: keys behind those of the columns, one blank between them, that are in JSON alone.
  explicit Rows(std::vector<Column> columns, std::string_view data = {});

  void add(std::vector<Cell> cells);  // one for each column, then for each key of `data`
  bool empty() const { return rows_.empty(); }

  Json json() const;                                    // an array of objects
  std::vector<std::vector<std::string>> lines() const;  // in words, the headings first
  std::string text(std::size_t width = 0) const;        // as aligned_rows()

 private:
  std::size_t num_shown_;  // of the columns
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

// Rows in columns two spaces apart, flush left but for those that are `right`. A last cell of words
// that does not fit in `width` characters goes on below itself; 0: lines are as long as they are.
std::string aligned_rows(
    const std::vector<std::vector<std::string>>& rows,
    std::size_t width = 0,
    const std::vector<bool>& right = {}
);

// Words in lines of at most `width` characters, where they are no longer.
std::vector<std::string> wrapped(const std::string& text, std::size_t width);

// Blanks on one side, up to `width` characters.
std::string padded(const std::string& text, std::size_t width, bool right = false);

// Characters of a UTF-8 text (not bytes): the width on a terminal of the scripts used here.
std::size_t text_width(std::string_view utf8);
// Of each column.
std::vector<std::size_t> widths_of(const std::vector<std::vector<std::string>>& rows);

}  // namespace glint

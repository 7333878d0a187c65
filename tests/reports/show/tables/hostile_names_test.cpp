// SPDX-License-Identifier: MIT
// Names from files reach people by a terminal, a browser, LaTeX and a spreadsheet, each of which
// obeys something.
#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

#include "reports/show/tables/table_writers.h"

using namespace glint;

namespace {

const std::vector<std::string> kHostile = {
    "\x1b]0;title\x07\x1b[2J",
    "a\rb\xc2\x9b"
    "31m",
    "=HYPERLINK(\"http://x\",\"y\")",
    "@SUM(A1)",
    "</td><script>alert(1)</script>",
    "a\" onmouseover=\"alert(1)",
    "\\input{/etc/passwd}",
    "note\r\\input{x}\n\\input{y}",
    "\\write18{reboot} % & # ~ $x$",
    "| b | <img src=x onerror=alert(1)> [x](javascript:y)"};

// Titles, datasets and notes are such names.
Table hostile_table() {
  std::vector<Record> records = read_records("tests/reports/golden/records.jsonl");
  for (Record& record : records) record.dataset = kHostile[4];
  const auto definitions = table_definitions();
  Table table = build_table(definitions.front(), records);
  for (std::size_t i = 0; i < kHostile.size(); ++i) {
    if (table.rows.size() <= i) table.rows.push_back(table.rows.front());
    table.rows[i].method = table.rows[i].title = kHostile[i];
    table.notes.push_back(kHostile[i]);
  }
  return table;
}

bool holds(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a terminal gets no control character") {
  const std::string text = table_terminal(hostile_table());
  CHECK(holds(text, "\\x1b]0;title"));
  CHECK(std::none_of(text.begin(), text.end(), [](unsigned char c) {
    return (c < 32 && c != '\n' && c != '\t') || c == 127;
  }));
  CHECK(!holds(text, "\xc2\x9b"));
}

TEST_CASE("LaTeX gets no command") {
  const std::string tex = table_latex(hostile_table());
  CHECK(holds(tex, "input\\{/etc/passwd\\}"));
  std::string code;  // without comments; TeX ends a line at either character
  bool comment = false, line_start = true;
  for (const char c : tex) {
    if (line_start) comment = c == '%';
    line_start = c == '\n' || c == '\r';
    if (!comment) code += c;
  }
  for (const char* bad : {"\\input", "\\write", "$x$ "}) CHECK(!holds(code, bad));
}

TEST_CASE("a spreadsheet gets no formula") {
  std::istringstream lines(table_csv(hostile_table()));
  int formulas = 0;
  for (std::string line; std::getline(lines, line);) {
    INFO(line);
    const std::string field = line.substr(line.starts_with('"') ? 1 : 0);
    CHECK(std::string("=+@\t\r").find(field.empty() ? 'x' : field.front()) == std::string::npos);
    formulas += field.starts_with("'=") || field.starts_with("'@");
  }
  CHECK(formulas == 2);
}

TEST_CASE("Markdown gets no cell, no element and no line more") {
  const std::string text = table_markdown(hostile_table());
  for (const char* bad : {"<script", "<img", "\r"}) CHECK(!holds(text, bad));
}

// SPDX-License-Identifier: MIT
#include "glint/core/printable.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("what a terminal would obey is shown, what it prints stays") {
  CHECK(printable("room 1/größe\t日本\n") == "room 1/größe\t日本\n");
  CHECK(printable("a\x1b[2Jb\r\x7f") == "a\\x1b[2Jb\\x0d\\x7f");
  CHECK(
      printable("a\xc2\x9b"
                "2J") == "a\\x9b2J"
  );  // the control sequence introducer in UTF-8
}

TEST_CASE("what a shell would read in a name is quoted") {
  CHECK(shell_word("runs/room_1/layers.mp4") == "runs/room_1/layers.mp4");
  CHECK(shell_word("$(reboot)") == "'$(reboot)'");
  CHECK(shell_word("a b;`c`&\n") == "'a b;`c`&\n'");
  CHECK(shell_word("it's") == "'it'\\''s'");
  CHECK(shell_word("") == "''");
}

TEST_CASE("text that a spreadsheet would run gets an apostrophe, numbers do not") {
  CHECK(csv_field("=HYPERLINK(1)") == "'=HYPERLINK(1)");
  CHECK(csv_field("@SUM(A1)") == "'@SUM(A1)");
  CHECK(csv_field("-1+cmd") == "'-1+cmd");
  CHECK(csv_field("=A,\"B\"") == "\"'=A,\"\"B\"\"\"");
  for (const char* text : {"-0.25", "+3", "-1e-9", "-", "room_1", "", "a=b"})
    CHECK(csv_field(text) == text);
}

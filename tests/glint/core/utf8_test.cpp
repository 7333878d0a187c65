// SPDX-License-Identifier: MIT
#include "glint/core/utf8.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("bytes that are no UTF-8 are shown by their numbers") {
  const std::string good = "größe 日本 \xf0\x9f\x98\x80";
  CHECK(is_utf8(good));
  CHECK(as_utf8(good) == good);
  CHECK(as_utf8("caf\xe9.png") == "caf\\xe9.png");  // Latin-1
  CHECK(as_utf8("stra\xdf\xe4") == "stra\\xdf\\xe4");
  // Alone, cut off, too long a form, a surrogate, beyond the last.
  for (const std::string text :
       {"\xe9", "\xc3", "\xe2\x82", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xff"}) {
    INFO(as_utf8(text));
    CHECK_FALSE(is_utf8(text));
    CHECK(is_utf8(as_utf8(text)));
  }
}

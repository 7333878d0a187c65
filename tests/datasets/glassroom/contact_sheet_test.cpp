// SPDX-License-Identifier: MIT
#include "datasets/glassroom/contact_sheet.h"

#include <catch2/catch.hpp>

using namespace glint;

namespace {

constexpr ImageSize kTile{16, 9};

// The sheet of two views with this depth of the second layer.
ByteImage sheet_of(float first, float second) {
  ContactSheet sheet(2, 2, kTile, 5);
  int view = 0;
  for (const float depth : {first, second}) {
    PathTracerOutput truth;
    truth.radiance = Image(kTile.width, kTile.height, 3, 0.5f);
    truth.maps["depth"] = Image(kTile.width, kTile.height, 1, 2.0f);
    truth.maps["layer_2_depth"] = Image(kTile.width, kTile.height, 1, depth);
    sheet.add(view++, truth, {}, 1);
  }
  return sheet.image();
}

}  // namespace

TEST_CASE("a contact sheet has no row for a map that is zero in all of its views") {
  const int without = sheet_of(0, 0).height(), with = sheet_of(3, 3).height();
  CHECK(with >= without + kTile.height);
  CHECK(sheet_of(0, 3).height() == with);
}

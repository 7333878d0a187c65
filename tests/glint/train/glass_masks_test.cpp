// SPDX-License-Identifier: MIT
#include "glint/train/glass_masks.h"

#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("a view's glass mask is its prior's, else the truth's, else there is none") {
  View view;
  CHECK(glass_mask(view).empty());
  view.truth["glass"] = Image(2, 1, 1, 0.25f);
  CHECK(glass_mask(view).at(0, 0) == 0.25f);
  view.priors["glass"] = Image(2, 1, 1, 0.75f);
  CHECK(glass_mask(view).at(0, 0) == 0.75f);
}

TEST_CASE("a note says where the masks of a run are from") {
  std::vector<View> views(3);
  const auto note = [&] { return glass_mask_note(count_glass_masks(views)); };
  CHECK(note() == "none");
  CHECK(count_glass_masks(views).none());
  for (View& view : views) view.truth["glass"] = Image(1, 1, 1);
  CHECK(note() == "the dataset's ground truth");
  CHECK(count_glass_masks(views).all());
  views[0].priors["glass"] = Image(1, 1, 1);
  views[1].truth["glass"] = {};
  CHECK_FALSE(count_glass_masks(views).all());
  CHECK(
      note() ==
      "the prior folder's for 1, the dataset's ground truth for 1, none for 1 training views"
  );
  for (View& view : views) view.priors["glass"] = Image(1, 1, 1);
  CHECK(note() == "the prior folder's");
}

TEST_CASE("the dark share of glass is of what masks call glass, and of what counts") {
  std::vector<View> views(2);
  CHECK_FALSE(dark_share_of_glass(views, 0.05f));
  views[0].truth["glass"] = Image(4, 1, 1, 1);
  CHECK_FALSE(dark_share_of_glass(views, 0.05f));  // no albedo
  Image albedo(4, 1, 3, 0.3f);
  albedo.at(1, 0, 0) = albedo.at(1, 0, 1) = albedo.at(1, 0, 2) = 0.04f;
  albedo.at(2, 0, 0) = 0.12f, albedo.at(2, 0, 1) = albedo.at(2, 0, 2) = 0.01f;  // mean 0.047
  views[0].priors["albedo"] = albedo;
  CHECK(*dark_share_of_glass(views, 0.05f) == Approx(1.0 / 2));
  views[0].truth["glass"].at(0, 0) = 0;
  CHECK(*dark_share_of_glass(views, 0.05f) == Approx(2.0 / 3));
  views[0].counted = Image(4, 1, 1, 1);
  views[0].counted.at(1, 0) = 0;
  CHECK(*dark_share_of_glass(views, 0.05f) == Approx(1.0 / 2));
}

// SPDX-License-Identifier: MIT
// From a method's maps to the files of a render, and from those to scores.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "glint/scene/image_files.h"
#include "reports/run/bench/evaluate.h"
#include "reports/run/records/run_folder.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr int kWidth = 6, kHeight = 4;

Image grey(float value) { return Image(kWidth, kHeight, 3, value); }
Image map(float value) { return Image(kWidth, kHeight, 1, value); }

// All glass; three quarters of the radiance came through it.
View glass_view() {
  View view;
  view.rgb = grey(0.8f);
  view.truth["glass"] = map(1);
  view.truth["behind_depth"] = map(4.0f);
  view.truth["transmitted"] = grey(3.0f);
  view.truth["reflected"] = grey(1.0f);
  return view;
}

MapSet decomposed() {
  MapSet output;
  output["rgb"] = grey(0.8f);
  output["transparency"] = map(0.9f);
  output["specularity"] = map(0.1f);
  output["behind_depth"] = map(5.0f);
  output["transmitted"] = grey(0.5f);
  output["reflected"] = grey(0.3f);
  output["interface"] = grey(0.2f);
  output["transmission"] = grey(0.7f);
  output["reflection"] = grey(2.0f);
  return output;
}

}  // namespace

TEST_CASE("measured layers are EXR under their names, pictures of a set's radiance PNG") {
  const test::TempFolder folder;
  write_render(folder.path(), decomposed());
  for (const char* name :
       {"rgb", "transparency", "specularity", "behind_depth", "transmitted", "reflected"})
    CHECK(fs::exists(folder / (std::string(name) + ".exr")));
  for (const char* name : {"interface", "transmission", "reflection"}) {
    CHECK(fs::exists(folder / (std::string(name) + ".png")));
    CHECK_FALSE(fs::exists(folder / (std::string(name) + ".exr")));
  }
  CHECK(read_image(folder / "transmitted.exr", 3).at(5, 3, 2) == 0.5f);
  CHECK_FALSE(fs::exists(folder / "depth.exr"));  // not rendered
}

TEST_CASE("a decomposition is scored from its files") {
  const test::TempFolder folder;
  write_render(folder.path(), decomposed());
  const Scores scores = score_view(folder.path(), glass_view());
  CHECK(scores.at("trans-psnr") == Approx(-20 * std::log10(0.1)).epsilon(1e-5));  // truth 0.6
  CHECK(scores.at("refl-psnr") == Approx(-20 * std::log10(0.1)).epsilon(1e-5));   // truth 0.2
  CHECK(scores.at("behind-absrel") == 0.25);
  CHECK(scores.at("transparency-iou") == 1);
}

TEST_CASE("scores of layers that were not rendered are absent") {
  const test::TempFolder folder;
  MapSet output;
  output["rgb"] = grey(0.8f);
  write_render(folder.path(), output);
  const Scores scores = score_view(folder.path(), glass_view());
  CHECK(scores.count("psnr") == 1);
  for (const char* id : {"trans-psnr", "refl-psnr", "behind-absrel", "transparency-iou"})
    CHECK(scores.count(id) == 0);
  const auto ids = not_applicable(scores, {{"trans-psnr", "no reason"}});
  const auto says = [&](const char* id) { return std::count(ids.begin(), ids.end(), id); };
  CHECK(says("transparency-iou") == 1);
  CHECK(says("refl-psnr") == 1);
  CHECK(says("psnr") == 0);
  CHECK(says("trans-psnr") == 0);  // has a reason of its own
}

TEST_CASE("a layer of another size or with two channels is refused by name") {
  const test::TempFolder folder;
  for (const Image& wrong : {Image(kWidth, kHeight + 1, 1), Image(kWidth, kHeight, 2)}) {
    MapSet output = decomposed();
    output["specularity"] = wrong;
    const std::string error =
        test::error_of(ExitCode::kBadPrediction, [&] { write_render(folder.path(), output); });
    CHECK_THAT(error, Catch::Contains("specularity"));
    CHECK_THAT(error, Catch::Contains("expected 6x4x1"));
  }
}

TEST_CASE("a map that no file is for is refused by name") {
  const test::TempFolder folder;
  MapSet output = decomposed();
  output["albedo"] = grey(0.5f);
  CHECK_THAT(
      test::error_of(ExitCode::kBadPrediction, [&] { write_render(folder.path(), output); }),
      Catch::Contains("albedo, for which the table of maps")
  );
}

TEST_CASE("what a render has where pixels do not count moves no score") {
  View view = glass_view();
  view.truth["depth"] = map(2);
  view.truth["glass"].at(5, 3) = 0;
  view.counted = map(1);
  for (int y = 0; y < kHeight; ++y) view.counted.at(0, y) = 0;
  const auto scores_with = [&](float bad) {
    MapSet output = decomposed();
    output["depth"] = map(2.5f);
    output["rgb"].at(3, 2, 1) = 0.1f;  // an error that counts
    output.for_each([&](const MapRow& row, Image& map) {
      for (int y = 0; y < kHeight; ++y)
        for (int c = 0; c < row.channels(); ++c) map.at(0, y, c) = bad;
    });
    const test::TempFolder folder;
    write_render(folder.path(), output);
    return score_view(folder.path(), view);
  };
  const Scores scores = scores_with(0.05f);
  CHECK(scores == scores_with(0.95f));
  const double mse = 0.7 * 0.7 / (3 * (kWidth - 1) * kHeight);
  CHECK(scores.at("psnr") == Approx(-10 * std::log10(mse)).epsilon(1e-5));
  CHECK(scores.at("depth-absrel") == Approx(0.25));
  CHECK(scores.at("psnr@opaque") == 100);
  view.counted = {};
  CHECK(scores.at("psnr") > scores_with(0.05f).at("psnr"));
}

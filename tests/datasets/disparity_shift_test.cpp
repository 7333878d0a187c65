// SPDX-License-Identifier: MIT
#include "datasets/disparity_shift.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/config.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Pairs {
  std::vector<double> disparity, z;
};

// 1 / z = 0.5 (d + 0.3); every `wrong`th depth is something else (0: none).
Pairs made_pairs(std::size_t count, std::size_t wrong) {
  Pairs pairs;
  Rng rng(7);
  for (std::size_t i = 0; i < count; ++i) {
    const auto d = static_cast<double>(rng.uniform(0.05f, 0.95f));
    pairs.disparity.push_back(d);
    pairs.z.push_back(1 / (0.5 * (d + 0.3)));
    if (wrong > 0 && i % wrong == 0) pairs.z.back() = static_cast<double>(rng.uniform(0.5f, 3.5f));
  }
  return pairs;
}

// How far `prior` is from an affine function of `depth`: 1 - r^2.
double unexplained(const Image& prior, const Image& depth) {
  const auto count = static_cast<double>(prior.num_pixels());
  double mp = 0, md = 0, pp = 0, dd = 0, pd = 0;
  for (std::size_t i = 0; i < prior.num_pixels(); ++i) {
    mp += static_cast<double>(prior.data()[i]) / count;
    md += static_cast<double>(depth.data()[i]) / count;
  }
  for (std::size_t i = 0; i < prior.num_pixels(); ++i) {
    const double p = static_cast<double>(prior.data()[i]) - mp;
    const double d = static_cast<double>(depth.data()[i]) - md;
    pp += p * p, dd += d * d, pd += p * d;
  }
  return 1 - pd * pd / (pp * dd);
}

// A room whose stored disparities are 0.8 / z - 0.1, as 32-bit EXR.
struct DisparityRoom : TempFolder {
  std::vector<View> views = box_room_views(12, {96, 72}, 0.5);

  DisparityRoom() {
    write_easyvolcap(path(), views);
    fs::remove_all(path() / "gt");
    fs::remove_all(path() / "diffrens");
    write_file(path() / "scene.json", R"({"prior_folder": "mono", "prior_depth": "disparity"})");
    for (const View& view : views) {
      Image disparity = view.truth["depth"];
      for (float& value : disparity.values()) value = 0.8f / value - 0.1f;
      write_exr(path() / "mono/depth" / (view.name + ".exr"), disparity);
    }
  }
};

}  // namespace

TEST_CASE("scale and shift of a disparity are found, wrong points or not") {
  for (const std::size_t wrong : {0, 6}) {
    const Pairs pairs = made_pairs(300, wrong);
    const auto fit = fit_disparity(pairs.disparity, pairs.z);
    REQUIRE(fit);
    CHECK(fit->scale == Approx(0.5).epsilon(wrong == 0 ? 1e-9 : 0.05));
    CHECK(fit->shift == Approx(0.3).epsilon(wrong == 0 ? 1e-9 : 0.1));
  }
}

TEST_CASE("few pairs, one value, depth in place of disparity and noise fit nothing") {
  const Pairs few = made_pairs(19, 0);
  CHECK_FALSE(fit_disparity(few.disparity, few.z));
  Pairs pairs = made_pairs(200, 0);
  CHECK_FALSE(fit_disparity(std::vector<double>(200, 0.5), pairs.z));
  CHECK_FALSE(fit_disparity(pairs.z, pairs.z));
  Rng rng(3);
  for (double& z : pairs.z) z = static_cast<double>(rng.uniform(1, 2));
  CHECK_FALSE(fit_disparity(pairs.disparity, pairs.z));
}

TEST_CASE("shifted disparities become affine in depth by the points that the views see") {
  const DisparityRoom room;
  const Scene told = load_scene(room.path(), {});
  const auto told_note =
      std::find_if(told.data_notes.begin(), told.data_notes.end(), [](const std::string& note) {
        return note.starts_with("disparity: shift told");
      });
  REQUIRE(told_note != told.data_notes.end());
  fs::remove(room.path() / "sparse/0/points3D.ply");
  const Scene stored = load_scene(room.path(), {});
  const Image& depth = room.views[4].truth["depth"];  // train view 3
  const double with = unexplained(told.train[3].priors["depth"], depth),
               without = unexplained(stored.train[3].priors["depth"], depth);
  INFO(*told_note);
  CHECK(with < 1e-3);
  CHECK(without > 10 * with);
}

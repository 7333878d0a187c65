// SPDX-License-Identifier: MIT
// A pane's place by its outlines.
#include "glint/train/pane_outlines.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"

using namespace glint;

namespace {

// Eyes about the origin look at a dark rectangle of 2 x 1.2 m that is 3 m away.
struct Pane {
  MirrorPlane truth;
  std::vector<OutlinePixel> pixels;

  explicit Pane(double half_width = 1, double half_height = 0.6) {
    truth.center = {0.1, -0.2, 3};
    truth.normal = {0, 0, -1};
    truth.half_width = half_width, truth.half_height = half_height;
    for (const double x : {-2.0, -1.0, 0.0, 1.0, 2.0})
      for (const double y : {-1.0, 0.0, 1.0}) add_eye({x, y, 0});
  }
  // Looks at the middle of the rectangle and about it.
  void add_eye(Vec3d eye) {
    for (double x = -1.8; x <= 1.8; x += 0.04)
      for (double y = -1.5; y <= 1.5; y += 0.04) {
        const Vec3d at = truth.center + Vec3d{x + 0.007 * eye.x, y + 0.011 * eye.y, 0};
        pixels.push_back({eye, (1 / at.z) * (at - eye), truth.normal, truth.holds(at)});
      }
  }
  // As an interface has them whose depth is off by that.
  PlaneOfPoints seen(double off) const {
    PlaneOfPoints fitted{truth, {}};
    fitted.plane.center.z += off;
    for (const OutlinePixel& p : pixels)
      if (p.dark) fitted.points.push_back({p.eye + (3 + off) * p.ray, p.normal, p.eye});
    fit_rectangle(fitted);
    return fitted;
  }
  PaneOutlines outlines() const {
    PaneOutlines result({.tolerance = 0.1});
    for (const OutlinePixel& p : pixels) result.add(p);
    return result;
  }
};

}  // namespace

TEST_CASE("Agreement is the share of what sees a rectangle that is dark and lies so") {
  const Pane pane;
  PaneOutlines outlines = pane.outlines();
  CHECK(outlines.agreement(pane.truth) == 1);
  MirrorPlane wide = pane.truth;
  wide.half_width *= 1.25, wide.half_height *= 1.25;
  CHECK(outlines.agreement(wide) == Approx(1 / (1.25 * 1.25)).epsilon(0.05));
  CHECK(outlines.agreement(pane.truth.turned()) == 0);
  OutlinePixel other = pane.pixels.front();
  other.ray = pane.truth.center - other.eye, other.normal = {1, 0, 0}, other.dark = true;
  PaneOutlines turned;
  turned.add(other);
  CHECK(turned.agreement(pane.truth) == 0);
  CHECK(PaneOutlines().agreement(pane.truth) == 0);
}

TEST_CASE("A pane is placed where outlines agree, whatever depth its surfels have") {
  const Pane pane;
  for (const double off : {-0.13, -0.05, 0.0, 0.08, 0.16}) {
    PlaneOfPoints fitted = pane.seen(off);
    CHECK(pane.outlines().place(fitted) > 0.9);
    CHECK(fitted.plane.center.z == Approx(3).margin(0.011));
    const double wide = std::max(fitted.plane.half_width, fitted.plane.half_height);
    CHECK(wide == Approx(1).margin(0.03));
    CHECK(fitted.plane.half_width * fitted.plane.half_height == Approx(0.6).margin(0.03));
  }
}

TEST_CASE("Outlines tell nothing where views do not see them or what is dark is no rectangle") {
  const Pane wall(9, 9);  // fills all views
  PlaneOfPoints fitted = wall.seen(0.05);
  const double z = fitted.plane.center.z;
  CHECK(wall.outlines().place(fitted) == 0);
  CHECK(fitted.plane.center.z == z);

  Pane spots;
  Rng rng(4);
  for (OutlinePixel& pixel : spots.pixels) pixel.dark = rng.uniform(0, 1) < 0.4f;
  fitted = spots.seen(0);
  CHECK(spots.outlines().place(fitted) == 0);
}

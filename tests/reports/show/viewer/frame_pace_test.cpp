// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "reports/show/viewer/frame_pace.h"

using namespace glint;

namespace {

constexpr ImageSize kWhole{480, 270};

// A page that looks on at a clock of its own.
struct Page {
  FramePace pace;
  ViewerTime now{std::chrono::seconds(100)};

  void pass(double seconds) {
    now +=
        std::chrono::duration_cast<ViewerClock::duration>(std::chrono::duration<double>(seconds));
  }
  FrameKind due() const { return pace.due(now); }
};

}  // namespace

TEST_CASE("nothing is due before somebody looks") {
  Page page;
  CHECK(page.due() == FrameKind::kNone);
  CHECK_FALSE(page.pace.whole_at().has_value());
}

TEST_CASE("a small frame comes at once, a whole one at rest") {
  Page page;
  page.pace.looked(1, page.now);
  CHECK(page.due() == FrameKind::kMoving);
  page.pace.sent(FrameKind::kMoving, 1, {120, 68}, 0.01, page.now);
  CHECK(page.due() == FrameKind::kNone);  // on its way
  page.pace.shown(1);
  CHECK(page.due() == FrameKind::kNone);
  REQUIRE(page.pace.whole_at().has_value());
  page.pass(kRestSeconds + 0.001);
  CHECK(page.due() == FrameKind::kWhole);
  page.pace.sent(FrameKind::kWhole, 1, kWhole, 0.2, page.now);
  page.pace.shown(1);
  page.pass(10);
  CHECK(page.due() == FrameKind::kNone);
}

TEST_CASE("a move takes the place of a whole frame") {
  Page page;
  page.pace.looked(1, page.now);
  page.pace.sent(FrameKind::kMoving, 1, {120, 68}, 0.01, page.now);
  page.pace.shown(1);
  page.pass(kRestSeconds);
  page.pace.looked(2, page.now);
  CHECK(page.due() == FrameKind::kMoving);
}

TEST_CASE("a look that came while a frame was made is due after it") {
  Page page;
  page.pace.looked(1, page.now);
  page.pace.looked(2, page.now);
  page.pace.sent(FrameKind::kMoving, 1, {120, 68}, 0.01, page.now);
  page.pace.shown(1);
  CHECK(page.due() == FrameKind::kMoving);
}

TEST_CASE("a page that has not drawn a frame gets no other") {
  Page page;
  page.pace.looked(1, page.now);
  page.pace.sent(FrameKind::kMoving, 1, {120, 68}, 0.01, page.now);
  for (std::uint64_t serial = 2; serial < 100; ++serial) page.pace.looked(serial, page.now);
  page.pass(60);
  CHECK(page.due() == FrameKind::kNone);
  page.pace.shown(98);  // of none that was sent
  CHECK(page.due() == FrameKind::kNone);
  page.pace.shown(1);
  CHECK(page.due() == FrameKind::kMoving);
}

TEST_CASE("serials that go back are ignored") {
  Page page;
  page.pace.looked(5, page.now);
  page.pace.sent(FrameKind::kMoving, 5, {120, 68}, 0.01, page.now);
  page.pace.shown(5);
  page.pace.looked(4, page.now);
  CHECK(page.due() == FrameKind::kNone);
}

TEST_CASE("small frames have the pixels of a thirtieth of a second") {
  Page page;
  page.pace.looked(1, page.now);
  page.pace.sent(FrameKind::kMoving, 1, {240, 135}, 1.0 / kMovingFps, page.now);
  const ImageSize size = page.pace.moving_size(kWhole);
  CHECK(size.width == 240);
  CHECK(size.height == 135);
  Page slow, fast;
  slow.pace.sent(FrameKind::kMoving, 1, {240, 135}, 10, slow.now);
  CHECK(slow.pace.moving_size(kWhole) == ImageSize{120, 68});  // a quarter at least
  fast.pace.sent(FrameKind::kMoving, 1, {240, 135}, 1e-3, fast.now);
  CHECK(fast.pace.moving_size(kWhole) == kWhole);
}

TEST_CASE("of a training, frames at rest take no more than their share") {
  Page page;
  page.pace.looked(1, page.now);
  page.pace.sent(FrameKind::kMoving, 1, kWhole, 0.1, page.now);
  page.pace.shown(1);
  page.pass(1);
  page.pace.sent(FrameKind::kWhole, 1, kWhole, 0.1, page.now);
  page.pace.shown(1);
  page.pass(1.9);
  page.pace.model_changed(0.05, page.now);
  CHECK(page.due() == FrameKind::kNone);
  page.pass(0.2);
  page.pace.model_changed(0.05, page.now);
  CHECK(page.due() == FrameKind::kWhole);
}

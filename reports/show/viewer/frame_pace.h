// SPDX-License-Identifier: MIT
// Which frame somebody at the viewer is sent next: small ones while the camera moves, a whole one
// when it rests. One frame is on its way at a time, so a slow connection gets fewer, not late ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "glint/core/image.h"

namespace glint {

using ViewerClock = std::chrono::steady_clock;
using ViewerTime = ViewerClock::time_point;

inline constexpr double kMovingFps = 30;     // aimed at
inline constexpr double kRestSeconds = 0.2;  // without a new look: the camera rests
inline constexpr int kMovingQuality = 40, kWholeQuality = 70;  // of JPEG

enum class FrameKind { kNone, kMoving, kWhole };

class FramePace {
 public:
  // A new look, whose serial number is above those before; the first is above 0.
  void looked(std::uint64_t serial, ViewerTime now);
  // The page has drawn the frame of this look; what it says of others is ignored.
  void shown(std::uint64_t serial);
  // What was drawn is of an older model: a whole frame is due again, but not more than `share` of
  // the time goes into those.
  void model_changed(double share, ViewerTime now);

  // While a frame is on its way: none.
  FrameKind due(ViewerTime now) const;
  // When a whole frame is due, unless a look comes before; none: it is not waited for.
  std::optional<ViewerTime> whole_at() const;

  // A frame of this look was made in `seconds` and sent.
  void sent(FrameKind kind, std::uint64_t serial, ImageSize size, double seconds, ViewerTime now);

  // Of a small frame in the shape of a whole one: as many pixels as were made in a thirtieth of a
  // second, a quarter of each side at least.
  ImageSize moving_size(ImageSize whole) const;
  double pixels_per_second() const { return pixels_per_second_; }

 private:
  // Serials of looks: of the last, of what was sent last, of the last whole frame; 0: none.
  std::uint64_t look_ = 0, sent_ = 0, whole_ = 0;
  bool on_its_way_ = false, measured_ = false;
  ViewerTime looked_at_, sent_at_;
  double last_seconds_ = 0;
  double pixels_per_second_ = 1e6;  // a guess until a frame was made
};

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "reports/show/viewer/frame_pace.h"

#include <algorithm>
#include <cmath>

namespace glint {

namespace {

constexpr double kLeastSide = 0.25, kNewShare = 0.5;  // of the last measurement in the mean

double seconds_between(ViewerTime from, ViewerTime to) {
  return std::chrono::duration<double>(to - from).count();
}
ViewerClock::duration rest() {
  return std::chrono::duration_cast<ViewerClock::duration>(
      std::chrono::duration<double>(kRestSeconds)
  );
}

}  // namespace

void FramePace::looked(std::uint64_t serial, ViewerTime now) {
  if (serial <= look_) return;
  look_ = serial;
  looked_at_ = now;
}

void FramePace::shown(std::uint64_t serial) {
  if (serial == sent_) on_its_way_ = false;
}

void FramePace::model_changed(double share, ViewerTime now) {
  if (seconds_between(sent_at_, now) * share >= last_seconds_) whole_ = 0;
}

FrameKind FramePace::due(ViewerTime now) const {
  if (look_ == 0 || on_its_way_) return FrameKind::kNone;
  if (sent_ != look_) return FrameKind::kMoving;
  return whole_ != look_ && now >= looked_at_ + rest() ? FrameKind::kWhole : FrameKind::kNone;
}

std::optional<ViewerTime> FramePace::whole_at() const {
  if (look_ == 0 || on_its_way_ || whole_ == look_) return {};
  return looked_at_ + rest();
}

void FramePace::sent(
    FrameKind kind, std::uint64_t serial, ImageSize size, double seconds, ViewerTime now
) {
  const double rate = static_cast<double>(size.num_pixels()) / std::max(seconds, 1e-6);
  if (kind == FrameKind::kMoving)
    pixels_per_second_ = measured_ ? std::lerp(pixels_per_second_, rate, kNewShare) : rate;
  measured_ = measured_ || kind == FrameKind::kMoving;
  if (kind == FrameKind::kWhole) whole_ = serial;
  sent_ = serial;
  last_seconds_ = seconds;
  sent_at_ = now;
  on_its_way_ = true;
}

ImageSize FramePace::moving_size(ImageSize whole) const {
  const double pixels = static_cast<double>(whole.num_pixels());
  const double side =
      std::clamp(std::sqrt(pixels_per_second_ / kMovingFps / pixels), kLeastSide, 1.0);
  const auto scaled = [&](int n) { return std::max(8, static_cast<int>(std::lround(side * n))); };
  return {std::min(whole.width, scaled(whole.width)), std::min(whole.height, scaled(whole.height))};
}

}  // namespace glint

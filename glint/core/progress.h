// SPDX-License-Identifier: MIT
// Progress of long work on standard error: one line redrawn on a terminal, a plain line every few
// seconds elsewhere. Thread-safe counting. Quiet when `set_quiet(true)`.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace glint {

// A setting of the environment for programs whose standard error reaches a terminal by way of this
// one.
inline constexpr const char* kDrawnProgress = "GLINT_PROGRESS=drawn";

void set_quiet(bool quiet);  // silences progress and log::info; warnings stay

// One line an event on standard error; standard output carries results only.
// Nobody who can read it, or no room, is no reason to stop.
namespace log {
void text(std::string_view text);  // as it is
void info(std::string_view message);
void warn(std::string_view message);
// Warnings go to `sink` instead, which any thread may call; null: to standard error.
void send_warnings_to(void (*sink)(std::string_view message));
}  // namespace log

std::string format_duration(double seconds);  // "1h 02m", "3m 05s", "12.3s"

class Progress {
 public:
  // `title` opens the line; `total` steps make 100 %.
  Progress(std::string title, std::size_t total);
  ~Progress();  // leaves the finished line behind
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Advances by `steps`; `note` (loss, PSNR, ...) is shown behind the time left.
  void advance(std::size_t steps = 1, std::string_view note = {});
  double seconds() const;

 private:
  void draw(std::string_view note, bool last);

  std::string title_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::atomic<bool> drawing_{false};
  std::chrono::steady_clock::time_point start_, last_draw_;
  std::string last_note_;
  bool terminal_;
};

}  // namespace glint

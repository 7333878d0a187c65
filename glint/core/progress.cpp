// SPDX-License-Identifier: MIT
#include "glint/core/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "glint/core/printable.h"

namespace glint {

namespace {

bool quiet = false;
std::atomic<void (*)(std::string_view)> warning_sink{nullptr};

bool reaches_terminal() {
  const std::string setting = kDrawnProgress;
  const std::size_t equals = setting.find('=');
  const char* value = std::getenv(setting.substr(0, equals).c_str());
  return ::isatty(STDERR_FILENO) != 0 || (value != nullptr && setting.substr(equals + 1) == value);
}

}  // namespace

void set_quiet(bool value) { quiet = value; }

namespace log {
void text(std::string_view text) {
  [[maybe_unused]] const auto written = std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}
void info(std::string_view message) {
  if (!quiet) text(fmt::format("{}\n", printable(message)));
}
void warn(std::string_view message) {
  if (const auto sink = warning_sink.load())
    sink(message);
  else
    text(fmt::format("warning: {}\n", printable(message)));
}
void send_warnings_to(void (*sink)(std::string_view message)) { warning_sink = sink; }
}  // namespace log

std::string format_duration(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f}s", seconds);
  const auto whole = static_cast<long>(seconds);
  if (whole < 3600) return fmt::format("{}m {:02}s", whole / 60, whole % 60);
  return fmt::format("{}h {:02}m", whole / 3600, (whole / 60) % 60);
}

Progress::Progress(std::string title, std::size_t total)
    : title_(std::move(title)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      last_draw_(start_),
      terminal_(reaches_terminal()) {}

Progress::~Progress() { draw(last_note_, true); }

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::advance(std::size_t steps, std::string_view note) {
  done_ += steps;
  if (drawing_.exchange(true)) return;  // another thread draws
  const auto now = std::chrono::steady_clock::now();
  if (!note.empty()) last_note_ = note;
  if (now - last_draw_ > std::chrono::milliseconds(terminal_ ? 100 : 10000)) {
    last_draw_ = now;
    draw(last_note_, false);
  }
  drawing_ = false;
}

void Progress::draw(std::string_view note, bool last) {
  if (quiet) return;
  const std::size_t done = done_;
  const double elapsed = seconds();
  const double left =
      done > 0 ? elapsed * static_cast<double>(total_ - done) / static_cast<double>(done) : 0.0;
  const double percent =
      total_ > 0 ? 100.0 * static_cast<double>(done) / static_cast<double>(total_) : 100.0;
  const std::string time = last ? format_duration(elapsed) : format_duration(left) + " left";
  log::text(fmt::format(
      "{}{} {:3.0f}% {}/{} {} {}{}",
      terminal_ ? "\r\x1b[K" : "",
      printable(title_),
      percent,
      done,
      total_,
      time,
      printable(note),
      terminal_ && !last ? "" : "\n"
  ));
}

}  // namespace glint

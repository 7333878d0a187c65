// SPDX-License-Identifier: MIT
#include "reports/run/bench/video.h"

#include <fmt/format.h>

#include "glint/core/left_behind.h"
#include "reports/run/bench/child_process.h"

namespace glint {

namespace {

// ffmpeg reads "-x" as an option, "x:y" as a protocol and % as the number of a frame.
std::string plain_name(const fs::path& file) { return fs::absolute(file).string(); }

std::string frames_name(const fs::path& pattern) {
  std::string name;
  for (const char c : plain_name(pattern).substr(0, plain_name(pattern).rfind('/')))
    name += c == '%' ? std::string("%%") : std::string(1, c);
  return name + "/" + pattern.filename().string();
}

}  // namespace

std::vector<std::string> video_command(const fs::path& pattern, double fps, const fs::path& video) {
  // Players want 4:2:0 colours, hence even sizes, and the index in front.
  return {
      "ffmpeg",
      "-y",
      "-loglevel",
      "error",
      "-nostdin",
      "-framerate",
      fmt::format("{}", fps),
      "-i",
      frames_name(pattern),
      "-vf",
      "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
      "-pix_fmt",
      "yuv420p",
      "-movflags",
      "+faststart",
      plain_name(video)};
}

bool video_program_is_here() { return run_command({"ffmpeg", "-version"}).has_value(); }

std::string write_video(const fs::path& pattern, double fps, const fs::path& video) {
  const fs::path temporary = unfinished_path(video);
  const auto result = run_command(video_command(pattern, fps, temporary));
  std::error_code ignored;
  if (!result) return "ffmpeg is not installed";
  if (result->end.good()) {
    fs::rename(temporary, video, ignored);
    return ignored ? fmt::format("{} was not written by ffmpeg", video.string()) : "";
  }
  fs::remove(temporary, ignored);
  const std::string ended =
      result->end.signal != 0 ? signal_name(result->end.signal) : std::to_string(result->end.code);
  const std::string said = result->output.empty() ? "" : ": " + result->output;
  return fmt::format("ffmpeg ended with {}{}", ended, said);
}

}  // namespace glint

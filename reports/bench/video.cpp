// SPDX-License-Identifier: MIT
#include "reports/bench/video.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace glint {

namespace {

// Exit code of a program on PATH; negative: it could not be started, -errno.
int run_program_on_path(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (failed != 0) return -failed;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -errno;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

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

std::string write_video(const fs::path& pattern, double fps, const fs::path& video) {
  const fs::path temporary = video.parent_path() / (".partial-" + video.filename().string());
  const int code = run_program_on_path(video_command(pattern, fps, temporary));
  std::error_code ignored;
  if (code == 0) {
    fs::rename(temporary, video, ignored);
    return ignored ? fmt::format("{} was not written by ffmpeg", video.string()) : "";
  }
  fs::remove(temporary, ignored);
  if (code == -ENOENT) return "ffmpeg is not installed";
  if (code < 0) return fmt::format("ffmpeg could not be started: {}", std::strerror(-code));
  return fmt::format("ffmpeg ended with {}", code);
}

}  // namespace glint

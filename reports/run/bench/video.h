// SPDX-License-Identifier: MIT
// Videos from numbered pictures, by the program ffmpeg where it is installed.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// The words of the command line, for people to repeat. `pattern`: "frames/%04d.png".
std::vector<std::string> video_command(const fs::path& pattern, double fps, const fs::path& video);

bool video_program_is_here();

// Runs it. Empty: done. Else why there is no video: not installed, or how it ended; then nothing
// stands under `video`.
std::string write_video(const fs::path& pattern, double fps, const fs::path& video);

}  // namespace glint

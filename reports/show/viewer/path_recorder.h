// SPDX-License-Identifier: MIT
// Camera paths that somebody made at the viewer: as files for `render --path`, and as videos, which
// are rendered frame by frame between other work.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "reports/run/bench/path_frames.h"
#include "reports/show/viewer/viewed_run.h"

namespace glint {

class PathRecorder {
 public:
  // The page's message "path": writes FOLDER/paths/NAME.json of the run and answers where it is and
  // what to call; where a video is wanted, begins with it. Errors (kUsage): no name for a file, no
  // camera, another video is being made; (kEnvironment) cannot be written.
  Json begin(const Json& message, ViewedRun& run, const Scene& scene);
  bool busy() const { return rendering_ != nullptr; }
  // The next frame, or the video of them: what the page is told then. After an error nothing is
  // left to do.
  Json step();
  // Of a video that is ready; empty: there is none of that name. Any thread.
  fs::path video(const std::string& name) const;

 private:
  Json finish();

  std::unique_ptr<PathRendering> rendering_;
  std::string name_;
  mutable std::mutex mutex_;  // of the videos
  std::map<std::string, fs::path> videos_;
};

}  // namespace glint

// SPDX-License-Identifier: MIT
// A trained method along a path of cameras: a picture of each map for each frame, all of them side
// by side, and a video of that.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "glint/method.h"
#include "glint/scene/camera_path_file.h"
#include "reports/show/pictures/depth_scale.h"

namespace glint {

struct PathFrames {
  fs::path folder;                // paths/<name>/ of a run
  CameraPath path;                // with its frames a second
  std::vector<std::string> maps;  // ids, "away": the glass taken away; empty: all that there are
  bool values = false;            // EXR beside the pictures, as in renders/
};

struct PathResult {
  std::size_t frames = 0;
  std::vector<std::string> maps;  // ids, in the order of their pictures
  fs::path video;                 // empty: none
  std::string no_video;           // why
};

// The range of depths of a path's pictures: that of the true depths of the test views, else of
// eight of these cameras.
DepthScale path_depth_scale(Method& method, const Scene& scene, const std::vector<Camera>& cameras);

// A path frame by frame, for those who have other things to do in between. Errors: render_path()'s.
class PathRendering {
 public:
  PathRendering(Method& method, const Scene& scene, PathFrames options);
  ~PathRendering();

  std::size_t done() const;
  std::size_t count() const;
  void next();          // while done() < count()
  PathResult finish();  // the video

 private:
  struct Frames;
  std::unique_ptr<Frames> frames_;
};

// FOLDER/path.json (the cameras), FOLDER/<map>/0000.png, ... as the page colours them, in one range
// of depth: the true depths' of the test views, else of eight frames; FOLDER/layers/0000.png with
// all of them, FOLDER/layers.mp4. What an earlier path left there goes first. Errors: kUsage (a map
// that the table lacks or the method does not render; something else is in
// their place); Interrupted.
PathResult render_path(Method& method, const Scene& scene, const PathFrames& options);

}  // namespace glint

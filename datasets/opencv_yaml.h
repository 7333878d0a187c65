// SPDX-License-Identifier: MIT
// intri.yml and extri.yml as EasyVolcap writes them: OpenCV FileStorage with a list `names` and,
// per name, K_ (3x3), D_ or dist_ (k1 k2 p1 p2 k3), H_, W_, and Rot_ (3x3) or R_ (Rodrigues
// vector), T_. World to camera, OpenCV axes; K with pixel centres at +0.5 (EasyVolcap casts its
// rays so).
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/camera.h"

namespace glint {

struct OpencvCamera {
  std::string name;
  Camera camera;                      // width and height 0 where H_ and W_ are absent
  std::vector<double> distortion;     // k1 k2 p1 p2 k3; empty when absent or all zero
  std::vector<std::string> problems;  // fields that are missing or malformed, "file: field: ..."
};

// In the order of extri.yml's `names`. Errors (kBadReference): a file that OpenCV cannot parse, no
// `names`, other names in the two files. A bad field of one camera becomes one of its `problems`.
std::vector<OpencvCamera> read_opencv_cameras(const fs::path& intri, const fs::path& extri);

// intri.yml and extri.yml of cameras that are called `names`, without distortion; 17 digits.
void write_opencv_cameras(
    const fs::path& folder,
    const std::vector<std::string>& names,
    const std::vector<Camera>& cameras
);

}  // namespace glint

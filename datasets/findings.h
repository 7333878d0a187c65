// SPDX-License-Identifier: MIT
// What is wrong with a dataset, one finding each; and what can be wrong with a camera, whatever
// file it comes from.
#pragma once

#include <optional>
#include <string>

#include "glint/scene/camera.h"

namespace glint {

struct Finding {        // of `dataset check`
  std::string check;    // "ray-length-depth", "normal-axes", "intrinsics-size", "missing-file", ...
  std::string where;    // file or view, and field
  std::string message;  // found, expected, how to mend
};

// A problem whose message does not repeat `where`.
Finding make_finding(const std::string& check, const std::string& where, std::string message);

// Does the principal point lie more than a quarter of a side from the middle? Then the intrinsics
// mostly belong to another size. False for a camera without a size.
bool is_off_center(const Camera& camera);

// What is wrong with a camera, as a finding of the checks "non-finite", "intrinsics" or "pose".
std::optional<Finding> camera_problem(const Camera& camera, const std::string& where);

}  // namespace glint

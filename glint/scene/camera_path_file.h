// SPDX-License-Identifier: MIT
// Camera paths as JSON. Our own file has world_from_cam, 4x4, OpenCV axes (x right, y down, z
// forward), for each frame; nerfstudio's transforms.json and the camera_path.json of its viewer
// have OpenGL axes (x right, y up, z backward).
#pragma once

#include <vector>

#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/scene/camera.h"

namespace glint {

struct CameraPath {
  std::vector<Camera> cameras;
  double fps = 0;  // frames a second; 0: the file does not say
};

// A frame of our own file with its lens: width, height, fx, fy, cx, cy, world_from_cam.
Json camera_to_json(const Camera& camera);
// A frame of any of the three files; what it does not say of the lens is that of `lens`. `where`
// opens the messages of errors (kBadPrediction): as below.
Camera camera_from_json(const Json& json, const Camera& lens, const std::string& where);

// {"schema": 1, "fps": .., "width": .., "height": .., "fx": .., "fy": .., "cx": .., "cy": ..,
//  "frames": [{"world_from_cam": [[4 numbers] x 4]}, ..]}: the lens is that of the first camera.
// Errors (kEnvironment): cannot be written.
void write_camera_path(const fs::path& file, const CameraPath& path);

// Any of the three. What a file does not say of size and focal length is that of `lens`: our own
// may lack all of it, transforms.json too; a size without a focal length is an error. Errors
// (kBadPrediction): none of the three, no frame, a matrix that is no rigid pose, numbers that make
// no sense.
CameraPath read_camera_path(const fs::path& file, const Camera& lens);

}  // namespace glint

// SPDX-License-Identifier: MIT
// nerfstudio's transforms.json, which Blender's files are like; and camera paths.
#include "glint/scene/camera_path_file.h"
#include "tests/fuzz/dataset_folder.h"

namespace glint::fuzz {
namespace {

fs::path folder_with_pictures() {
  const fs::path folder = input_folder() / "capture";
  write_pictures([&](const std::string& view) { return folder / "images" / (view + ".png"); });
  return folder;
}

bool read(std::string_view bytes) {
  static const fs::path folder = folder_with_pictures();
  input_file(bytes, "capture/transforms.json");
  return read_dataset("nerfstudio", folder);
}

constexpr const char* kFrames = R"("frames": [
 {"file_path": "images/0000.png", "transform_matrix": [[1,0,0,0],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]},
 {"file_path": "./images/0001", "transform_matrix": [[1,0,0,0.1],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]}])";

std::vector<FuzzInput> seeds() {
  const auto with = [](const char* fields) { return fmt::format("{{{}, {}}}", fields, kFrames); };
  return {
      {"pinhole",
       with(R"("w": 3, "h": 2, "fl_x": 3, "fl_y": 3.0, "cx": 1.5, "cy": 1, "camera_model": "OPENCV",
 "test_filenames": ["images/0001"])")},
      {"angle", with(R"("camera_angle_x": 0.9, "val_filenames": [])")},
      {"lens list", with(R"("w": 30, "h": 20, "fl_x": 30, "camera_model": "OPENCV",
 "distortion_params": [-0.001, 0, 0, 0, 0, 0])")},
      {"lens", with(R"("w": 30, "h": 20, "fl_x": 30, "k1": -0.001, "k2": 0, "p1": 0, "p2": 0)")}};
}

bool read_path(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.json"), again = input_folder() / "again.json";
  const Camera lens = tiny_scene().train[0].camera;
  return accepts([&] {
    const CameraPath path = read_camera_path(file, lens);
    write_camera_path(again, path);
    if (read_camera_path(again, lens).cameras.size() != path.cameras.size())
      throw Finding("a camera path that is another one when it is written again");
  });
}

std::vector<FuzzInput> path_seeds() {
  std::vector<FuzzInput> all = seeds();
  all.pop_back();  // that of a lens
  all.push_back(written("own", [](const fs::path& p) {
    write_camera_path(p, {{tiny_scene().train[0].camera}, 24});
  }));
  all.push_back(
      {"viewer",
       R"({"render_width": 64, "render_height": 36, "fps": 24, "camera_path": [
 {"camera_to_world": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], "fov": 50, "aspect": 1.7}]})"}
  );
  return all;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"transforms_json", read, seeds})
GLINT_REGISTER(FuzzTarget, {"camera_path", read_path, path_seeds})

}  // namespace glint::fuzz

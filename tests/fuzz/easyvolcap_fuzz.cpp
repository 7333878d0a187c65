// SPDX-License-Identifier: MIT
// Cameras as OpenCV's YAML, and scene.json beside them.
#include "datasets/opencv_yaml.h"
#include "tests/fuzz/dataset_folder.h"

namespace glint::fuzz {
namespace {

std::vector<Camera> cameras() {
  std::vector<Camera> cameras;
  for (const View& view : tiny_scene().train) cameras.push_back(view.camera);
  return cameras;
}

fs::path folder_of(const fs::path& name) {
  const fs::path folder = input_folder() / name;
  write_pictures([&](const std::string& view) { return folder / "images" / view / "000000.png"; });
  write_opencv_cameras(folder, {"0000", "0001"}, cameras());
  return folder;
}

// Both files, which have no field in common but the names, are the same bytes.
bool read_yaml(std::string_view bytes) {
  static const fs::path folder = folder_of("yaml");
  for (const char* file : {"yaml/intri.yml", "yaml/extri.yml"}) input_file(bytes, file);
  return read_dataset("easyvolcap", folder);
}

std::vector<FuzzInput> yaml_seeds() {
  const fs::path folder = folder_of("yaml_seeds");
  std::string text = read_file(folder / "intri.yml");
  const std::string extri = read_file(folder / "extri.yml");
  text += extri.substr(extri.find("Rot_"));
  std::string with_lens = text;
  const std::string lens = "D_0000: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ ";
  with_lens += lens + "-0.001, 0., 0., 0., 0. ]\n";
  std::string with_vector = text;
  const std::size_t at = with_vector.find("Rot_0001");
  with_vector.replace(
      at,
      with_vector.find("T_0001") - at,
      "R_0001: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 0.1, 0.2, 0.3 ]\n"
  );
  return {{"matrices", text}, {"lens", with_lens}, {"vector", with_vector}};
}

bool read_scene_json(std::string_view bytes) {
  static const fs::path folder = folder_of("room");
  input_file(bytes, "room/scene.json");
  return read_dataset("easyvolcap", folder);
}

std::vector<FuzzInput> scene_json_seeds() {
  return {
      {"split",
       R"({"name": "room_1", "dataset": "glassroom", "hash": "ab", "test_views": ["0001"]})"},
      {"maps", R"({"name": "room_1", "simulated_priors": true, "side_maps": true})"},
      {"no priors", R"({"simulated_priors": true, "without_priors": ["0000"]})"}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"opencv_yaml", read_yaml, yaml_seeds})
GLINT_REGISTER(FuzzTarget, {"scene_json", read_scene_json, scene_json_seeds})

}  // namespace glint::fuzz

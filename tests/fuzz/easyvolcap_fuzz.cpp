// SPDX-License-Identifier: MIT
// Cameras as OpenCV's YAML, scene.json beside them, and the names of files of priors.
#include <sstream>

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
      {"no priors", R"({"simulated_priors": true, "without_priors": ["0000"]})"},
      {"of others",
       R"({"prior_axes": "opengl", "prior_depth": "auto", "prior_overlap": 2, "depth_scale": 0.01})"}};
}

// Each line names a picture of a clip of DiffusionRenderer's.
bool read_prior_names(std::string_view bytes) {
  static const fs::path folder = folder_of("clip");
  static const std::string picture = read_file(folder / "images/0000/000000.png");
  constexpr int kMostFiles = 12;
  constexpr std::size_t kLongestName = 250;  // bytes; file systems end there
  fs::remove_all(folder / "diffrens");
  fs::create_directories(folder / "diffrens");
  std::istringstream lines{std::string(bytes)};
  std::string name;
  for (int i = 0; i < kMostFiles && std::getline(lines, name); ++i) {
    const bool is_name = !name.empty() && name.size() <= kLongestName && name != "." &&
                         name != ".." && name.find_first_of({"/\0", 2}) == std::string::npos;
    if (is_name) input_file(picture, fs::path("clip/diffrens") / name);
  }
  return read_dataset("easyvolcap", folder);
}

std::vector<FuzzInput> prior_name_seeds() {
  return {
      {"one chunk", "0000.0000.normal.png\n0000.0001.normal.png\n"},
      {"jpeg",
       "0000.0000.depth.jpg\n0000.0001.depth.jpg\n0000.0000.basecolor.jpg\n"
       "0000.0001.basecolor.jpg\n0000.0000.metallic.jpg\n0000.0001.metallic.jpg"},
      {"two chunks", "0000.0000.normal.png\n0001.0000.normal.png\n"}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"opencv_yaml", read_yaml, yaml_seeds})
GLINT_REGISTER(FuzzTarget, {"scene_json", read_scene_json, scene_json_seeds})
GLINT_REGISTER(FuzzTarget, {"prior_names", read_prior_names, prior_name_seeds})

}  // namespace glint::fuzz

// SPDX-License-Identifier: MIT
// Folders of data around one file that is fuzzed, of each loader; and camera paths.
#include <sstream>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "datasets/opencv_yaml.h"
#include "glint/scene/camera_path_file.h"
#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

// Loads and checks the folder. What the loader refuses, the check has to find.
bool read_dataset(const std::string& loader, const fs::path& folder) {
  const LoaderSpec& spec = find_loader(folder, loader);
  const bool loaded = accepts([&] { spec.load(folder, {}); });
  bool nothing_found = false;
  accepts([&] { nothing_found = spec.check(folder, {}).empty(); });
  if (nothing_found && !loaded) throw Finding("it is refused, and the check finds nothing");
  return loaded;
}

// The pictures of tiny_scene(), those of view i by their path.
template <class PathOf>
void write_pictures(const PathOf& path_of) {
  for (const View& view : tiny_scene().train) write_png(path_of(view.name), view.rgb);
}

// ---- COLMAP's model. The first byte says which of its files the others are, in binary or as text;
// the other two are good.

constexpr const char* kFiles[] = {"cameras", "images", "points3D"};
constexpr const char* kExtensions[] = {".bin", ".txt"};
constexpr std::size_t kKinds = std::size(kFiles) * std::size(kExtensions);

std::string name_of(std::size_t kind) {
  return std::string(kFiles[kind % std::size(kFiles)]) + kExtensions[kind / std::size(kFiles)];
}

void write_model(const fs::path& folder) {
  ColmapModel model;
  const Scene scene = tiny_scene();
  for (std::uint32_t i = 0; i < scene.train.size(); ++i) {
    const Camera& c = scene.train[i].camera;
    model.cameras[i] = {kColmapPinhole, 3, 2, {c.fx, c.fy, c.cx, c.cy}};
    ColmapImage image{.id = i, .camera_id = i, .name = scene.train[i].name + ".png"};
    image.translation_cam_from_world = c.translation_cam_from_world;
    model.images.push_back(image);
  }
  write_colmap_model(folder, model, scene.points);
}

struct ModelFolder {
  fs::path path = input_folder() / "model";
  std::vector<std::string> good;  // by kind

  ModelFolder() {
    write_pictures([&](const std::string& view) { return path / "images" / (view + ".png"); });
    write_model(path / "sparse/0");
    for (std::size_t kind = 0; kind < kKinds; ++kind)
      good.push_back(read_file(path / "sparse/0" / name_of(kind)));
  }
};

const ModelFolder& model_folder() {
  static const ModelFolder folder;
  return folder;
}

bool read_colmap(std::string_view bytes) {
  const std::size_t kind = bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]) % kKinds;
  const ModelFolder& folder = model_folder();
  const std::size_t first = kind / std::size(kFiles) * std::size(kFiles);
  fs::remove_all(folder.path / "sparse/0");
  fs::create_directories(folder.path / "sparse/0");
  for (std::size_t other = first; other < first + std::size(kFiles); ++other)
    input_file(
        other == kind ? bytes.substr(std::min<std::size_t>(1, bytes.size())) : folder.good[other],
        fs::path("model/sparse/0") / name_of(other)
    );
  return read_dataset("colmap", folder.path);
}

std::vector<FuzzInput> colmap_seeds() {
  std::vector<FuzzInput> seeds;
  for (std::size_t kind = 0; kind < kKinds; ++kind)
    seeds.push_back({name_of(kind), static_cast<char>(kind) + model_folder().good[kind]});
  seeds.push_back(
      {"lens.txt",
       std::string(1, '\x03') +
           "0 OPENCV 3 2 3 3 1.5 1 -0.001 0 0 0\n1 SIMPLE_RADIAL 3 2 3 1.5 1 0\n"}
  );
  return seeds;
}

// ---- nerfstudio's transforms.json, which Blender's files are like; and camera paths

fs::path folder_with_pictures() {
  const fs::path folder = input_folder() / "capture";
  write_pictures([&](const std::string& view) { return folder / "images" / (view + ".png"); });
  return folder;
}

bool read_transforms(std::string_view bytes) {
  static const fs::path folder = folder_with_pictures();
  input_file(bytes, "capture/transforms.json");
  return read_dataset("nerfstudio", folder);
}

constexpr const char* kFrames = R"("frames": [
 {"file_path": "images/0000.png", "transform_matrix": [[1,0,0,0],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]},
 {"file_path": "./images/0001", "transform_matrix": [[1,0,0,0.1],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]}])";

std::vector<FuzzInput> transforms_seeds() {
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
  std::vector<FuzzInput> all = transforms_seeds();
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

// ---- folders of pictures and matrices. The first byte says whether the others are a pose or the
// intrinsics; the other one is good.

constexpr const char* kGoodPose = "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
constexpr const char* kIntrinsics = "3 0 1.5\n0 3 1\n0 0 1\n";

fs::path folder_of_poses() {
  const fs::path folder = input_folder() / "posed";
  write_pictures([&](const std::string& view) { return folder / "images" / (view + ".png"); });
  fs::create_directories(folder / "poses");
  fs::copy_file(folder / "images/0001.png", folder / "images/0002.png");  // one is left of two
  for (const char* file : {"posed/poses/0001.txt", "posed/poses/0002.txt"})
    input_file("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", file);
  return folder;
}

bool read_poses(std::string_view bytes) {
  static const fs::path folder = folder_of_poses();
  const bool is_pose = bytes.empty() || bytes[0] % 2 == 0;
  const std::string_view rest = bytes.substr(std::min<std::size_t>(1, bytes.size()));
  input_file(is_pose ? rest : kGoodPose, "posed/poses/0000.txt");
  input_file(is_pose ? kIntrinsics : rest, "posed/intrinsics.txt");
  return read_dataset("poses", folder);
}

std::vector<FuzzInput> pose_seeds() {
  return {
      {"pose", std::string(1, '\0') + kGoodPose},
      {"lost", std::string(1, '\0') + "-inf 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"},
      {"intrinsics", std::string(1, '\1') + kIntrinsics},
      {"intrinsics 4x4", std::string(1, '\1') + "3e0 0 1.5 0 0 3 1 0 0 0 1 0 0 0 0 1"}};
}

// ---- cameras as OpenCV's YAML, scene.json beside them, and the names of files of priors

std::vector<Camera> tiny_cameras() {
  std::vector<Camera> cameras;
  for (const View& view : tiny_scene().train) cameras.push_back(view.camera);
  return cameras;
}

fs::path easyvolcap_folder(const fs::path& name) {
  const fs::path folder = input_folder() / name;
  write_pictures([&](const std::string& view) { return folder / "images" / view / "000000.png"; });
  write_opencv_cameras(folder, {"0000", "0001"}, tiny_cameras());
  return folder;
}

// Both files, which have no field in common but the names, are the same bytes.
bool read_yaml(std::string_view bytes) {
  static const fs::path folder = easyvolcap_folder("yaml");
  for (const char* file : {"yaml/intri.yml", "yaml/extri.yml"}) input_file(bytes, file);
  return read_dataset("easyvolcap", folder);
}

std::vector<FuzzInput> yaml_seeds() {
  const fs::path folder = easyvolcap_folder("yaml_seeds");
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
  static const fs::path folder = easyvolcap_folder("room");
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
  static const fs::path folder = easyvolcap_folder("clip");
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

GLINT_REGISTER(FuzzTarget, {"colmap", read_colmap, colmap_seeds})
GLINT_REGISTER(FuzzTarget, {"transforms_json", read_transforms, transforms_seeds})
GLINT_REGISTER(FuzzTarget, {"camera_path", read_path, path_seeds})
GLINT_REGISTER(FuzzTarget, {"poses", read_poses, pose_seeds})
GLINT_REGISTER(FuzzTarget, {"opencv_yaml", read_yaml, yaml_seeds})
GLINT_REGISTER(FuzzTarget, {"scene_json", read_scene_json, scene_json_seeds})
GLINT_REGISTER(FuzzTarget, {"prior_names", read_prior_names, prior_name_seeds})

}  // namespace glint::fuzz

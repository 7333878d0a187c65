// SPDX-License-Identifier: MIT
// COLMAP's model. The first byte says which of its files the others are, in binary or as text; the
// other two are good.
#include "datasets/colmap_model.h"
#include "tests/fuzz/dataset_folder.h"

namespace glint::fuzz {
namespace {

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

bool read(std::string_view bytes) {
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

std::vector<FuzzInput> seeds() {
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

}  // namespace

GLINT_REGISTER(FuzzTarget, {"colmap", read, seeds})

}  // namespace glint::fuzz

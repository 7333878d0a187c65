// SPDX-License-Identifier: MIT
// Folders of pictures and matrices. The first byte says whether the others are a pose or the
// intrinsics; the other one is good.
#include "tests/fuzz/dataset_folder.h"

namespace glint::fuzz {
namespace {

constexpr const char* kPose = "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
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

bool read(std::string_view bytes) {
  static const fs::path folder = folder_of_poses();
  const bool is_pose = bytes.empty() || bytes[0] % 2 == 0;
  const std::string_view rest = bytes.substr(std::min<std::size_t>(1, bytes.size()));
  input_file(is_pose ? rest : kPose, "posed/poses/0000.txt");
  input_file(is_pose ? kIntrinsics : rest, "posed/intrinsics.txt");
  return read_dataset("poses", folder);
}

std::vector<FuzzInput> seeds() {
  return {
      {"pose", std::string(1, '\0') + kPose},
      {"lost", std::string(1, '\0') + "-inf 0 0 nan 0 1 0 0 0 0 1 0 0 0 0 1"},
      {"intrinsics", std::string(1, '\1') + kIntrinsics},
      {"intrinsics 4x4", std::string(1, '\1') + "3e0 0 1.5 0 0 3 1 0 0 0 1 0 0 0 0 1"}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"poses", read, seeds})

}  // namespace glint::fuzz

// SPDX-License-Identifier: MIT
// Writers that are killed at any moment leave no half file under a final name.
#include <catch2/catch.hpp>

#include "glint/core/files.h"
#include "glint/core/left_behind.h"
#include "glint/core/rng.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr int kSide = 96, kPoints = 2000;
constexpr int kKills = 38;
constexpr std::size_t kLineLength = 5000;

// Each file again and again, until the end comes.
int write_for_ever(const fs::path& folder) {
  PointCloud cloud;
  for (int i = 0; i < kPoints; ++i) {
    cloud.positions.push_back({float(i), 1, 2});
    cloud.colors.push_back({0.5f, 0.5f, 0.5f});
  }
  for (int round = 0;; ++round) {
    const Image image(kSide, kSide, 3, 0.25f * static_cast<float>(round % 4));
    write_png(folder / "image.png", image);
    write_exr(folder / "image.exr", image);
    write_point_ply(folder / "points.ply", cloud);
    write_file(
        folder / "text.txt", std::string(20000, static_cast<char>('a' + round % 26)) + "end"
    );
    append_line(folder / "lines.jsonl", std::string(kLineLength, 'x'));
  }
}

void check_files(const fs::path& folder) {
  const ImageSize size{kSide, kSide};
  if (fs::exists(folder / "image.png")) CHECK(read_image(folder / "image.png", 3).size() == size);
  if (fs::exists(folder / "image.exr")) CHECK(read_image(folder / "image.exr", 3).size() == size);
  if (fs::exists(folder / "points.ply"))
    CHECK(read_point_ply(folder / "points.ply").positions.size() == kPoints);
  if (fs::exists(folder / "text.txt")) {
    const std::string text = read_file(folder / "text.txt");
    CHECK(text.size() == 20003);
    CHECK(text.substr(0, 20000) == std::string(20000, text[0]));
  }
}

// Only the last line may be torn; the next one closes it.
void check_lines(const fs::path& file) {
  if (!fs::exists(file)) return;
  append_line(file, "{}");
  const std::string text = read_file(file);
  std::size_t torn = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    REQUIRE(end != std::string::npos);
    const std::size_t length = end - begin;
    if (length != kLineLength && text.substr(begin, length) != "{}") ++torn;
    begin = end + 1;
  }
  CHECK(torn <= 1);
  fs::remove(file);
}

}  // namespace

TEST_CASE("no half file stands under a final name") {
  const test::TempFolder folder;
  Rng rng(1, 0);
  for (int kill = 0; kill < kKills; ++kill) {
    const auto time = static_cast<useconds_t>(rng.uniform() * 40000);
    const auto has_begun = [&] { return fs::exists(folder / "lines.jsonl"); };  // the last of them
    test::kill_after(time, has_begun, [&] { return write_for_ever(folder.path()); });
    INFO("kill " << kill);
    CHECK(has_begun());
    check_files(folder.path());
    check_lines(folder / "lines.jsonl");
  }
  remove_left_behind(folder.path());
  for (const auto& entry : fs::directory_iterator(folder.path()))
    CHECK(entry.path().filename().string().front() != '.');
}

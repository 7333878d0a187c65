// SPDX-License-Identifier: MIT
// What the programs hold in memory: so much a pixel of one pair, whatever the number of pairs.
#include <catch2/catch.hpp>

#include <sstream>

#include "glint/scene/image_files.h"
#include "metrics/tools/tool.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr double kMB = 1e6;

// In a process of its own: threads of the writer are not ours.
void write_pair(const fs::path& a, const fs::path& b, int side) {
  test::peak_bytes([&] {
    for (const auto& [path, value] : {std::pair{a, 100}, {b, 110}})
      write_png(path, Image(side, side, 3, static_cast<float>(value) / 255));
    return 0;
  });
}

double memory_of(std::unique_ptr<MetricTool> tool, const std::vector<std::string>& words) {
  return test::peak_bytes([&] {
    std::ostringstream out, err;
    return run_tool(*tool, words, out, err);
  });
}

}  // namespace

TEST_CASE("a large pair takes two float images, and SSIM its filtered rows beside them") {
  constexpr int kSide = 5000;
  constexpr double kPixels = 1.0 * kSide * kSide;
  const test::TempFolder folder;
  const std::string a = (folder / "a.png").string(), b = (folder / "b.png").string();
  write_pair(a, b, kSide);
  const double psnr = memory_of(make_psnr_tool(), {a, b, "--quiet"});
  const double ssim = memory_of(make_ssim_tool(), {a, b, "--quiet"});
  INFO(psnr / kPixels << " and " << ssim / kPixels << " bytes a pixel");
  if (!test::kMemoryIsOurs) return;
  CHECK(psnr < 60 * kMB + 30 * kPixels);  // 2 * 3 * 4 bytes and more: 27 were measured, 44 for SSIM
  CHECK(ssim < 60 * kMB + 50 * kPixels);
}

TEST_CASE("many pairs take what few take") {
  constexpr int kSide = 300, kFew = 8, kMany = 400;
  const test::TempFolder folder;
  write_pair(folder / "a.png", folder / "b.png", kSide);
  const auto link_pairs = [&](const std::string& name, int count) {
    for (const char* side : {"a", "b"}) {
      fs::create_directories(folder / name / side);
      for (int i = 0; i < count; ++i)
        fs::create_hard_link(
            folder / (std::string(side) + ".png"),
            folder / name / side / (std::to_string(i) + ".png")
        );
    }
  };
  link_pairs("few", kFew);
  link_pairs("many", kMany);
  const auto memory = [&](const std::string& name) {
    return memory_of(
        make_psnr_tool(),
        {(folder / name / "a").string(), (folder / name / "b").string(), "--quiet"}
    );
  };
  const double few = memory("few"), many = memory("many");
  INFO(few / kMB << " and " << many / kMB << " MB");
  if (test::kMemoryIsOurs) CHECK(many < few + 10 * kMB);
}

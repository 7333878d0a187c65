// SPDX-License-Identifier: MIT
// scripts/blender/render_scene.py: Cycles shows an exchange scene as our path tracer does. Skipped
// where there is no Blender.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "datasets/dataset.h"
#include "datasets/exchange/exchange_scene.h"
#include "datasets/glassroom/path_tracer.h"
#include "glint/scene/image_files.h"
#include "tests/datasets/glassroom/trace_scenes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr int kSamples = 256;

bool has_blender() {
  if (std::system("command -v blender >/dev/null") == 0) return true;
  WARN("skipped: no blender (Debian: apt-get install --no-install-recommends blender)");
  return false;
}

// The script's exit code; what it says goes to a file beside `out`.
int run_script(const fs::path& scene, const fs::path& out, const std::string& options) {
  return std::system(fmt::format(
                         "blender -b --factory-startup -noaudio --python-exit-code 1 --python "
                         "scripts/blender/render_scene.py -- {} --out {} {} >{}.log 2>&1",
                         scene.string(),
                         out.string(),
                         options,
                         out.string()
  )
                         .c_str());
}

// Mean of the pixels in a region, all channels.
double mean_where(const Image& image, const Image& mask, float value) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mask.values().size(); ++i) {
    if (mask.values()[i] != value) continue;
    for (std::size_t c = 0; c < 3; ++c) sum += static_cast<double>(image.values()[3 * i + c]);
    ++count;
  }
  REQUIRE(count > 100);
  return sum / static_cast<double>(3 * count);
}

// Of pixels whose values differ by more than `tolerance` of ours in any channel.
double share_apart(const Image& ours, const Image& theirs, float tolerance) {
  REQUIRE(ours.size() == theirs.size());
  REQUIRE(ours.channels() == theirs.channels());
  std::size_t apart = 0;
  for (std::size_t i = 0; i < ours.values().size(); ++i)
    apart += std::abs(ours.values()[i] - theirs.values()[i]) > tolerance;
  return static_cast<double>(apart) / static_cast<double>(ours.num_pixels());
}

}  // namespace

TEST_CASE("Cycles renders a room with every material as our path tracer does") {
  if (!has_blender()) return;
  const TempFolder folder;
  // The principal point off the middle: its shift is tested, too.
  Camera camera = room_camera({96, 54});
  camera.cx += 5;
  camera.cy -= 3;
  const ExchangeScene room{
      "box", glass_box_room(), {{"0003", camera, true}, {"0004", camera}}, 0.5f, {}};
  write_exchange_scene(room, folder / "box");
  REQUIRE(run_script(folder / "box", folder / "cycles", fmt::format("--spp {}", kSamples)) == 0);
  const PathTracerOutput ours = PathTracer(room.scene).render(camera, {.spp = kSamples});

  const Scene scene = load_scene((folder / "cycles").string(), {});
  REQUIRE(scene.test.size() == 1);
  const View& view = scene.test[0];
  CHECK(view.name == "0003");
  CHECK(view.camera.cx == camera.cx);
  CHECK(view.camera.translation_cam_from_world.z == camera.translation_cam_from_world.z);
  // Edges of meshes may fall to either side.
  constexpr double kEdges = 0.005;
  CHECK(share_apart(ours.maps["glass"], view.truth["glass"], 0.5f) < kEdges);
  for (const MapId id : {MapId("depth"), MapId("behind_depth")})
    CHECK(share_apart(ours.maps[id], view.truth[id], 2e-3f) < kEdges);
  for (const MapId id : {MapId("normal"), MapId("behind_normal")})
    CHECK(share_apart(ours.maps[id], view.truth[id], 1e-2f) < kEdges);

  const Image theirs = read_image(folder / "cycles" / "gt" / "rgb" / "0003.exr", 3);
  for (const float glass : {0.0f, 1.0f}) {
    const double a = 0.5 * mean_where(ours.radiance, ours.maps["glass"], glass);
    const double b = mean_where(theirs, ours.maps["glass"], glass);
    CAPTURE(glass, a, b);
    CHECK(b == Approx(a).epsilon(glass == 0 ? 0.01 : 0.03));
  }
}

TEST_CASE("The script for Blender refuses what it cannot render, and what is not its own") {
  if (!has_blender()) return;
  const TempFolder folder;
  const ExchangeScene room{"box", glass_box_room(), {{"0000", room_camera({16, 9})}}, 1, {}};
  write_exchange_scene(room, folder / "box");
  const auto refused = [&](const std::string& options, const char* why) {
    CHECK(run_script(folder / "box", folder / "out", options) != 0);
    CHECK_THAT(read_file(folder / "out.log"), Catch::Contains(why));
  };
  refused("--views 0007", "no view is called 0007");
  write_file(folder / "out" / "notes.txt", "kept");
  refused("--spp 1", "is no rendering of this script");
  const fs::path json = folder / "box" / "exchange.json";
  const std::string text = read_file(json);
  std::string outside = text;
  outside.replace(outside.find("meshes.obj"), 10, "../box.obj");
  write_file(json, outside);
  refused("--spp 1", "is no file in");
  write_file(json, "[]");
  refused("--spp 1", "expected format");
}

// SPDX-License-Identifier: MIT
// Simulated priors of a path-traced room, written as other programs store them: detected from the
// room's true depth, and from its sparse points alone.
#include <catch2/catch.hpp>

#include "datasets/prior_evidence.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/small_room.h"
#include "tests/support/stored_priors.h"

using namespace glint;
using namespace glint::test;

namespace {

// A copy of the room that says nothing of simulated priors.
struct CopiedRoom : TempFolder {
  explicit CopiedRoom(bool truth) {
    fs::copy(small_room_folder(), path(), fs::copy_options::recursive);
    fs::remove(path() / "scene.json");
    if (!truth) fs::remove_all(path() / "gt");
  }
  void write(const char* prior, const std::function<Image(const View&)>& map) const {
    for (const auto* views : {&small_room().train, &small_room().test})
      for (const View& view : *views)
        write_png(path() / "diffrens" / prior / view.name / "000000.png", map(view));
  }
  std::string notes() const {
    std::string text;
    for (const std::string& note : load_scene(path(), {}).data_notes) text += note + "\n";
    return text;
  }
};

}  // namespace

TEST_CASE("a room's priors in each convention are detected") {
  const bool truth = GENERATE(true, false);
  const CopiedRoom room(truth);
  for (std::size_t i = 0; i < kPriorAxes.size(); ++i) {
    const std::size_t kind = i % kPriorDepths.size();
    room.write("normal", [&](const View& view) {
      return encoded(stored_normals(view.priors["normal"], static_cast<PriorAxes>(i), view.camera));
    });
    room.write("depth", [&](const View& view) {
      return stored_depth(view.truth["depth"], static_cast<PriorDepth>(kind));
    });
    const std::string notes = room.notes();
    INFO("truth " << truth << "\n" << notes);
    CHECK(notes.find(fmt::format("{} axes, detected", kPriorAxes[i])) != std::string::npos);
    CHECK(
        notes.find(fmt::format("depth priors: {}, detected", kPriorDepths[kind])) !=
        std::string::npos
    );
  }
}

TEST_CASE("noise in place of a room's priors is undecided") {
  const bool truth = GENERATE(true, false);
  const CopiedRoom room(truth);
  std::uint64_t seed = 0;
  const ImageSize size = small_room().train[0].rgb.size();
  room.write("normal", [&](const View&) { return noise_map(size, 3, ++seed); });
  room.write("depth", [&](const View&) { return noise_map(size, 1, ++seed); });
  const std::string notes = room.notes();
  INFO(notes);
  CHECK(notes.find("normal priors: opencv axes, undecided") != std::string::npos);
  CHECK(notes.find("depth priors: linear, undecided") != std::string::npos);
}

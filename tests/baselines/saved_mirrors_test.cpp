// SPDX-License-Identifier: MIT
// A model's mirrors are part of it: they are loaded, shown, told and saved.
#include <catch2/catch.hpp>

#include "glint/core/files.h"
#include "glint/method.h"
#include "glint/render/glass_transport.h"
#include "glint/scene/ply.h"
#include "glint/train/mirror_plane.h"
#include "tests/support/random_values.h"
#include "tests/support/same_bytes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Matchers::Contains;

namespace {

Camera camera() { return look_at({0, 0, -3}, {0, 0, 0}, {0, -1, 0}, {32, 24}, 60); }

// Across the view, with surfels before and behind it.
MirrorPlane mirror() {
  MirrorPlane plane;
  plane.center = {0, 0, -2.5};
  plane.normal = {0, 0, -1};
  plane.half_width = plane.half_height = 0.2;
  return plane;
}

void write_model(const fs::path& folder) {
  for (const char* set : {"interface", "transmission", "reflection"}) {
    std::vector<std::string> glass;
    if (set != std::string("reflection")) glass = {kTransparency, kSpecular};
    write_surfel_ply(folder / (std::string(set) + ".ply"), ball_of_surfels(60, 1, glass));
  }
}

MapSet rendered(const fs::path& folder) {
  const auto method = create_method("glint/nested");
  method->load(folder.string());
  return method->render(camera());
}

}  // namespace

TEST_CASE("Mirrors of a model are loaded, shown, told and saved") {
  const TempFolder root;
  write_model(root.path());
  const MapSet without = rendered(root.path());
  write_file(root / "mirrors.json", mirrors_text({mirror()}));
  const MapSet with = rendered(root.path());
  CHECK(with["specularity"].at(16, 12) == 1);
  CHECK(with["transparency"].at(16, 12) == 0);
  CHECK(with["depth"].at(16, 12) == Approx(0.5));
  for (const int x : {0, 31})
    for (int c = 0; c < 3; ++c) CHECK(with["rgb"].at(x, 0, c) == without["rgb"].at(x, 0, c));

  const auto method = create_method("glint/nested");
  method->load(root.path().string());
  REQUIRE(method->notes().size() == 1);
  CHECK_THAT(method->notes()[0], Contains("mirrors found"));
  const TempFolder other;
  method->save(other.path().string());
  CHECK(same_bytes(rendered(other.path())["rgb"], with["rgb"]));

  fs::remove(root / "mirrors.json");
  method->load(root.path().string());
  CHECK(method->notes().empty());
  method->save(other.path().string());  // and no mirrors of another model stay there
  CHECK_FALSE(fs::exists(other / "mirrors.json"));
}

TEST_CASE("A damaged list of mirrors is an error that names the file") {
  const TempFolder root;
  write_model(root.path());
  write_file(root / "mirrors.json", "[{\"normal\": [0, 0, 1]}");
  const auto method = create_method("glint/nested");
  CHECK_THROWS_WITH(method->load(root.path().string()), Contains("mirrors.json: expected a JSON"));
}

// SPDX-License-Identifier: MIT
// What is told of masks that may lie where nobody looks.
#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{48, 36};

// 4 x 3 pixels of white, half transparent.
constexpr unsigned char kWhiteRgbaPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x03, 0x08, 0x06, 0x00, 0x00, 0x00, 0xb4,
    0xf4, 0xae, 0xc6, 0x00, 0x00, 0x00, 0x12, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8,
    0xff, 0xff, 0x7f, 0x03, 0x32, 0x66, 0x20, 0x28, 0x00, 0x00, 0x34, 0xc7, 0x29, 0xdd, 0x9a,
    0x70, 0xa8, 0xe0, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

struct MaskedRoom : TempFolder {
  MaskedRoom() { write_nerfstudio(path(), box_room_views(10, kSize)); }
  void mask(std::size_t frame, const std::string& file) const {
    Json json = Json::parse(read_file(path() / "transforms.json"));
    json["frames"][frame]["mask_path"] = file;
    write_file(path() / "transforms.json", json.dump());
  }
  std::vector<std::string> notes() const { return load_scene(path(), {}).data_notes; }
};

}  // namespace

TEST_CASE("Masks that are white throughout are told of where they have an alpha channel") {
  const MaskedRoom room;
  write_png(room / "masks/white.png", Image(48, 36, 1, 1.0f));
  room.mask(2, "masks/white.png");
  CHECK(room.notes().empty());  // no channel that the mask may be in
  const std::string rgba(std::begin(kWhiteRgbaPng), std::end(kWhiteRgbaPng));
  for (const std::size_t frame : {3, 5}) {
    const std::string file = fmt::format("masks/{}.png", frame);
    write_file(room / file, rgba);
    room.mask(frame, file);
  }
  REQUIRE(room.notes().size() == 1);
  CHECK_THAT(
      room.notes()[0],
      Catch::StartsWith("2 masks are white throughout") &&
          Catch::Contains("an alpha channel, which")
  );
  Image half_out(48, 36, 1, 1.0f);
  std::fill_n(half_out.data(), 24 * 36, 0.0f);
  write_png(room / "masks/half.png", half_out);
  room.mask(4, "masks/half.png");  // one leaves pixels out: masks are where we look
  REQUIRE(room.notes().size() == 1);
  CHECK_THAT(room.notes()[0], Catch::StartsWith("pixels that do not count"));
}

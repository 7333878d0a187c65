// SPDX-License-Identifier: MIT
#include <turbojpeg.h>

#include <catch2/catch.hpp>
#include <memory>

#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "tests/support/exif.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Destroy {
  void operator()(void* coder) const { tjDestroy(coder); }
};

// A JPEG of one colour, given as bytes by format (TJPF_RGB, TJPF_GRAY or TJPF_CMYK).
std::string jpeg(
    int width, int height, TJPF format, const std::vector<unsigned char>& color, int flags = 0
) {
  const std::unique_ptr<void, Destroy> coder(tjInitCompress());
  std::vector<unsigned char> pixels;
  for (int i = 0; i < width * height; ++i) pixels.insert(pixels.end(), color.begin(), color.end());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int sampling = format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420;
  REQUIRE(
      tjCompress2(
          coder.get(), pixels.data(), width, 0, height, format, &bytes, &size, sampling, 95, flags
      ) == 0
  );
  std::string file(reinterpret_cast<const char*>(bytes), size);
  tjFree(bytes);
  return file;
}

}  // namespace

TEST_CASE("colour JPEGs are read, and one that is cut off anywhere is an error") {
  const TempFolder folder;
  const std::string file = jpeg(24, 16, TJPF_RGB, {204, 102, 51});
  write_file(folder / "x.jpg", file);
  const Image image = read_image(folder / "x.jpg");
  REQUIRE(image.size() == ImageSize{24, 16});
  REQUIRE(image.channels() == 3);
  for (int c = 0; c < 3; ++c)
    CHECK(image.at(5, 5, c) == Approx(0.8f / static_cast<float>(1 << c)).margin(0.01));
  CHECK(read_image_size(folder / "x.jpg") == ImageSize{24, 16});
  for (std::size_t length = 0; length < file.size(); length += 7) {
    write_file(folder / "cut.jpg", file.substr(0, length));
    CHECK_THAT(bad_reference([&] { read_image(folder / "cut.jpg"); }), Contains("cut.jpg"));
  }
}

TEST_CASE("pictures come back from the JPEGs that are made of them, grey and in colour") {
  const TempFolder folder;
  for (const int channels : {1, 3}) {
    Image image(24, 16, channels);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x)
        for (int c = 0; c < channels; ++c)
          image.at(x, y, c) = static_cast<float>(x + 2 * y + 10 * c) / 80;
    const std::string bytes = jpeg_bytes(to_bytes(image), 95);
    CHECK(jpeg_bytes(to_bytes(image), 20).size() < bytes.size());
    write_file(folder / "x.jpg", bytes);
    const Image read = read_image(folder / "x.jpg");
    REQUIRE(read.size() == image.size());
    REQUIRE(read.channels() == channels);
    for (std::size_t i = 0; i < read.values().size(); ++i)
      CHECK(read.data()[i] == Approx(image.data()[i]).margin(0.03));
  }
}

TEST_CASE("grey JPEGs have one channel, inks are an error") {
  const TempFolder folder;
  write_file(folder / "grey.jpg", jpeg(9, 5, TJPF_GRAY, {51}));
  const Image grey = read_image(folder / "grey.jpg");
  REQUIRE(grey.channels() == 1);
  CHECK(grey.at(8, 4) == Approx(0.2f).margin(0.01));
  write_file(folder / "inks.jpg", jpeg(9, 5, TJPF_CMYK, {0, 0, 0, 0}));
  CHECK_THAT(bad_reference([&] { read_image(folder / "inks.jpg"); }), Contains("save it as RGB"));
}

TEST_CASE("a JPEG whose data stop before its end marker is an error; bytes in front of that are not"
) {
  const TempFolder folder;
  const std::string file = jpeg(64, 64, TJPF_RGB, {204, 102, 51});
  write_file(folder / "short.jpg", file.substr(0, file.size() - 12) + "\xff\xd9");
  CHECK_THAT(bad_reference([&] { read_image(folder / "short.jpg"); }), Contains("JPEG"));
  write_file(folder / "padded.jpg", file.substr(0, file.size() - 2) + "abc\xff\xd9");
  CHECK(read_image(folder / "padded.jpg").size() == ImageSize{64, 64});
}

TEST_CASE("bytes that are left over between the scans of a JPEG are an error") {
  // They may be all that was read from a wrong place on.
  const TempFolder folder;
  const std::string file = jpeg(64, 64, TJPF_RGB, {204, 102, 51}, TJFLAG_PROGRESSIVE);
  const std::size_t scan = file.find("\xff\xda", file.find("\xff\xda") + 2);
  REQUIRE(scan != std::string::npos);
  write_file(folder / "x.jpg", file);
  CHECK(read_image(folder / "x.jpg").size() == ImageSize{64, 64});
  write_file(folder / "x.jpg", file.substr(0, scan) + "abc" + file.substr(scan));
  CHECK_THAT(bad_reference([&] { read_image(folder / "x.jpg"); }), Contains("3 extraneous bytes"));
}

TEST_CASE("a JPEG of more scans than any encoder writes is an error before it is decoded") {
  const TempFolder folder;
  std::string file = jpeg(64, 64, TJPF_RGB, {204, 102, 51}, TJFLAG_PROGRESSIVE);
  const std::string scan =
      file.substr(file.rfind("\xff\xda"), file.size() - 2 - file.rfind("\xff\xda"));
  for (int i = 0; i < 200; ++i) file.insert(file.size() - 2, scan);
  write_file(folder / "x.jpg", file);
  CHECK_THAT(bad_reference([&] { read_image(folder / "x.jpg"); }), Contains("scans, expected"));
  CHECK_THAT(
      bad_reference([&] { read_image_size(folder / "x.jpg"); }), Contains("scans, expected")
  );
}

TEST_CASE("the orientation that EXIF states is told, and pixels stay as they are stored") {
  const TempFolder folder;
  const std::string plain = jpeg(24, 16, TJPF_RGB, {204, 102, 51});
  write_file(folder / "x.jpg", plain);
  write_png(folder / "plain.png", Image(6, 4, 3, 0.5f));
  CHECK(stated_orientation(folder / "x.jpg") == 1);
  CHECK(stated_orientation(folder / "plain.png") == 1);
  const std::string png = read_file(folder / "plain.png");
  for (const bool big : {false, true})
    for (const int orientation : {1, 2, 3, 6, 8}) {
      write_file(folder / "x.jpg", jpeg_with_exif(plain, orientation, big));
      write_file(folder / "x.png", png_with_exif(png, orientation, big));
      CHECK(stated_orientation(folder / "x.jpg") == orientation);
      CHECK(stated_orientation(folder / "x.png") == orientation);
      CHECK(read_image(folder / "x.jpg").size() == ImageSize{24, 16});
      CHECK(read_image(folder / "x.png").size() == ImageSize{6, 4});
    }
  CHECK(orientation_words(6) == "EXIF orientation 6 (to be shown turned by 90 degrees clockwise)");
}

TEST_CASE("EXIF that is cut off or makes no sense states nothing") {
  const TempFolder folder;
  const std::string file = jpeg_with_exif(jpeg(24, 16, TJPF_RGB, {204, 102, 51}), 6, true);
  for (std::size_t length = 0; length < 60; ++length) {
    write_file(folder / "x.jpg", file.substr(0, length));
    CHECK_NOTHROW(stated_orientation(folder / "x.jpg"));
    std::string damaged = file;
    damaged[length] = '\xff';
    write_file(folder / "x.jpg", damaged);
    CHECK_NOTHROW(stated_orientation(folder / "x.jpg"));
  }
  write_file(folder / "x.jpg", jpeg_with_exif(jpeg(24, 16, TJPF_RGB, {204, 102, 51}), 9, false));
  CHECK(stated_orientation(folder / "x.jpg") == 1);
}

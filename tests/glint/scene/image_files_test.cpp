// SPDX-License-Identifier: MIT
#include "glint/scene/image_files.h"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <half.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "glint/scene/image_files_formats.h"
#include "tests/support/image_difference.h"
#include "tests/support/random_values.h"
#include "tests/support/same_bytes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

void write_any(const fs::path& path, const Image& image) {
  if (path.extension() == ".png") write_png(path, image);
  if (path.extension() == ".exr") write_exr(path, image);
  if (path.extension() == ".npy") write_npy(path, image);
}

// An NPY file with the given dictionary.
std::string npy_file(const std::string& dictionary, const std::string& values) {
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(dictionary.size());
  file += '\0';
  return file + dictionary + values;
}

std::string npy_dictionary(const std::string& type, const std::string& shape) {
  return "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }\n";
}

}  // namespace

TEST_CASE("PNG rounds to the nearest of 255 steps, halves to even, and clamps") {
  const TempFolder folder;
  Image image(6, 1, 1);
  // 255 v is 127.5, 25.5 and 76.5 in float: halves, to even.
  const float values[] = {0.5f, 0.1f, 0.3f, -1.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()};
  const float expected[] = {128, 26, 76, 0, 255, 0};
  std::copy(std::begin(values), std::end(values), image.data());
  write_png(folder / "x.png", image);
  const Image read = read_image(folder / "x.png");
  for (int i = 0; i < 6; ++i) CHECK(read.at(i, 0) == expected[i] / 255.0f);
}

TEST_CASE("16-bit PNG rounds to the nearest of 65535 steps and is one channel") {
  const TempFolder folder;
  Image grey(3, 2, 1);
  const float values[] = {0, 1.0f / 65535, 1234.4f / 65535, 0.5f, 1, 7};
  std::copy(std::begin(values), std::end(values), grey.data());
  write_png16(folder / "grey.png", grey);
  const Image back = read_image(folder / "grey.png");
  REQUIRE(back.channels() == 1);
  CHECK(back.at(1, 0) == 1.0f / 65535);
  CHECK(back.at(2, 0) == 1234.0f / 65535);
  CHECK(back.at(0, 1) == 32768.0f / 65535);  // 32767.5, half to even
  CHECK(back.at(2, 1) == 1);
  CHECK(error_of(ExitCode::kUsage, [&] {
          write_png16(folder / "x.png", Image(2, 2, 3));
        }).find("expected 1") != std::string::npos);
}

TEST_CASE("PNG keeps channel order and is off by at most half a step") {
  const TempFolder folder;
  const Image image = random_map({13, 7}, 3, 0, 1, 7);
  write_png(folder / "x.png", image);
  CHECK(largest_difference(read_image(folder / "x.png"), image) <= 0.5f / 255 + 1e-6f);
}

TEST_CASE("the same picture gives the same bytes") {
  const TempFolder folder;
  const Image image = random_map({13, 7}, 3, 0, 1, 7);
  for (const char* name : {"a.png", "a.exr", "a.npy"}) {
    write_any(folder / name, image);
    const std::string first = read_file(folder / name);
    write_any(folder / name, image);
    CHECK(read_file(folder / name) == first);
  }
}

TEST_CASE("grey pictures have one channel, which a caller may ask to repeat") {
  const TempFolder folder;
  write_png(folder / "grey.png", Image(3, 2, 1, 0.2f));
  CHECK(read_image(folder / "grey.png").channels() == 1);
  const Image repeated = read_image(folder / "grey.png", 3);
  CHECK(repeated.at(2, 1, 2) == 51 / 255.0f);
  write_png(folder / "colour.png", Image(3, 2, 3, 0.2f));
  CHECK_THAT(
      bad_reference([&] { read_image(folder / "colour.png", 1); }),
      Contains("3 channels, expected 1")
  );
}

TEST_CASE("EXR and NPY keep every float") {
  const TempFolder folder;
  for (const int channels : {1, 3}) {
    const Image image = random_map({17, 9}, channels, -1000, 1000, 7);
    write_exr(folder / "x.exr", image);
    CHECK(same_bytes(read_image(folder / "x.exr"), image));
    write_npy(folder / "x.npy", image);
    CHECK(same_bytes(read_image(folder / "x.npy"), image));
  }
  const Image normal = random_map({17, 9}, 3, -1, 1, 7);
  write_exr(folder / "n.exr", normal, true);
  CHECK(same_bytes(read_image(folder / "n.exr"), normal));
}

TEST_CASE("EXR half channels, tiles and shifted windows are read; crops are an error") {
  const TempFolder folder;
  const std::string path = (folder / "x.exr").string();
  Imf::Array2D<half> pixels(4, 6);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x) pixels[y][x] = half(static_cast<float>(10 * y + x));
  Imf::FrameBuffer buffer;
  // The window starts at (2, 1): the slice's base lies before the array.
  char* base = reinterpret_cast<char*>(&pixels[0][0]) - 2 * sizeof(half) - 6 * sizeof(half);
  buffer.insert("Y", Imf::Slice(Imf::HALF, base, sizeof(half), 6 * sizeof(half)));
  const Imath::Box2i window({2, 1}, {7, 4});
  {
    Imf::Header header(window, window);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    header.setTileDescription(Imf::TileDescription(4, 4));
    Imf::TiledOutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  const Image image = read_image(path);
  REQUIRE(image.size() == ImageSize{6, 4});
  REQUIRE(image.channels() == 1);
  CHECK(image.at(0, 0) == 0);
  CHECK(image.at(5, 3) == 35);
  {
    Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), window);
    header.channels().insert("Y", Imf::Channel(Imf::HALF));
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(4);
  }
  CHECK_THAT(bad_reference([&] { read_image(path); }), Contains("uncropped"));
}

TEST_CASE("EXR without usable channels is an error that lists them") {
  const TempFolder folder;
  const std::string path = (folder / "x.exr").string();
  {
    Imf::Header header(2, 2);
    for (const char* name : {"U", "V"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile file(path.c_str(), header);
    float zeros[4] = {};
    Imf::FrameBuffer buffer;
    for (const char* name : {"U", "V"})
      buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(zeros), 4, 8));
    file.setFrameBuffer(buffer);
    file.writePixels(2);
  }
  CHECK_THAT(bad_reference([&] { read_image(path); }), Contains("channels U V"));
}

TEST_CASE("NPY of other types and a batch of bad headers") {
  const TempFolder folder;
  const auto read = [&](const std::string& file) {
    write_file(folder / "x.npy", file);
    return read_image(folder / "x.npy");
  };
  CHECK(read(npy_file(npy_dictionary("|u1", "(1, 2)"), "\x33\xff")).at(0, 0) == 51 / 255.0f);
  CHECK(read(npy_file(npy_dictionary("|b1", "(2, 1)"), std::string("\x01\x00", 2))).at(0, 0) == 1);
  CHECK(read(npy_file(npy_dictionary("<f2", "(1, 1)"), std::string("\x00\x3c", 2))).at(0, 0) == 1);
  const double value = 0.25;
  const std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  CHECK(read(npy_file(npy_dictionary("<f8", "(1, 1, 1)"), bytes)).at(0, 0) == 0.25f);

  const auto message = [&](const std::string& file) { return bad_reference([&] { read(file); }); };
  CHECK_THAT(message(npy_file(npy_dictionary("<i8", "(1, 1)"), bytes)), Contains("'<i8'"));
  CHECK_THAT(message(npy_file(npy_dictionary("<f8", "(1,)"), bytes)), Contains("shape (1)"));
  CHECK_THAT(message(npy_file(npy_dictionary("<f8", "(1, 2)"), bytes)), Contains("expected 16"));
  CHECK_THAT(message(npy_file("{'descr': '<f8'}", bytes)), Contains("lacks 'shape'"));
  const std::string huge = npy_dictionary("<f4", "(65000, 65000, 3)");
  CHECK_THAT(message(npy_file(huge, bytes)), Contains("too many for a file of"));
  const std::string overflow = npy_dictionary("<f4", "(99999999999999999999, 2)");
  message(npy_file(overflow, bytes));
}

TEST_CASE("an NPY header is what NumPy writes, and not something that looks like it") {
  const TempFolder folder;
  const std::string bytes(static_cast<std::size_t>(4) * 5 * 3 * 4, '\0');
  const auto message = [&](const std::string& shape, const std::string& order = "False") {
    std::string dictionary = npy_dictionary("<f4", shape);
    dictionary.replace(dictionary.find("False"), 5, order);
    write_file(folder / "x.npy", npy_file(dictionary, bytes));
    return bad_reference([&] { read_image(folder / "x.npy"); });
  };
  for (const char* shape : {"(-4, 5, -3)", "(4e5, 3)", "('4','5','3')", "4, 5, 3", "(4, , 3)"})
    CHECK_THAT(message(shape), Contains("x.npy: the NPY header's 'shape' is "));
  CHECK_THAT(message("(4, 5, 3)", "Falsehood"), Contains("'fortran_order' is Falsehood"));
  CHECK_THAT(message("(6, 5, 2)"), Contains("shape (6, 5, 2); expected (height, width)"));
}

TEST_CASE("NPY arrays in Fortran order are read as those in C order") {
  const TempFolder folder;
  // [2][3][3], value 100 y + 10 x + c in 8 bits, once with the last index fastest and once the
  // first.
  std::string c_order, fortran_order;
  const auto value = [](int y, int x, int c) { return static_cast<char>(100 * y + 10 * x + c); };
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      for (int c = 0; c < 3; ++c) c_order += value(y, x, c);
  for (int c = 0; c < 3; ++c)
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 2; ++y) fortran_order += value(y, x, c);
  std::string dictionary = npy_dictionary("|u1", "(2, 3, 3)");
  write_file(folder / "c.npy", npy_file(dictionary, c_order));
  dictionary.replace(dictionary.find("False"), 5, "True ");
  write_file(folder / "f.npy", npy_file(dictionary, fortran_order));
  const Image a = read_image(folder / "c.npy"), b = read_image(folder / "f.npy");
  CHECK(a.at(2, 1, 1) == 121 / 255.0f);
  CHECK(largest_difference(a, b) == 0);
}

// Values 10 y + x + 100 c as float32.
std::string float_at(int y, int x, int c, bool big_endian = false) {
  const float value = static_cast<float>(10 * y + x + 100 * c);
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST_CASE("NPY of big-endian values, of a batch of one and with channels first is read") {
  const TempFolder folder;
  const auto read = [&](const std::string& type, const std::string& shape, int channels_first) {
    std::string bytes;
    const auto add = [&](int y, int x, int c) { bytes += float_at(y, x, c, type[0] == '>'); };
    for (int outer = 0; outer < (channels_first ? 3 : 1); ++outer)
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 5; ++x)
          for (int c = 0; c < (channels_first ? 1 : 3); ++c) add(y, x, channels_first ? outer : c);
    write_file(folder / "x.npy", npy_file(npy_dictionary(type, shape), bytes));
    return read_image(folder / "x.npy");
  };
  const Image expected = read("<f4", "(2, 5, 3)", false);
  CHECK(expected.at(4, 1, 2) == 214);
  for (const char* type : {"<f4", ">f4", "=f4"}) {
    CHECK(largest_difference(read(type, "(2, 5, 3)", false), expected) == 0);
    CHECK(largest_difference(read(type, "(1, 2, 5, 3)", false), expected) == 0);
    CHECK(largest_difference(read(type, "(3, 2, 5)", true), expected) == 0);
    CHECK(largest_difference(read(type, "(1, 1, 3, 2, 5)", true), expected) == 0);
  }
  std::string grey;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 5; ++x) grey += float_at(y, x, 0);
  write_file(folder / "g.npy", npy_file(npy_dictionary("<f4", "(1, 2, 5)"), grey));
  const Image map = read_image(folder / "g.npy");
  CHECK(map.size() == ImageSize{5, 2});
  CHECK(map.channels() == 1);
  CHECK(map.at(4, 1) == 14);
}

TEST_CASE("every cut-off PNG, EXR and NPY is an error that names the file") {
  const TempFolder folder;
  const Image image = random_map({9, 6}, 3, 0, 1, 7);
  for (const std::string extension : {".png", ".exr", ".npy"}) {
    write_any(folder / ("x" + extension), image);
    const std::string file = read_file(folder / ("x" + extension));
    for (std::size_t length = 0; length < file.size(); ++length) {
      INFO(extension << " of " << length << " bytes");
      write_file(folder / ("cut" + extension), std::string_view(file).substr(0, length));
      CHECK_THAT(
          bad_reference([&] { read_image(folder / ("cut" + extension)); }),
          Contains("cut" + extension)
      );
    }
  }
}

TEST_CASE("a picture under a wrong name, an unknown format and a missing file are errors") {
  const TempFolder folder;
  write_file(folder / "x.png", "not a picture");
  CHECK_THAT(
      bad_reference([&] { read_image(folder / "x.png"); }),
      Contains("neither PNG, JPEG, WebP nor BMP")
  );
  CHECK_THAT(
      bad_reference([&] { read_image(folder / "x.gif"); }), Contains("unknown image format")
  );
  CHECK_THAT(bad_reference([&] { read_image(folder / "y.exr"); }), Contains("no such file"));
}

TEST_CASE("a PNG header that claims too many pixels allocates nothing") {
  const TempFolder folder;
  write_png(folder / "x.png", Image(2, 2, 1));
  std::string file = read_file(folder / "x.png");
  file.replace(16, 8, std::string("\x00\x00\xff\x00\x00\x00\xff\x00", 8));
  write_file(folder / "x.png", file);
  CHECK_THAT(bad_reference([&] { read_image(folder / "x.png"); }), Contains("65280 x 65280"));
}

TEST_CASE("masks count from half of the range, and one that never gets there is an error") {
  const TempFolder folder;
  Image image(3, 1, 1);
  image.at(1, 0) = 127 / 255.0f;
  image.at(2, 0) = 128 / 255.0f;
  write_png(folder / "x.png", image);
  const MaskImage mask = read_mask(folder / "x.png");
  CHECK(mask.at(0, 0) == 0);
  CHECK(mask.at(1, 0) == 0);
  CHECK(mask.at(2, 0) == 255);
  write_png(folder / "ones.png", Image(3, 1, 1, 1 / 255.0f));
  CHECK_THAT(
      bad_reference([&] { read_mask(folder / "ones.png"); }), Contains("no pixel would count")
  );
  write_png(folder / "empty.png", Image(3, 1, 1));
  CHECK(read_mask(folder / "empty.png").at(1, 0) == 0);
}

TEST_CASE("sRGB encoding follows IEC 61966-2-1 and decodes back") {
  CHECK(srgb_encode(0.0f) == 0.0f);
  CHECK(srgb_encode(1.0f) == Approx(1.0f));
  CHECK(srgb_encode(0.18f) == Approx(0.46135612).epsilon(1e-5));
  CHECK(srgb_encode(0.002f) == Approx(0.02584f));
  CHECK(srgb_encode(-1.0f) == 0.0f);
  for (int i = 0; i <= 100; ++i) {
    const float v = static_cast<float>(i) / 50.0f;
    CHECK(srgb_encode(srgb_decode(v)) == Approx(v).margin(2e-4));
  }
}

namespace {

// An attribute of an EXR's header, as the file has it.
std::string exr_attribute(const std::string& name, const std::string& type, std::string value) {
  const auto bytes = static_cast<std::uint32_t>(value.size());
  std::string text = name + '\0' + type + '\0';
  text.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  return text + value;
}

std::string little_endian(std::initializer_list<std::uint32_t> numbers) {
  std::string bytes;
  for (const std::uint32_t number : numbers)
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  return bytes;
}

}  // namespace

TEST_CASE("an EXR's header is believed only as far as the file can hold") {
  const TempFolder folder;
  write_exr(folder / "x.exr", random_map({8, 6}, 3, 0, 1, 7));
  const std::string good = read_file(folder / "x.exr");
  const auto error_of_file = [&](const std::string& bytes) {
    write_file(folder / "bad.exr", bytes);
    return bad_reference([&] { read_image(folder / "bad.exr"); });
  };
  const auto with_version = [&](std::uint32_t flag) {
    return good.substr(0, 4) + little_endian({2u | flag}) + good.substr(8);
  };
  CHECK_THAT(error_of_file(with_version(1u << 11)), Contains("a deep EXR"));
  CHECK_THAT(error_of_file(with_version(1u << 12)), Contains("a multi-part EXR"));
  // An attribute larger than the file.
  std::string header = good.substr(0, 8);
  std::string huge = exr_attribute("comments", "string", "abc");
  huge.replace(huge.size() - 7, 4, little_endian({0x3fffffffu}));
  CHECK_THAT(error_of_file(header + huge + good.substr(8)), Contains("an attribute of 1073741823"));
  // Tiles that nobody needs, of a small picture.
  std::string tiles = exr_attribute("tiles", "tiledesc", little_endian({60000, 60000}) + '\0');
  CHECK_THAT(error_of_file(header + tiles + good.substr(8)), Contains("60000 x 60000"));
  // A window that the bytes cannot fill.
  const std::size_t window = good.find("dataWindow");
  REQUIRE(window != std::string::npos);
  std::string wide = good;
  wide.replace(
      window + std::string("dataWindow box2i ").size() + 4, 16, little_endian({0, 0, 59999, 59999})
  );
  CHECK_THAT(error_of_file(wide), Contains("60000 x 60000") && Contains("too many for a file"));
  // Unknown attributes are none of our business.
  write_file(folder / "note.exr", header + exr_attribute("note", "string", "abc") + good.substr(8));
  detail::check_exr_header(folder / "note.exr", read_file(folder / "note.exr"));
}

// SPDX-License-Identifier: MIT
// Pictures and maps in every format that is always there; of PNG also what lies behind the
// checksums that keep damage from it.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <libdeflate.h>
#include <turbojpeg.h>
#include <webp/encode.h>

#include <memory>

#include "glint/core/npy.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

// As a file of that name, in every way that there is.
bool read_as(const char* name, std::string_view bytes) {
  const fs::path file = input_file(bytes, name);
  accepts([&] { read_image_size(file); });
  accepts([&] { read_mask(file); });
  accepts([&] { read_alpha(file); });
  accepts([&] { read_image(file, 3); });
  return accepts([&] { read_image(file); });
}
bool read_png(std::string_view bytes) { return read_as("input.png", bytes); }
bool read_jpeg(std::string_view bytes) { return read_as("input.jpg", bytes); }
bool read_webp(std::string_view bytes) { return read_as("input.webp", bytes); }
bool read_bmp(std::string_view bytes) { return read_as("input.bmp", bytes); }
bool read_exr(std::string_view bytes) { return read_as("input.exr", bytes); }
bool read_npy(std::string_view bytes) { return read_as("input.npy", bytes); }

// ---- PNG

using namespace std::string_view_literals;

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr std::size_t kHeaderBytes = 13;

std::string big_endian_bytes(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

std::string chunk(std::string_view type, std::string_view data) {
  const std::string body = std::string(type) + std::string(data);
  return big_endian_bytes(static_cast<std::uint32_t>(data.size())) + body +
         big_endian_bytes(libdeflate_crc32(0, body.data(), body.size()));
}

std::string deflated(std::string_view bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(1), libdeflate_free_compressor
  );
  std::string packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  packed.resize(libdeflate_zlib_compress(
      compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size()
  ));
  return packed;
}

// `parts`: 13 bytes of IHDR, the number of colours, their R G B, the filtered rows.
std::string png_of(std::string_view parts) {
  const std::string_view header = parts.substr(0, kHeaderBytes);
  parts.remove_prefix(header.size());
  const std::size_t colors = parts.empty() ? 0 : static_cast<unsigned char>(parts.front());
  parts.remove_prefix(parts.empty() ? 0 : 1);
  const std::string_view palette = parts.substr(0, 3 * colors);
  parts.remove_prefix(palette.size());
  std::string png = std::string(kSignature) + chunk("IHDR", header);
  if (!palette.empty()) png += chunk("PLTE", palette);
  return png + chunk("IDAT", deflated(parts)) + chunk("IEND", "");
}

bool read_rows(std::string_view parts) {
  const fs::path file = input_file(png_of(parts), "input.png");
  return accepts([&] { read_image(file); });
}

// A row's filter is its number, as far as there are filters.
std::string rows(int count, std::size_t bytes) {
  std::string all;
  for (int y = 0; y < count; ++y) {
    all += static_cast<char>(y % 5);
    for (std::size_t i = 0; i < bytes; ++i)
      all += static_cast<char>(37 * y + 11 * static_cast<int>(i));
  }
  return all;
}

struct Kind {
  const char* name;
  int depth, type, colors;
  bool interlaced;
  std::string rows;  // of 5 x 6 pixels
};

std::vector<Kind> kinds() {
  std::string adam7 = rows(1, 3) + rows(1, 3) + rows(1, 6) + rows(2, 3) + rows(1, 9);
  adam7 += rows(3, 6) + rows(3, 15);
  return {
      {"grey1", 1, 0, 0, false, rows(6, 1)},
      {"grey16", 16, 0, 0, false, rows(6, 10)},
      {"rgb8", 8, 2, 0, false, rows(6, 15)},
      {"rgb16", 16, 2, 0, false, rows(6, 30)},
      {"palette2", 2, 3, 4, false, rows(6, 2)},
      {"grey_alpha8", 8, 4, 0, false, rows(6, 10)},
      {"rgba8", 8, 6, 0, false, rows(6, 20)},
      {"rgba16", 16, 6, 0, false, rows(6, 40)},
      {"interlaced", 8, 2, 0, true, adam7}};
}

std::vector<FuzzInput> seeds_of_rows() {
  std::vector<FuzzInput> seeds;
  for (const Kind& kind : kinds()) {
    std::string parts = big_endian_bytes(5) + big_endian_bytes(6);
    for (const int byte : {kind.depth, kind.type, 0, 0, kind.interlaced ? 1 : 0, kind.colors})
      parts += static_cast<char>(byte);
    for (int i = 0; i < 3 * kind.colors; ++i) parts += static_cast<char>(20 * i);
    seeds.push_back({kind.name, parts + kind.rows});
  }
  return seeds;
}

std::vector<FuzzInput> png_seeds() {
  std::vector<FuzzInput> seeds = seeds_of_rows();
  for (FuzzInput& seed : seeds) seed.bytes = png_of(seed.bytes);
  seeds.push_back(written("own16", [](const fs::path& p) { write_png16(p, ramp(4, 3, 1)); }));
  seeds.push_back(written("own8", [](const fs::path& p) { write_png(p, ramp(4, 3, 3)); }));
  return seeds;
}

// ---- JPEG

FuzzInput jpeg(const char* name, int sampling, int flags) {
  constexpr int kWidth = 17, kHeight = 9;
  unsigned char pixels[kWidth * kHeight * 3];
  for (std::size_t i = 0; i < sizeof pixels; ++i) pixels[i] = static_cast<unsigned char>(5 * i);
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* file = nullptr;
  unsigned long size = 0;
  const int result = tjCompress2(
      encoder.get(), pixels, kWidth, 0, kHeight, TJPF_RGB, &file, &size, sampling, 75, flags
  );
  GLINT_CHECK(result == 0, kEnvironment, "{}: {}", name, tjGetErrorStr2(encoder.get()));
  FuzzInput seed{name, std::string(reinterpret_cast<char*>(file), size)};
  tjFree(file);
  return seed;
}

std::vector<FuzzInput> jpeg_seeds() {
  return {
      jpeg("420", TJSAMP_420, 0),
      jpeg("444", TJSAMP_444, 0),
      jpeg("grey", TJSAMP_GRAY, 0),
      jpeg("progressive", TJSAMP_420, TJFLAG_PROGRESSIVE)};
}

// ---- WebP and BMP

FuzzInput webp(const char* name, int channels, bool lossless) {
  constexpr int kWidth = 9, kHeight = 6;
  std::uint8_t pixels[kWidth * kHeight * 4];
  for (std::size_t i = 0; i < sizeof pixels; ++i) pixels[i] = static_cast<std::uint8_t>(7 * i);
  std::uint8_t* bytes = nullptr;
  const int stride = channels * kWidth;
  std::size_t size = 0;
  if (lossless)
    size = WebPEncodeLosslessRGBA(pixels, kWidth, kHeight, stride, &bytes);
  else if (channels == 4)
    size = WebPEncodeRGBA(pixels, kWidth, kHeight, stride, 75, &bytes);
  else
    size = WebPEncodeRGB(pixels, kWidth, kHeight, stride, 75, &bytes);
  FuzzInput seed{name, std::string(reinterpret_cast<const char*>(bytes), size)};
  WebPFree(bytes);
  return seed;
}

std::vector<FuzzInput> webp_seeds() {
  return {webp("rgb", 3, false), webp("rgba", 4, false), webp("lossless", 4, true)};
}

// 2 x 2 pixels behind a palette of two colours.
FuzzInput bmp(const char* name, int bits) {
  constexpr std::size_t kPixelsAt = 54 + 8;
  std::string file(kPixelsAt, '\0');
  file.replace(0, 2, "BM");
  file[10] = static_cast<char>(kPixelsAt), file[14] = 40, file[18] = 2, file[22] = 2;
  file[26] = 1, file[28] = static_cast<char>(bits), file[46] = 2;
  return {name, file + std::string(16, '\1')};
}

std::vector<FuzzInput> bmp_seeds() { return {bmp("8", 8), bmp("24", 24), bmp("32", 32)}; }

// ---- EXR

constexpr int kWidth = 9, kHeight = 6;

Imf::FrameBuffer slices(const Image& image) {
  Imf::FrameBuffer buffer;
  char* base = reinterpret_cast<char*>(const_cast<float*>(image.data()));
  buffer.insert("Z", Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * kWidth));
  return buffer;
}

FuzzInput exr(const std::string& name, Imf::Compression compression, bool tiled) {
  const Image image = ramp(kWidth, kHeight, 1);
  Imf::Header header(kWidth, kHeight);
  header.compression() = compression;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  return written(name, [&](const fs::path& path) {
    if (tiled) {
      header.setTileDescription(Imf::TileDescription(4, 4, Imf::ONE_LEVEL));
      Imf::TiledOutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(slices(image));
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      Imf::OutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(slices(image));
      file.writePixels(kHeight);
    }
  });
}

std::vector<FuzzInput> exr_seeds() {
  std::vector<FuzzInput> seeds;
  for (int kind = 0; kind < Imf::NUM_COMPRESSION_METHODS; ++kind)
    seeds.push_back(exr(fmt::format("lines{}", kind), static_cast<Imf::Compression>(kind), false));
  for (const Imf::Compression kind : {Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
    seeds.push_back(exr(fmt::format("tiles{}", static_cast<int>(kind)), kind, true));
  seeds.push_back(written("rgb", [](const fs::path& p) { write_exr(p, ramp(5, 4, 3)); }));
  seeds.push_back(written("xyz", [](const fs::path& p) { write_exr(p, ramp(2, 2, 3), true); }));
  return seeds;
}

// ---- NPY

// An array of NumPy, format 1. `type`: "<f4"; `shape`: "2, 3".
std::string npy_bytes(std::string_view type, std::string_view shape, std::string_view values) {
  const std::string dictionary =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}\n", type, shape);
  std::string file(kNpyMagic);
  for (const int byte : {1, 0, static_cast<int>(dictionary.size()), 0})
    file += static_cast<char>(byte);
  return file + dictionary + std::string(values);
}

std::vector<FuzzInput> npy_seeds() {
  std::vector<FuzzInput> seeds;
  for (const char* type : {"<f2", "<f4", "<f8", "|u1", "<u2", "|b1", ">f4"}) {
    const auto bytes = static_cast<std::size_t>(type[2] - '0');
    seeds.push_back({type, npy_bytes(type, "2, 3", std::string(6 * bytes, '\x3e'))});
  }
  std::string by_columns = npy_bytes("<f4", "2, 3", std::string(24, '\x3e'));
  by_columns.replace(by_columns.find("False"), 5, "True ");
  seeds.push_back({"by columns", by_columns});
  seeds.push_back({"batch", npy_bytes("|u1", "1, 3, 1, 2", "abcdef")});
  seeds.push_back({"rgba", npy_bytes("|u1", "1, 2, 4", "abcdefgh")});
  seeds.push_back(written("own", [](const fs::path& p) { write_npy(p, ramp(3, 2, 3)); }));
  return seeds;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"png", read_png, png_seeds})
GLINT_REGISTER(FuzzTarget, {"png_rows", read_rows, seeds_of_rows})
GLINT_REGISTER(FuzzTarget, {"jpeg", read_jpeg, jpeg_seeds})
GLINT_REGISTER(FuzzTarget, {"webp", read_webp, webp_seeds})
GLINT_REGISTER(FuzzTarget, {"bmp", read_bmp, bmp_seeds})
GLINT_REGISTER(FuzzTarget, {"exr", read_exr, exr_seeds})
GLINT_REGISTER(FuzzTarget, {"npy", read_npy, npy_seeds})

}  // namespace glint::fuzz

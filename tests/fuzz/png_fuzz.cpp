// SPDX-License-Identifier: MIT
// PNG: files, and pictures behind the checksums that keep damage from them.
#include <libdeflate.h>

#include <memory>

#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

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

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.png");
  accepts([&] { read_image_size(file); });
  accepts([&] { read_mask(file); });
  return accepts([&] { read_image(file, 3); });
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

std::vector<FuzzInput> seeds() {
  std::vector<FuzzInput> seeds = seeds_of_rows();
  for (FuzzInput& seed : seeds) seed.bytes = png_of(seed.bytes);
  seeds.push_back(written("own16", [](const fs::path& p) { write_png16(p, ramp(4, 3, 1)); }));
  seeds.push_back(written("own8", [](const fs::path& p) { write_png(p, ramp(4, 3, 3)); }));
  return seeds;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"png", read, seeds})
GLINT_REGISTER(FuzzTarget, {"png_rows", read_rows, seeds_of_rows})

}  // namespace glint::fuzz

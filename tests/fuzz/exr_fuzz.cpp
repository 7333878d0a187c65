// SPDX-License-Identifier: MIT
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>

#include "glint/scene/image_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

constexpr int kWidth = 9, kHeight = 6;

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.exr");
  return accepts([&] { read_image(file); });
}

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

std::vector<FuzzInput> seeds() {
  std::vector<FuzzInput> seeds;
  for (int kind = 0; kind < Imf::NUM_COMPRESSION_METHODS; ++kind)
    seeds.push_back(exr(fmt::format("lines{}", kind), static_cast<Imf::Compression>(kind), false));
  for (const Imf::Compression kind : {Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
    seeds.push_back(exr(fmt::format("tiles{}", static_cast<int>(kind)), kind, true));
  seeds.push_back(written("rgb", [](const fs::path& p) { write_exr(p, ramp(5, 4, 3)); }));
  seeds.push_back(written("xyz", [](const fs::path& p) { write_exr(p, ramp(2, 2, 3), true); }));
  return seeds;
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"exr", read, seeds})

}  // namespace glint::fuzz

// SPDX-License-Identifier: MIT
// Weights of LPIPS: zips of arrays, and an array inside, behind the checksum that keeps damage from
// it.
#include <libdeflate.h>

#include "metrics/lpips_weights.h"
#include "metrics/npz.h"
#include "tests/fuzz/fuzz_seeds.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

constexpr const char* kName = "features.0.weight.npy";

// Weights of a network of one layer are all the same code.
LpipsNetwork network() {
  return {"tiny", "Tiny", {convolution("features.0", 1, 1, 1, 0).tapped()}};
}

std::string little_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i, value >>= 8) text += static_cast<char>(value & 0xff);
  return text;
}

struct ZipEntry {
  std::string name, content;
};

// Stored, not packed.
std::string zip_of(const std::vector<ZipEntry>& entries) {
  std::string file, directory;
  for (const ZipEntry& entry : entries) {
    const auto size = static_cast<std::uint32_t>(entry.content.size());
    const std::string fields = little_endian(20, 2) + little_endian(0, 8) +
                               little_endian(libdeflate_crc32(0, entry.content.data(), size), 4) +
                               little_endian(size, 4) + little_endian(size, 4) +
                               little_endian(static_cast<std::uint32_t>(entry.name.size()), 2) +
                               little_endian(0, 2);
    directory += "PK\x01\x02" + little_endian(20, 2) + fields + little_endian(0, 10) +
                 little_endian(static_cast<std::uint32_t>(file.size()), 4) + entry.name;
    file += "PK\x03\x04" + fields + entry.name + entry.content;
  }
  const auto count = static_cast<std::uint32_t>(entries.size());
  return file + directory + "PK\x05\x06" + little_endian(0, 4) + little_endian(count, 2) +
         little_endian(count, 2) + little_endian(static_cast<std::uint32_t>(directory.size()), 4) +
         little_endian(static_cast<std::uint32_t>(file.size()), 4) + little_endian(0, 2);
}

bool read_file_of(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.npz");
  return accepts([&] { make_lpips_weights(network(), read_npz(file), file.string()); });
}

bool read(std::string_view bytes) {
  const bool whole = read_file_of(bytes);
  const bool inside = read_file_of(zip_of({{kName, std::string(bytes)}}));
  return whole || inside;
}

std::string ones(std::size_t count) {
  const float one = 1;
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) bytes.append(reinterpret_cast<const char*>(&one), 4);
  return bytes;
}

std::vector<FuzzInput> seeds() {
  return {
      {"zip",
       zip_of(
           {{kName, npy_bytes("<f4", "1, 3, 1, 1", ones(3))},
            {"features.0.bias.npy", npy_bytes("<f4", "1,", ones(1))},
            {"lin0.weight.npy", npy_bytes("<f4", "1,", ones(1))}}
       )}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"npz", read, seeds})

}  // namespace glint::fuzz

// SPDX-License-Identifier: MIT
// SHA-256 [FIPS 180-4], to know files by their content.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace glint {

class Sha256 {
 public:
  Sha256();
  void update(std::string_view bytes);
  // 64 hexadecimal digits of everything since the beginning. Nothing may follow.
  std::string finish();

 private:
  void add_byte(unsigned char byte);
  void compress();

  std::array<std::uint32_t, 8> state_;
  std::array<unsigned char, 64> block_{};
  std::uint64_t num_bytes_ = 0;
};

inline std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.update(bytes);
  return hash.finish();
}

}  // namespace glint

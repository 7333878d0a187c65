// SPDX-License-Identifier: MIT
// Many whole numbers of one kind, coded by what was seen of them before: how many bits a number
// has and the two behind its first, as they go on from the number before; the others, which are
// noise, as they are.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

// Whole numbers that may be negative, small ones small.
inline std::uint64_t zigzag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
inline std::int64_t unzigzag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}

std::string pack_numbers(const std::vector<std::uint64_t>& numbers);

// The `count` numbers of a field. Errors (kBadPrediction, naming `where`): it cannot hold so many,
// holds others, or is damaged.
std::vector<std::uint64_t> unpack_numbers(
    std::string_view field, std::size_t count, const std::string& where
);

// Bits as they are, the lowest first.
class BitWriter {
 public:
  void put(std::uint64_t value, int bits) {
    for (; bits > 0; --bits, value >>= 1) {
      if (used_ == 0) bytes_.push_back('\0');
      const int bit = static_cast<int>(value & 1) << used_;
      bytes_.back() = static_cast<char>(static_cast<unsigned char>(bytes_.back()) | bit);
      used_ = (used_ + 1) % 8;
    }
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  int used_ = 0;  // bits of the last byte
};

class BitReader {
 public:
  explicit BitReader(std::string_view bytes) : bytes_(bytes) {}
  // Behind the end: zeros, and ended_well() says so.
  std::uint64_t get(int bits) {
    std::uint64_t value = 0;
    for (int i = 0; i < bits; ++i, ++at_) {
      const std::size_t byte = at_ / 8;
      if (byte >= bytes_.size()) continue;
      const auto bit = static_cast<unsigned char>(bytes_[byte]) >> (at_ % 8) & 1u;
      value |= std::uint64_t{bit} << i;
    }
    return value;
  }
  // All bytes were read, and no more.
  bool ended_well() const { return (at_ + 7) / 8 == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

}  // namespace glint

// SPDX-License-Identifier: MIT
// Binary arithmetic coding with adaptive probabilities: a bit that was foreseen with probability p
// costs -log2(p) bits. The carry is handled as in range coders of the LZMA kind (Martin, "Range
// encoding", 1979). Encoder and decoder have one interface, so that one text walks over what both
// code: code(bit) returns the bit, which a decoder finds itself.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace glint {

// The probability that a bit is 0, in 1 / 65536: the mean of two estimates, of which one learns
// fast and one slowly.
struct BitModel {
  std::uint16_t fast = 1 << 15, slow = 1 << 15;

  std::uint32_t of_zero() const {
    constexpr std::uint32_t kLeast = 32;  // neither bit is ever impossible
    const std::uint32_t mean = (std::uint32_t{fast} + slow) / 2;
    return mean < kLeast ? kLeast : mean > 65536 - kLeast ? 65536 - kLeast : mean;
  }
  void learn(bool bit) {
    constexpr int kFast = 5, kSlow = 7;  // shifts
    const int target = bit ? 0 : 65535;
    fast = static_cast<std::uint16_t>(fast + ((target - fast) >> kFast));
    slow = static_cast<std::uint16_t>(slow + ((target - slow) >> kSlow));
  }
};

class RangeEncoder {
 public:
  bool code(BitModel& model, bool bit) {
    const std::uint32_t bound = (range_ >> 16) * model.of_zero();
    model.learn(bit);
    return take(bit, bound);
  }
  // A bit of which nothing is foreseen.
  bool code(bool bit) { return take(bit, range_ >> 1); }
  std::string finish() {
    for (int i = 0; i < 5; ++i) shift();
    return std::move(bytes_);
  }

 private:
  bool take(bool bit, std::uint32_t bound) {
    if (bit) {
      low_ += bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      shift();
    }
    return bit;
  }
  // The topmost byte leaves. Bytes of ones wait, since a carry may still run through them.
  void shift() {
    if (low_ < 0xff000000u || low_ > 0xffffffffu) {
      const auto carry = static_cast<unsigned char>(low_ >> 32);
      for (unsigned char byte = waiting_byte_; num_waiting_ > 0; byte = 0xff, --num_waiting_)
        bytes_.push_back(static_cast<char>(static_cast<unsigned char>(byte + carry)));
      waiting_byte_ = static_cast<unsigned char>(low_ >> 24);
    }
    ++num_waiting_;
    low_ = (low_ & 0x00ffffffu) << 8;
  }

  std::string bytes_;
  std::uint64_t low_ = 0;  // 33 bits
  std::uint32_t range_ = 0xffffffffu;
  unsigned char waiting_byte_ = 0;
  std::size_t num_waiting_ = 1;
};

// Reads zeros behind the end; ended_well() tells.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::string_view bytes) : bytes_(bytes) {
    for (int i = 0; i < 5; ++i) shift();
  }
  bool code(BitModel& model, bool) {
    const bool bit = take((range_ >> 16) * model.of_zero());
    model.learn(bit);
    return bit;
  }
  bool code(bool) { return take(range_ >> 1); }
  // Whether the bytes were used up, all and no more: what was coded by a RangeEncoder is.
  bool ended_well() const { return at_ == bytes_.size(); }
  // Whether more bytes were asked for than there are: nothing that follows was ever coded.
  bool passed_end() const { return at_ > bytes_.size(); }

 private:
  bool take(std::uint32_t bound) {
    const bool bit = code_ >= bound;
    if (bit) {
      code_ -= bound;
      range_ -= bound;
    } else {
      range_ = bound;
    }
    while (range_ < (1u << 24)) {
      range_ <<= 8;
      shift();
    }
    return bit;
  }
  void shift() {
    const std::uint32_t byte = at_ < bytes_.size() ? static_cast<unsigned char>(bytes_[at_]) : 0u;
    ++at_;
    code_ = code_ << 8 | byte;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::uint32_t code_ = 0, range_ = 0xffffffffu;
};

}  // namespace glint

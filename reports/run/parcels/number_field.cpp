// SPDX-License-Identifier: MIT
#include "reports/run/parcels/number_field.h"

#include <algorithm>
#include <bit>

#include "glint/core/error.h"
#include "glint/scene/range_coder.h"

namespace glint {
namespace {

constexpr int kSizeBits = 7;     // of the number of bits, 0 to 64
constexpr int kModeledBits = 2;  // behind the first
constexpr int kContexts = 3;     // the number before was shorter than usual, like it, longer

// One text for the coder's two ends.
template <class Coder>
class NumberCoder {
 public:
  explicit NumberCoder(Coder& coder) : coder_(coder) {}

  std::uint64_t code(std::uint64_t number) {
    Models& models = models_[static_cast<std::size_t>(context_)];
    const int size = std::min(tree(models.size, kSizeBits, std::bit_width(number)), 64);
    std::uint64_t value = size > 0 ? 1 : 0;
    std::uint32_t modeled = 1;
    for (int bit = size - 2; bit >= 0; --bit) {
      const bool is = (number >> bit & 1) != 0;
      bool coded = false;
      if (size - 2 - bit < kModeledBits) {
        coded = coder_.code(models.bits[static_cast<std::size_t>(size)][modeled], is);
        modeled = 2 * modeled + coded;
      } else {
        coded = coder_.code(is);
      }
      value = 2 * value + coded;
    }
    follow(size);
    return value;
  }

 private:
  struct Models {
    BitModel size[1 << kSizeBits];
    BitModel bits[65][1 << kModeledBits];
  };

  int tree(BitModel* models, int bits, std::uint64_t value) {
    std::uint32_t at = 1;
    for (int bit = bits - 1; bit >= 0; --bit)
      at = 2 * at + coder_.code(models[at], (value >> bit & 1) != 0);
    return static_cast<int>(at - (1u << bits));
  }

  // Sizes are compared with their running mean, in 1 / 16.
  void follow(int size) {
    const int difference = 16 * size - mean_;
    context_ = difference < -12 ? 0 : (difference > 12 ? 2 : 1);
    mean_ += difference / 16;
  }

  Coder& coder_;
  Models models_[kContexts];
  int context_ = 1, mean_ = 16 * 8;
};

}  // namespace

std::string pack_numbers(const std::vector<std::uint64_t>& numbers) {
  RangeEncoder encoder;
  NumberCoder coder(encoder);
  for (const std::uint64_t number : numbers) coder.code(number);
  return encoder.finish();
}

std::vector<std::uint64_t> unpack_numbers(
    std::string_view field, std::size_t count, const std::string& where
) {
  RangeDecoder decoder(field);
  NumberCoder coder(decoder);
  std::vector<std::uint64_t> numbers;
  while (numbers.size() < count && !decoder.passed_end()) numbers.push_back(coder.code(0));
  GLINT_CHECK(
      numbers.size() == count && decoder.ended_well(),
      kBadPrediction,
      "{}: its {} bytes are not those of {} numbers; the file is damaged",
      where,
      field.size(),
      count
  );
  return numbers;
}

}  // namespace glint

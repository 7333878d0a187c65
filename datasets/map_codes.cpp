// SPDX-License-Identifier: MIT
#include "datasets/map_codes.h"

#include <immintrin.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "datasets/prior_codes.h"
#include "glint/core/error.h"
#include "glint/scene/sample_codec.h"

namespace glint {
namespace {

using Samples = std::vector<std::uint32_t>;
using Maps = std::span<const Image* const>;

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

// One way to write a map down. `parameter` is one for all maps of a string.
class MapCode {
 public:
  virtual ~MapCode() = default;
  virtual bool suits(MapKind) const { return true; }
  virtual int bits() const = 0;
  virtual std::uint8_t parameter(Maps) const { return 0; }
  // Samples [H][W][C]; false: some value is none of those that decode() gives.
  virtual bool encode(const Image& map, std::uint8_t parameter, Samples& samples) const = 0;
  virtual void decode(std::span<const std::uint32_t> samples, std::uint8_t parameter, Image& map)
      const = 0;
};

// Value by value.
template <class Code>
class ValueCode : public MapCode {
 public:
  int bits() const override { return Code::kBits; }
  bool encode(const Image& map, std::uint8_t parameter, Samples& samples) const override {
    samples.clear();
    for (const float value : map.values()) {
      const std::uint32_t sample = Code::sample_of(value, parameter);
      if (!same_bits(Code::value_of(sample, parameter), value)) return false;
      samples.push_back(sample);
    }
    return true;
  }
  void decode(std::span<const std::uint32_t> samples, std::uint8_t parameter, Image& map)
      const override {
    std::transform(samples.begin(), samples.end(), map.data(), [&](std::uint32_t sample) {
      return Code::value_of(sample, parameter);
    });
  }
};

// k / (2^bits - 1), as of picture files; of one bit 0 or 1.
template <int Bits>
struct Steps {
  static constexpr int kBits = Bits;
  static constexpr auto kMost = static_cast<float>((1u << Bits) - 1);
  static std::uint32_t sample_of(float value, std::uint8_t) {
    return static_cast<std::uint32_t>(std::nearbyint(std::clamp(value, 0.0f, 1.0f) * kMost));
  }
  static float value_of(std::uint32_t sample, std::uint8_t) {
    return static_cast<float>(sample) / kMost;
  }
};

// k 2^-parameter.
struct FixedPoint {
  static constexpr int kBits = 20;  // maps of one string may have different largest values
  static std::uint32_t sample_of(float value, std::uint8_t parameter) {
    const float scaled = std::ldexp(value, parameter);
    return scaled > 0 && scaled < 1 << kBits ? static_cast<std::uint32_t>(scaled) : 0;
  }
  static float value_of(std::uint32_t sample, std::uint8_t parameter) {
    return std::ldexp(static_cast<float>(sample), -int{parameter});
  }
};

// The largest power that brings the map's largest value below 2^16.
std::uint8_t fixed_point_of(const Image& map) {
  const float largest = *std::max_element(map.values().begin(), map.values().end());
  if (!(largest > 0) || !std::isfinite(largest)) return 0;
  int exponent = 0;
  std::frexp(largest, &exponent);  // largest < 2^exponent
  return static_cast<std::uint8_t>(std::clamp(16 - exponent, 0, 24));
}

class FixedPointCode final : public ValueCode<FixedPoint> {
 public:
  bool suits(MapKind kind) const override { return kind == MapKind::kDepth; }
  std::uint8_t parameter(Maps maps) const override {
    std::uint8_t most = 0;
    for (const Image* map : maps) most = std::max(most, fixed_point_of(*map));
    return most;
  }
};

// Depth in two bytes of a picture.
struct TwoBytes {
  static constexpr int kBits = 16;
  static std::uint32_t sample_of(float value, std::uint8_t parameter) {
    const auto high = static_cast<int>(std::clamp(value, 0.0f, 1.0f) * 255);
    for (const int first : {high, high - 1, high + 1}) {
      const float rest = value - static_cast<float>(first) / 255;
      const float second = std::nearbyint(rest * 256 * 255);
      if (first < 0 || first > 255 || second < 0 || second > 255) continue;
      const auto sample = static_cast<std::uint32_t>(first * 256 + static_cast<int>(second));
      if (same_bits(value_of(sample, parameter), value)) return sample;
    }
    return 0;
  }
  static float value_of(std::uint32_t sample, std::uint8_t) {
    return decode_depth(
        static_cast<float>(sample >> 8) / 255, static_cast<float>(sample & 255) / 255, 0
    );
  }
};

class TwoByteDepth final : public ValueCode<TwoBytes> {
 public:
  bool suits(MapKind kind) const override { return kind == MapKind::kDepth; }
};

// As integers in the order of the numbers.
struct Floats {
  static constexpr int kBits = 32;
  static constexpr std::uint32_t kSign = 1u << 31;
  static std::uint32_t sample_of(float value, std::uint8_t) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
  }
  static float value_of(std::uint32_t sample, std::uint8_t) {
    return std::bit_cast<float>((sample & kSign) != 0 ? sample & ~kSign : ~sample);
  }
};

struct HalfFloats {
  static constexpr int kBits = 16;
  static constexpr std::uint32_t kSign = 1u << 15, kAll = 0xffff;
  static std::uint32_t sample_of(float value, std::uint8_t) {
    const std::uint32_t bits = _cvtss_sh(value, _MM_FROUND_TO_NEAREST_INT);
    return (bits & kSign) != 0 ? ~bits & kAll : bits | kSign;
  }
  static float value_of(std::uint32_t sample, std::uint8_t) {
    const std::uint32_t bits = (sample & kSign) != 0 ? sample & ~kSign : ~sample & kAll;
    return _cvtsh_ss(static_cast<std::uint16_t>(bits));
  }
};

// Normals from 8 bits a channel; the parameter's bits say which axes were turned round since.
class UnitNormals final : public MapCode {
 public:
  bool suits(MapKind kind) const override { return kind == MapKind::kNormal; }
  int bits() const override { return 8; }
  std::uint8_t parameter(Maps maps) const override {
    constexpr std::uint8_t kTurns[] = {0b000, 0b110, 0b111};  // axes of loaders (prior_options.h)
    for (const std::uint8_t turned : kTurns)
      if (holds_beginning(maps, turned)) return turned;
    return 0;
  }
  bool encode(const Image& map, std::uint8_t turned, Samples& samples) const override {
    samples.resize(map.values().size());
    for (std::size_t i = 0; i < samples.size(); i += 3)
      if (!encode_pixel(map.data() + i, turned, &samples[i])) return false;
    return true;
  }
  void decode(std::span<const std::uint32_t> samples, std::uint8_t turned, Image& map)
      const override {
    for (std::size_t i = 0; i < samples.size(); i += 3)
      decode_pixel(&samples[i], turned, map.data() + i);
  }

 private:
  static float step(std::uint32_t sample) { return static_cast<float>(sample) / 255; }
  static void decode_pixel(const std::uint32_t* k, std::uint8_t turned, float* normal) {
    const Vec3f n = decode_normal({step(k[0]), step(k[1]), step(k[2])});
    for (int c = 0; c < 3; ++c) normal[c] = (turned >> c & 1) != 0 ? -n[c] : n[c];
  }

  // The first map may have many pixels without a normal, which say nothing.
  static bool holds_beginning(Maps maps, std::uint8_t turned) {
    int told = 0;
    constexpr int kEnough = 64;
    for (const Image* map : maps)
      for (std::size_t i = 0; i < map->values().size() && told < kEnough; i += 3) {
        std::uint32_t samples[3];
        if (!encode_pixel(map->data() + i, turned, samples)) return false;
        told += map->data()[i] != 0 || map->data()[i + 1] != 0 ? 1 : 0;
      }
    return true;
  }

  // The length that was divided by is not known. So the largest part's sample is tried, from where
  // unit length puts it outwards; it gives the length, and that the others.
  static bool encode_pixel(const float* normal, std::uint8_t turned, std::uint32_t* samples) {
    Vec3f n;
    for (int c = 0; c < 3; ++c) n[c] = (turned >> c & 1) != 0 ? -normal[c] : normal[c];
    int largest = 0;
    for (int c = 1; c < 3; ++c)
      if (std::abs(n[c]) > std::abs(n[largest])) largest = c;
    const auto nearest = static_cast<int>(std::nearbyint((n[largest] + 1) * 127.5f));
    for (int off = 0; off <= 255; ++off)
      for (const int sample : {nearest - off, nearest + off})
        if (sample >= 0 && sample <= 255 && fits(n, largest, sample, normal, turned, samples))
          return true;
    return false;
  }
  static bool fits(
      Vec3f n,
      int largest,
      int sample,
      const float* normal,
      std::uint8_t turned,
      std::uint32_t* samples
  ) {
    const float part = 2 * step(static_cast<std::uint32_t>(sample)) - 1;
    const float length = n[largest] == 0 ? 1 : part / n[largest];
    for (int c = 0; c < 3; ++c)
      samples[c] = static_cast<std::uint32_t>(
          std::clamp(std::nearbyint((n[c] * length + 1) * 127.5f), 0.0f, 255.0f)
      );
    float decoded[3];
    decode_pixel(samples, turned, decoded);
    return same_bits(decoded[0], normal[0]) && same_bits(decoded[1], normal[1]) &&
           same_bits(decoded[2], normal[2]);
  }
};

const ValueCode<Steps<1>> kBit;
const ValueCode<Steps<8>> kByte;
const UnitNormals kUnitNormals;
const TwoByteDepth kTwoByteDepth;
const ValueCode<Steps<16>> kSixteenBits;
const FixedPointCode kFixedPoint;
const ValueCode<HalfFloats> kHalf;
const ValueCode<Floats> kFloat;

// In the order in which they are tried. A code's place is its number in files: new ones come last.
const MapCode* const kCodes[] = {
    &kBit, &kByte, &kUnitNormals, &kTwoByteDepth, &kSixteenBits, &kFixedPoint, &kHalf, &kFloat};

constexpr std::size_t kHeader = 2;  // the code's number, its parameter

SampleFormat format_of(const MapCode& code, const Image& map) {
  return {.channels = map.channels(), .bits = code.bits()};
}

// Nothing: some map is not of that code.
std::optional<std::string> encode_by(const MapCode& code, std::uint8_t parameter, Maps maps) {
  SampleEncoder encoder(format_of(code, *maps.front()));
  Samples samples;
  for (const Image* map : maps) {
    if (!code.encode(*map, parameter, samples)) return std::nullopt;
    encoder.add(map->size(), samples);
  }
  return encoder.finish();
}

}  // namespace

std::string encode_maps(MapKind kind, Maps maps) {
  for (std::size_t number = 0; number < std::size(kCodes); ++number) {
    const MapCode& code = *kCodes[number];
    if (!code.suits(kind)) continue;
    const std::uint8_t parameter = code.parameter(maps);
    if (const auto coded = encode_by(code, parameter, maps))
      return std::string{static_cast<char>(number), static_cast<char>(parameter)} + *coded;
  }
  throw Error(ExitCode::kBadReference, "a map that no code holds");  // floats hold all
}

std::string decode_maps(std::string_view coded, MapKind kind, std::span<Image* const> maps) {
  if (coded.size() < kHeader) return "too few bytes";
  const auto number = static_cast<unsigned char>(coded[0]);
  if (number >= std::size(kCodes) || !kCodes[number]->suits(kind))
    return fmt::format("code {} is not known for such maps", number);
  const MapCode& code = *kCodes[number];
  const auto parameter = static_cast<std::uint8_t>(coded[1]);
  SampleDecoder decoder(format_of(code, *maps.front()), coded.substr(kHeader));
  Samples samples;
  for (Image* map : maps) {
    samples.resize(map->values().size());
    if (!decoder.read(map->size(), samples)) return "its bytes end before its maps do";
    code.decode(samples, parameter, *map);
    if (kind == MapKind::kMask)
      for (float& value : map->values()) value = value != 0 ? 1.0f : 0.0f;
  }
  return decoder.ended_well() ? "" : "it has more bytes than its maps take";
}

bool can_hold(std::size_t bytes, std::size_t samples) {
  // A decision costs at least -log2(1 - 32 / 65536) bits (range_coder.h), a sample at least one.
  constexpr std::size_t kMostSamplesPerByte = 11'400;
  return samples / kMostSamplesPerByte <= bytes;
}

void round_truth(MapKind kind, Image& map) {
  constexpr float kMostHalf = 65504;
  if (map.empty()) return;
  const std::uint8_t parameter = fixed_point_of(map);
  for (float& value : map.values()) {
    if (kind == MapKind::kDepth)
      value = std::ldexp(std::nearbyint(std::ldexp(value, parameter)), -int{parameter});
    else if (kind != MapKind::kNormal && kind != MapKind::kMask)
      value = HalfFloats::value_of(HalfFloats::sample_of(std::min(value, kMostHalf), 0), 0);
  }
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/scene/sample_codec.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "glint/core/rng.h"

using namespace glint;

namespace {

using Samples = std::vector<std::uint32_t>;

struct Picture {
  ImageSize size;
  Samples samples;
};

std::uint32_t most_of(int bits) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}

// Noise on a slope, and a step across it.
Picture slope(ImageSize size, const SampleFormat& format, double noise, std::uint64_t seed) {
  Rng rng(seed);
  Picture picture{size, {}};
  const double most = most_of(format.bits);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < format.channels; ++c) {
        const double value = 0.2 + 0.3 * x / size.width + 0.2 * y / size.height + 0.05 * c +
                             (x + y > size.width ? 0.2 : 0) +
                             noise * (static_cast<double>(rng.uniform()) - 0.5);
        picture.samples.push_back(
            static_cast<std::uint32_t>(std::min(most, std::max(0.0, std::round(value * most))))
        );
      }
  return picture;
}

Picture random_bits(ImageSize size, const SampleFormat& format, std::uint64_t seed) {
  Rng rng(seed);
  Picture picture{size, Samples(size.num_pixels() * static_cast<std::size_t>(format.channels))};
  for (std::uint32_t& sample : picture.samples) {
    const std::uint32_t high = rng.below(1u << 16), low = rng.below(1u << 16);
    sample = (high << 16 | low) & most_of(format.bits);
  }
  return picture;
}

std::string coded(const SampleFormat& format, const std::vector<Picture>& pictures) {
  SampleEncoder encoder(format);
  for (const Picture& picture : pictures) encoder.add(picture.size, picture.samples);
  return encoder.finish();
}

// Whether the pictures come back, and nothing is left.
bool come_back(
    const SampleFormat& format, const std::vector<Picture>& pictures, std::string_view bytes
) {
  SampleDecoder decoder(format, bytes);
  for (const Picture& picture : pictures) {
    Samples found(picture.samples.size());
    if (!decoder.read(picture.size, found) || found != picture.samples) return false;
  }
  return decoder.ended_well();
}

}  // namespace

TEST_CASE("pictures of any size, channels and bits come back to the bit") {
  for (const int bits : {1, 2, 7, 8, 9, 12, 16, 20, 31, 32})
    for (const int channels : {1, 2, 3})
      for (const ImageSize size : {ImageSize{1, 1}, {1, 7}, {9, 1}, {2, 2}, {31, 17}}) {
        const SampleFormat format{channels, bits};
        const std::vector<Picture> pictures{
            slope(size, format, 0.01, 1),
            random_bits(size, format, 2),
            {size, Samples(size.num_pixels() * static_cast<std::size_t>(channels), most_of(bits))}};
        INFO(bits << " bits, " << channels << " channels, " << size.width << " x " << size.height);
        CHECK(come_back(format, pictures, coded(format, pictures)));
      }
}

TEST_CASE("pictures of different sizes share a stream") {
  const SampleFormat format{3, 8};
  const std::vector<Picture> pictures{
      slope({40, 30}, format, 0.02, 1),
      slope({7, 50}, format, 0.02, 2),
      slope({40, 30}, format, 0, 3)};
  CHECK(come_back(format, pictures, coded(format, pictures)));
}

TEST_CASE("noise costs no more than its bits, a constant next to nothing, a slope little") {
  const ImageSize size{200, 100};
  for (const int bits : {8, 16, 32}) {
    const SampleFormat format{1, bits};
    const double raw = static_cast<double>(size.num_pixels()) * bits / 8;
    const auto share = [&](const Picture& picture) {
      return static_cast<double>(coded(format, {picture}).size()) / raw;
    };
    CHECK(share(random_bits(size, format, 3)) < 1.1);  // what learning costs
    CHECK(share({size, Samples(size.num_pixels(), 77)}) < 0.01);
  }
  // Of five values, each as likely, nobody can tell more; two of them differ by one of nine.
  const Picture noisy = slope(size, {1, 8}, 4.0 / 255, 5);
  const double bits = 8.0 * static_cast<double>(coded({1, 8}, {noisy}).size()) /
                      static_cast<double>(size.num_pixels());
  CHECK(bits > std::log2(4));
  CHECK(bits < std::log2(9));
}

TEST_CASE("a picture like the one before costs less than the first") {
  const SampleFormat format{3, 8};
  const Picture first = slope({60, 40}, format, 0.03, 1), second = slope({60, 40}, format, 0.03, 2);
  const std::size_t alone = coded(format, {first}).size();
  CHECK(coded(format, {first, second}).size() < 2 * alone - 5);
}

TEST_CASE("bytes that are cut off or too many are noticed") {
  const SampleFormat format{3, 8};
  const std::vector<Picture> pictures{slope({31, 17}, format, 0.05, 1)};
  const std::string bytes = coded(format, pictures);
  CHECK(come_back(format, pictures, bytes));
  for (std::size_t length = 0; length < bytes.size(); length += 3)
    CHECK_FALSE(come_back(format, pictures, bytes.substr(0, length)));
  CHECK_FALSE(come_back(format, pictures, bytes + '\0'));
}

TEST_CASE("any bytes decode to samples of the format, or to none") {
  Rng rng(9);
  for (int round = 0; round < 200; ++round) {
    const SampleFormat format{1 + round % 3, 1 + round % 32};
    std::string bytes(1 + rng.below(300), '\0');
    for (char& byte : bytes) byte = static_cast<char>(rng.below(256));
    SampleDecoder decoder(format, bytes);
    Samples found(20 * 10 * static_cast<std::size_t>(format.channels));
    decoder.read({20, 10}, found);
  }
}

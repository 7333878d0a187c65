// SPDX-License-Identifier: MIT
// Pictures of integer samples in as few bytes as their neighbours let foresee, without loss: each
// sample is predicted from what stands left of it and above it, and the difference is coded by how
// large such differences were nearby (range_coder.h). Of pictures in one stream each learns from
// those before it. On photographs, normals and depth of 8 and 16 bits a quarter to a half smaller
// than PNG (docs/reference/formats.md has the sizes).
//
// The prediction is a mean of simple ones, each weighted by the inverse square of its errors at the
// four neighbours, as lossless coders with blended predictors do (Meyer and Tischer, "TMW", 1997).
// All arithmetic is of integers, so every machine reads what another wrote.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "glint/core/image.h"

namespace glint {

// What the pictures of a stream have in common.
struct SampleFormat {
  int channels = 1;
  int bits = 8;  // 1 to 32; samples are below 2^bits
};

class SampleEncoder {
 public:
  explicit SampleEncoder(const SampleFormat& format);
  ~SampleEncoder();
  // samples [H][W][C].
  void add(ImageSize size, std::span<const std::uint32_t> samples);
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

class SampleDecoder {
 public:
  // `coded` must outlive it.
  SampleDecoder(const SampleFormat& format, std::string_view coded);
  ~SampleDecoder();
  // The next picture; false: the bytes ended before it did, and samples are of no use.
  bool read(ImageSize size, std::span<std::uint32_t> samples);
  // Whether all bytes belonged to the pictures that were read.
  bool ended_well() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace glint

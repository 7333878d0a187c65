// SPDX-License-Identifier: MIT
// Images and maps: row-major [height][width][channels] arrays, owned (Image) or borrowed
// (ImageView). Pixel (x, y) covers [x, x+1) x [y, y+1); its centre is (x + 0.5, y + 0.5).
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "glint/core/arrays.h"
#include "glint/core/real.h"

namespace glint {

struct ImageSize {
  int width = 0, height = 0;
  GLINT_HD std::size_t num_pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

template <class T>
struct BasicImageView {
  const T* data = nullptr;
  int width = 0, height = 0, channels = 0;

  GLINT_HD ImageSize size() const { return {width, height}; }
  GLINT_HD bool empty() const { return data == nullptr; }
  GLINT_HD std::size_t num_pixels() const { return size().num_pixels(); }
  GLINT_HD const T* pixel(int x, int y) const { return data + offset(x, y); }
  GLINT_HD T at(int x, int y, int c = 0) const { return pixel(x, y)[c]; }
  GLINT_HD std::size_t offset(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
            static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
};

// A borrowed image that kernels write.
template <class T>
struct BasicImageRef {
  T* data = nullptr;
  int width = 0, height = 0, channels = 0;

  GLINT_HD T* pixel(int x, int y) const {
    return data + BasicImageView<T>{data, width, height, channels}.offset(x, y);
  }
  GLINT_HD T& at(int x, int y, int c = 0) const { return pixel(x, y)[c]; }
};

// The host copies only what is there.
struct SynchronizedCopy {
  SynchronizedCopy() = default;
  SynchronizedCopy(const SynchronizedCopy&) { synchronize(); }
  SynchronizedCopy(SynchronizedCopy&&) noexcept {}
  SynchronizedCopy& operator=(const SynchronizedCopy&) {
    synchronize();
    return *this;
  }
  SynchronizedCopy& operator=(SynchronizedCopy&&) noexcept { return *this; }
};

template <class T>
class BasicImage {
 public:
  BasicImage() = default;
  BasicImage(int width, int height, int channels, T value = T{})
      : width_(width),
        height_(height),
        channels_(channels),
        data_(
            static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                static_cast<std::size_t>(channels),
            value
        ) {}
  // Takes width * height * channels values.
  BasicImage(int width, int height, int channels, Array<T> values)
      : width_(width), height_(height), channels_(channels), data_(std::move(values)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  ImageSize size() const { return {width_, height_}; }
  std::size_t num_pixels() const { return size().num_pixels(); }
  bool empty() const { return data_.empty(); }

  T* data() { return data_.data(); }
  const T* data() const { return data_.data(); }
  std::span<T> values() { return data_; }
  std::span<const T> values() const { return data_; }

  T* pixel(int x, int y) { return const_cast<T*>(std::as_const(*this).pixel(x, y)); }
  const T* pixel(int x, int y) const { return BasicImageView<T>(*this).pixel(x, y); }
  T& at(int x, int y, int c = 0) { return pixel(x, y)[c]; }
  T at(int x, int y, int c = 0) const { return pixel(x, y)[c]; }

  operator BasicImageView<T>() const { return {data_.data(), width_, height_, channels_}; }
  BasicImageView<T> view() const { return *this; }
  BasicImageRef<T> ref() { return {data_.data(), width_, height_, channels_}; }

 private:
  int width_ = 0, height_ = 0, channels_ = 0;
  [[no_unique_address]] SynchronizedCopy before_data_;
  Array<T> data_;
};

// Gives an image this shape; its values are not kept when it had another.
template <class T>
void fit(BasicImage<T>& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = BasicImage<T>(size.width, size.height, channels);
}

using Image = BasicImage<float>;
using ImageRef = BasicImageRef<float>;
using ImageView = BasicImageView<float>;
using MaskImage = BasicImage<unsigned char>;  // one channel; non-zero means "counts"
using MaskView = BasicImageView<unsigned char>;

}  // namespace glint

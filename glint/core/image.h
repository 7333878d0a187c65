// SPDX-License-Identifier: MIT
// Images and maps: row-major [height][width][channels] arrays, owned (Image) or borrowed
// (ImageView, of the host's side unless a kernel has it). Pixel (x, y) covers [x, x+1) x [y, y+1);
// its centre is (x + 0.5, y + 0.5).
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

template <class T>
class BasicImage;

// An image where ops run, for the fields of kernels: views and `const T*` read it, references and
// `T*` may write it. Null when empty.
template <class T>
class ConstImageOnDevice {
 public:
  explicit ConstImageOnDevice(const BasicImage<T>& image) : image_(image) {}
  operator BasicImageView<T>() const;
  operator const T*() const;

 private:
  const BasicImage<T>& image_;
};
template <class T>
class ImageOnDevice {
 public:
  explicit ImageOnDevice(BasicImage<T>& image) : image_(image) {}
  operator BasicImageView<T>() const;
  operator BasicImageRef<T>() const;
  operator const T*() const;
  operator T*() const;

 private:
  BasicImage<T>& image_;
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

  Array<T>& array() { return data_; }
  const Array<T>& array() const { return data_; }
  ImageOnDevice<T> on_device() { return ImageOnDevice<T>(*this); }
  ConstImageOnDevice<T> on_device() const { return ConstImageOnDevice<T>(*this); }

 private:
  int width_ = 0, height_ = 0, channels_ = 0;
  Array<T> data_;
};

template <class T>
ConstImageOnDevice<T>::operator BasicImageView<T>() const {
  return {*this, image_.width(), image_.height(), image_.channels()};
}
template <class T>
ConstImageOnDevice<T>::operator const T*() const {
  return image_.array().device_for_reading();
}
template <class T>
ImageOnDevice<T>::operator BasicImageView<T>() const {
  return std::as_const(image_).on_device();
}
template <class T>
ImageOnDevice<T>::operator BasicImageRef<T>() const {
  return {*this, image_.width(), image_.height(), image_.channels()};
}
template <class T>
ImageOnDevice<T>::operator const T*() const {
  return image_.array().device_for_reading();
}
template <class T>
ImageOnDevice<T>::operator T*() const {
  return image_.array().device_for_writing();
}

// An image that lives longer, or none.
template <class T>
class BasicBorrowedImage {
 public:
  BasicBorrowedImage() = default;
  BasicBorrowedImage(const BasicImage<T>& image) : image_(&image) {}

  const BasicImage<T>& get() const {
    static const BasicImage<T> none;
    return image_ == nullptr ? none : *image_;
  }
  ImageSize size() const { return get().size(); }
  int channels() const { return get().channels(); }
  std::size_t num_pixels() const { return get().num_pixels(); }
  bool empty() const { return get().empty(); }
  BasicImageView<T> view() const { return get(); }
  ConstImageOnDevice<T> on_device() const { return get().on_device(); }

 private:
  const BasicImage<T>* image_ = nullptr;
};

// Gives an image this shape; its values are not kept when it had another.
template <class T>
void fit(BasicImage<T>& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = BasicImage<T>(size.width, size.height, channels);
}

using Image = BasicImage<float>;
using BorrowedImage = BasicBorrowedImage<float>;
using ImageRef = BasicImageRef<float>;
using ImageView = BasicImageView<float>;
using MaskImage = BasicImage<unsigned char>;  // one channel; non-zero means "counts"
using MaskView = BasicImageView<unsigned char>;
using ByteImage = BasicImage<unsigned char>;  // as displayed, 255 for 1
using ByteView = BasicImageView<unsigned char>;

}  // namespace glint

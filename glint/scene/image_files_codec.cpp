// SPDX-License-Identifier: MIT
// PNG, JPEG and resizing by OpenCV.
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_formats.h"

namespace glint {
namespace {

cv::Mat decode(const fs::path& path, const std::string& file, std::string_view format) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const cv::Mat bytes(
      1, static_cast<int>(file.size()), CV_8UC1, const_cast<char*>(file.data())  // read only
  );
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    detail::fail_incomplete(path, format, error.err);
  }
  if (pixels.empty()) detail::fail_incomplete(path, format, "its data cannot be decoded");
  return pixels;
}

// Blue and red change places.
template <class T>
void copy_values(const cv::Mat& pixels, int full_range, Image& picture) {
  const float* value_of = detail::unit_values(full_range);
  const int n = pixels.channels(), first = n >= 3 ? 2 : 0;
  for (int y = 0; y < pixels.rows; ++y) {
    const T* from = pixels.ptr<T>(y);
    float* to = &picture.at(0, y);
    for (int x = 0; x < pixels.cols; ++x, from += n, to += n) {
      to[0] = value_of[from[first]];
      if (n > 1) to[1] = value_of[from[1]];
      if (n > 2) to[2] = value_of[from[0]];
      if (n > 3) to[3] = value_of[from[3]];
    }
  }
}

Image to_picture(const fs::path& path, const cv::Mat& pixels) {
  Image picture(pixels.cols, pixels.rows, pixels.channels());
  switch (pixels.depth()) {
    case CV_8U:
      copy_values<unsigned char>(pixels, 255, picture);
      break;
    case CV_16U:
      copy_values<unsigned short>(pixels, 65535, picture);
      break;
    default:
      detail::fail_incomplete(path, "image", "values are neither 8- nor 16-bit integers");
  }
  return picture;
}

}  // namespace

Image detail::decode_png(const fs::path& path, const std::string& file) {
  return to_picture(path, decode(path, file, "PNG"));
}

Image detail::decode_jpeg(const fs::path& path, const std::string& file) {
  return to_picture(path, decode(path, file, "JPEG"));
}

std::string detail::encode_png(MaskView image) {
  const cv::Mat rgb(
      image.height,
      image.width,
      CV_8UC(image.channels),
      const_cast<unsigned char*>(image.data)  // read only
  );
  cv::Mat bgr = rgb;
  if (image.channels == 3) cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> file;
  cv::imencode(".png", bgr, file);
  return {file.begin(), file.end()};
}

Image resize_image(ImageView image, ImageSize size) {
  Image result(size.width, size.height, image.channels);
  const int type = CV_32FC(image.channels);
  const cv::Mat from(image.height, image.width, type, const_cast<float*>(image.data));  // read only
  cv::Mat to(size.height, size.width, type, result.data());
  const bool shrinks = size.width <= image.width && size.height <= image.height;
  cv::resize(from, to, to.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

}  // namespace glint

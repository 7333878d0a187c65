// SPDX-License-Identifier: MIT
// Resizing by OpenCV.
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "glint/scene/image_files.h"

namespace glint {
namespace {

Image resize_by_opencv(ImageView image, ImageSize size) {
  Image result(size.width, size.height, image.channels);
  const int type = CV_32FC(image.channels);
  const cv::Mat from(image.height, image.width, type, const_cast<float*>(image.data));  // read only
  cv::Mat to(size.height, size.width, type, result.data());
  const bool shrinks = size.width <= image.width && size.height <= image.height;
  cv::resize(from, to, to.size(), 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

}  // namespace

GLINT_PROVIDE(resize_image, resize_by_opencv)

}  // namespace glint

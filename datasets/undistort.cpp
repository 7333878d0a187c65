// SPDX-License-Identifier: MIT
#include "datasets/undistort.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "glint/core/error.h"

namespace glint {
namespace {

cv::Mat borrow(const float* data, int width, int height, int channels) {
  return cv::Mat(height, width, CV_32FC(channels), const_cast<float*>(data));  // read only
}

// Inclusive rectangle of pixels.
struct Rectangle {
  int left, top, right, bottom;
  int width() const { return right - left + 1; }
  int height() const { return bottom - top + 1; }
};

}  // namespace

Undistortion::Undistortion(const Camera& camera, std::span<const double> distortion)
    : camera_(camera), full_width_(camera.width) {
  // OpenCV counts pixel centres as integers, Camera at +0.5.
  const cv::Matx33d k(camera.fx, 0, camera.cx - 0.5, 0, camera.fy, camera.cy - 0.5, 0, 0, 1);
  const std::vector<double> coefficients(distortion.begin(), distortion.end());
  from_x_.resize(camera.size().num_pixels());
  from_y_.resize(from_x_.size());
  cv::Mat x(camera.height, camera.width, CV_32FC1, from_x_.data());
  cv::Mat y(camera.height, camera.width, CV_32FC1, from_y_.data());
  cv::initUndistortRectifyMap(k, coefficients, cv::noArray(), k, x.size(), CV_32FC1, x, y);
  crop_to_photograph(camera.size());
}

bool Undistortion::inside(std::size_t pixel, ImageSize photograph) const {
  return from_x_[pixel] >= 0 && from_y_[pixel] >= 0 &&
         from_x_[pixel] <= static_cast<float>(photograph.width - 1) &&
         from_y_[pixel] <= static_cast<float>(photograph.height - 1);
}

// Trims the side with the largest share of pixels from outside until none is left.
void Undistortion::crop_to_photograph(ImageSize photograph) {
  Rectangle r{0, 0, photograph.width - 1, photograph.height - 1};
  const auto outside = [&](int x, int y) {
    return inside(
               static_cast<std::size_t>(y) * static_cast<std::size_t>(photograph.width) +
                   static_cast<std::size_t>(x),
               photograph
           )
               ? 0.0
               : 1.0;
  };
  while (r.width() > 0 && r.height() > 0) {
    double shares[4] = {};
    for (int y = r.top; y <= r.bottom; ++y) {
      shares[0] += outside(r.left, y) / r.height();
      shares[1] += outside(r.right, y) / r.height();
    }
    for (int x = r.left; x <= r.right; ++x) {
      shares[2] += outside(x, r.top) / r.width();
      shares[3] += outside(x, r.bottom) / r.width();
    }
    const auto worst = std::max_element(std::begin(shares), std::end(shares)) - shares;
    if (shares[worst] == 0) break;
    if (worst == 0) ++r.left;
    if (worst == 1) --r.right;
    if (worst == 2) ++r.top;
    if (worst == 3) --r.bottom;
  }
  GLINT_CHECK(
      2 * r.width() > photograph.width && 2 * r.height() > photograph.height,
      kBadReference,
      "undistorting leaves {} x {} of {} x {} pixels; check the distortion coefficients",
      r.width(),
      r.height(),
      photograph.width,
      photograph.height
  );
  left_ = r.left;
  top_ = r.top;
  camera_.width = r.width();
  camera_.height = r.height();
  camera_.cx -= r.left;
  camera_.cy -= r.top;
}

Image Undistortion::apply(ImageView image, Lookup lookup) const {
  const int full_height = static_cast<int>(from_x_.size()) / full_width_;
  const cv::Rect crop(left_, top_, camera_.width, camera_.height);
  const cv::Mat from = borrow(image.data, image.width, image.height, image.channels);
  const cv::Mat x = borrow(from_x_.data(), full_width_, full_height, 1)(crop);
  const cv::Mat y = borrow(from_y_.data(), full_width_, full_height, 1)(crop);
  Image result(camera_.width, camera_.height, image.channels);
  cv::Mat to(result.height(), result.width(), from.type(), result.data());
  const int interpolation = lookup == Lookup::kBilinear ? cv::INTER_LINEAR : cv::INTER_NEAREST;
  cv::remap(from, to, x, y, interpolation, cv::BORDER_REPLICATE);
  return result;
}

}  // namespace glint

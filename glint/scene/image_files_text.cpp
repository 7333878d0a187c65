// SPDX-License-Identifier: MIT
// Letters in pictures, by OpenCV's stroke font.
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

// Coverage of each pixel by the text, 0 to 255; the text starts at (border, baseline).
struct Ink {
  cv::Mat coverage;
  int border = 2, baseline = 0;
};

Ink ink_of(const std::string& text, int cap_height) {
  const double scale = cv::getFontScaleFromHeight(kFont, cap_height);
  int descent = 0;
  const cv::Size size = cv::getTextSize(text, kFont, scale, 1, &descent);
  Ink ink;
  ink.baseline = ink.border + size.height;
  ink.coverage =
      cv::Mat::zeros(ink.baseline + descent + ink.border, size.width + 2 * ink.border, CV_8UC1);
  const cv::Point start(ink.border, ink.baseline);
  cv::putText(ink.coverage, text, start, kFont, scale, cv::Scalar(255), 1, cv::LINE_AA);
  return ink;
}

}  // namespace

int text_width(const std::string& text, int cap_height) {
  const double scale = cv::getFontScaleFromHeight(kFont, cap_height);
  return cv::getTextSize(text, kFont, scale, 1, nullptr).width;
}

void draw_text(Image& image, const std::string& text, int left, int baseline, int cap_height) {
  const Ink ink = ink_of(text, cap_height);
  for (int row = 0; row < ink.coverage.rows; ++row)
    for (int column = 0; column < ink.coverage.cols; ++column) {
      const int x = left - ink.border + column, y = baseline - ink.baseline + row;
      if (x < 0 || x >= image.width() || y < 0 || y >= image.height()) continue;
      const float paper = 1 - static_cast<float>(ink.coverage.at<unsigned char>(row, column)) / 255;
      for (int c = 0; c < image.channels(); ++c) image.at(x, y, c) *= paper;
    }
}

}  // namespace glint

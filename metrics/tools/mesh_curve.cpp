// SPDX-License-Identifier: MIT
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "glint/scene/image_files.h"
#include "metrics/tools/mesh_output.h"

namespace glint {
namespace {

constexpr int kWidth = 720, kHeight = 480, kCapHeight = 11;
constexpr int kLeft = 60, kRight = 24, kTop = 40, kBottom = 56;  // margins in pixels
constexpr int kTicks = 5;
constexpr int kShift = 4;  // fractional bits of OpenCV's drawing coordinates

// Okabe and Ito's colours, told apart by everyone; R G B.
const cv::Scalar kF1Color(0, 114, 178), kPrecisionColor(213, 94, 0), kRecallColor(0, 158, 115);
const cv::Scalar kGridColor(220, 220, 220), kAxisColor(90, 90, 90);

// Fractions of the plotted field, y upwards, to pixels.
cv::Point2d pixel_of(double x, double y) {
  return {
      kLeft + x * (kWidth - kLeft - kRight), kHeight - kBottom - y * (kHeight - kTop - kBottom)};
}

cv::Point fixed_point(cv::Point2d pixel) {
  return {cvRound(pixel.x * (1 << kShift)), cvRound(pixel.y * (1 << kShift))};
}

void draw_line(cv::Mat& canvas, cv::Point2d from, cv::Point2d to, cv::Scalar color) {
  cv::line(canvas, fixed_point(from), fixed_point(to), color, 1, cv::LINE_AA, kShift);
}

void draw_grid(cv::Mat& canvas) {
  for (int i = 0; i <= kTicks; ++i) {
    const double at = static_cast<double>(i) / kTicks;
    const cv::Scalar color = i == 0 ? kAxisColor : kGridColor;
    draw_line(canvas, pixel_of(at, 0), pixel_of(at, 1), color);
    draw_line(canvas, pixel_of(0, at), pixel_of(1, at), color);
  }
}

void draw_curve(
    cv::Mat& canvas,
    const std::vector<ThresholdScores>& curve,
    double ThresholdScores::*value,
    cv::Scalar color,
    int thickness
) {
  std::vector<cv::Point> points;
  for (const ThresholdScores& at : curve)
    points.push_back(fixed_point(pixel_of(at.threshold_m / curve.back().threshold_m, at.*value)));
  cv::polylines(canvas, points, false, color, thickness, cv::LINE_AA, kShift);
}

void label_axes(Image& image, double last_threshold_m) {
  for (int i = 0; i <= kTicks; ++i) {
    const double at = static_cast<double>(i) / kTicks;
    const cv::Point2d below = pixel_of(at, 0), beside = pixel_of(0, at);
    const std::string threshold = fmt::format("{:g}", 100 * at * last_threshold_m);
    const std::string share = fmt::format("{:.1f}", at);
    const int half = text_width(threshold, kCapHeight) / 2;
    draw_text(image, threshold, cvRound(below.x) - half, kHeight - kBottom + 22, kCapHeight);
    draw_text(image, share, kLeft - 36, cvRound(beside.y) + kCapHeight / 2, kCapHeight);
  }
  const std::string title = "threshold in cm";
  const int center = kLeft + (kWidth - kLeft - kRight) / 2;
  draw_text(image, title, center - text_width(title, kCapHeight) / 2, kHeight - 10, kCapHeight);
}

struct LegendEntry {
  const char* name;
  cv::Scalar color;
  int left;
};
const LegendEntry kLegend[] = {
    {"F1", kF1Color, kLeft},
    {"precision", kPrecisionColor, kLeft + 90},
    {"recall", kRecallColor, kLeft + 240}};

Image to_image(const cv::Mat& canvas) {
  Image image(canvas.cols, canvas.rows, 3);
  for (int y = 0; y < canvas.rows; ++y)
    for (int x = 0; x < canvas.cols; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<float>(canvas.at<cv::Vec3b>(y, x)[c]) / 255;
  return image;
}

}  // namespace

Image draw_f1_curve(const std::vector<ThresholdScores>& curve) {
  cv::Mat canvas(kHeight, kWidth, CV_8UC3, cv::Scalar::all(255));
  draw_grid(canvas);
  draw_curve(canvas, curve, &ThresholdScores::precision, kPrecisionColor, 1);
  draw_curve(canvas, curve, &ThresholdScores::recall, kRecallColor, 1);
  draw_curve(canvas, curve, &ThresholdScores::f1, kF1Color, 2);
  for (const LegendEntry& entry : kLegend)
    cv::rectangle(canvas, cv::Rect(entry.left, 16, 18, 8), entry.color, cv::FILLED);
  Image image = to_image(canvas);
  for (const LegendEntry& entry : kLegend)
    draw_text(image, entry.name, entry.left + 24, 26, kCapHeight);
  label_axes(image, curve.back().threshold_m);
  return image;
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/train/photometric.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/core/simd.h"
#include "glint/render/map_kernels.h"
#include "glint/train/photometric_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kRowGrain = 4;
constexpr int kPad = 8;  // floats before and after a row: the window's radius, rounded to a vector

// The window's weights, one vector each.
struct Window {
  Float8 weights[kSsimTaps];
  Window() {
    const std::array<float, kSsimTaps> taps = ssim_window<float>();
    for (int k = 0; k < kSsimTaps; ++k) weights[k] = Float8(taps[k]);
  }
};

// One image row, planar, with zeros on both sides.
struct PaddedRow {
  std::vector<float> values;
  explicit PaddedRow(std::size_t stride) : values(stride + 2 * kPad, 0.0f) {}
  float* data() { return values.data() + kPad; }
  const float* data() const { return values.data() + kPad; }
};

void load_channel(const Image& image, int y, int channel, PaddedRow& row) {
  const float* pixels = image.pixel(0, y);
  for (int x = 0; x < image.width(); ++x) row.data()[x] = pixels[3 * x + channel];
}

// out[x .. x+8) = sum_k w_k in[x + k - radius].
Float8 blur8(const Window& window, const float* in, std::size_t x) {
  Float8 sum(0.0f);
  for (int k = 0; k < kSsimTaps; ++k)
    sum = fma_of(window.weights[k], Float8::load(in + x + k - kSsimRadius), sum);
  return sum;
}

// The vertical window over a plane's rows y - 5 .. y + 5; rows outside the image count as zero.
struct ColumnBlur {
  const float* rows[kSsimTaps];
  int first, last;  // taps inside the image
  ColumnBlur(const float* plane, std::size_t stride, int y, int height)
      : first(std::max(0, kSsimRadius - y)), last(std::min(kSsimTaps, height + kSsimRadius - y)) {
    for (int k = first; k < last; ++k)
      rows[k] = plane + static_cast<std::size_t>(y + k - kSsimRadius) * stride;
  }
  Float8 at(const Window& window, std::size_t x) const {
    Float8 sum(0.0f);
    for (int k = first; k < last; ++k)
      sum = fma_of(window.weights[k], Float8::load(rows[k] + x), sum);
    return sum;
  }
};

double sum_of(const std::vector<double>& rows) {
  return std::accumulate(rows.begin(), rows.end(), 0.0);
}

}  // namespace

float* PhotometricLoss::plane_row(FloatArray& planes, int plane, int y) {
  return planes.data() + (static_cast<std::size_t>(plane) * height_ + y) * stride_;
}

// Horizontal pass of the five moments.
void PhotometricLoss::blur_rows(const Image& rendered, const Image& target, int channel) {
  parallel_for_blocks(height_, kRowGrain, [&](std::size_t begin, std::size_t end) {
    const Window window;
    PaddedRow x(stride_), y(stride_), xx(stride_), yy(stride_), xy(stride_);
    const PaddedRow* rows[5] = {&x, &y, &xx, &yy, &xy};
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      load_channel(rendered, row, channel, x);
      load_channel(target, row, channel, y);
      for (std::size_t i = 0; i < stride_; i += 8) {
        const Float8 a = Float8::load(x.data() + i), b = Float8::load(y.data() + i);
        (a * a).store(xx.data() + i);
        (b * b).store(yy.data() + i);
        (a * b).store(xy.data() + i);
      }
      for (int plane = 0; plane < 5; ++plane)
        for (std::size_t i = 0; i < stride_; i += 8)
          blur8(window, rows[plane]->data(), i).store(plane_row(moments_, plane, row) + i);
    }
  });
}

// Vertical pass, the formula and its derivatives with respect to the moments of the render.
void PhotometricLoss::ssim_rows() {
  parallel_for(height_, kRowGrain, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const Window window;
    const auto column = [&](int plane) {
      return ColumnBlur(plane_row(moments_, plane, 0), stride_, y, height_);
    };
    const ColumnBlur columns[5] = {column(0), column(1), column(2), column(3), column(4)};
    Float8 total(0.0f);
    for (std::size_t i = 0; i < stride_; i += 8) {
      Float8 m[5];
      for (int plane = 0; plane < 5; ++plane) m[plane] = columns[plane].at(window, i);
      const auto inside = Float8(static_cast<float>(i)) + lane_indices<Float8>() <
                          Float8(static_cast<float>(width_));
      const Float8 one = select(inside, Float8(1.0f), Float8(0.0f));
      total += one * ssim_from_moments(m[0], m[1], m[2], m[3], m[4]);
      Float8 g[3] = {0.0f, 0.0f, 0.0f};
      ssim_from_moments_vjp(m[0], m[1], m[2], m[3], m[4], one, g[0], g[1], g[2]);
      for (int plane = 0; plane < 3; ++plane)
        g[plane].store(plane_row(moment_gradients_, plane, y) + i);
    }
    row_ssim_[row] += static_cast<double>(lane_sum(total));
  });
}

// Transposed blur of the moment gradients (the window is symmetric), then the chain to the pixels:
// dL/dx = F(g_mu) + 2 x F(g_xx) + y F(g_xy).
void PhotometricLoss::gradient_rows(
    const Image& rendered,
    const Image& target,
    int channel,
    PhotometricWeights weights,
    Image& gradient
) {
  const float per_value = 1.0f / static_cast<float>(3 * rendered.num_pixels());
  const float l1_scale = weights.l1 * per_value, ssim_scale = -weights.ssim * per_value;
  parallel_for_blocks(height_, kRowGrain, [&](std::size_t begin, std::size_t end) {
    const Window window;
    PaddedRow g0(stride_), g1(stride_), g2(stride_), x(stride_), y(stride_), out(stride_);
    PaddedRow* rows[3] = {&g0, &g1, &g2};
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int plane = 0; plane < 3; ++plane) {
        const ColumnBlur column(plane_row(moment_gradients_, plane, 0), stride_, row, height_);
        for (std::size_t i = 0; i < stride_; i += 8)
          column.at(window, i).store(rows[plane]->data() + i);
      }
      load_channel(rendered, row, channel, x);
      load_channel(target, row, channel, y);
      Float8 l1(0.0f), mse(0.0f);
      for (std::size_t i = 0; i < stride_; i += 8) {
        const Float8 a = Float8::load(x.data() + i), b = Float8::load(y.data() + i);
        const Float8 ssim = blur8(window, g0.data(), i) +
                            Float8(2.0f) * a * blur8(window, g1.data(), i) +
                            b * blur8(window, g2.data(), i);
        const Float8 difference = a - b;
        const Float8 sign = select(difference > Float8(0.0f), Float8(1.0f), Float8(0.0f)) -
                            select(difference < Float8(0.0f), Float8(1.0f), Float8(0.0f));
        (Float8(l1_scale) * sign + Float8(ssim_scale) * ssim).store(out.data() + i);
        const Float8 clamped = min_of(max_of(a, Float8(0.0f)), Float8(1.0f)) - b;
        l1 += abs_of(difference);
        mse = fma_of(clamped, clamped, mse);
      }
      row_l1_[row] += static_cast<double>(lane_sum(l1));
      row_mse_[row] += static_cast<double>(lane_sum(mse));
      float* pixels = gradient.pixel(0, row);
      for (int i = 0; i < width_; ++i) pixels[3 * i + channel] += out.data()[i];
    }
  });
}

PhotometricTerms PhotometricLoss::evaluate_on_gpu(
    const Image& rendered, const Image& target, PhotometricWeights weights, Image& gradient
) {
  const std::size_t values = 3 * rendered.num_pixels();
  const PlaneStack planes{width_, height_};
  SsimWindow window;
  const std::array<float, kSsimTaps> taps = ssim_window<float>();
  std::copy(taps.begin(), taps.end(), window.weights);
  moments_.resize(kMomentPlanes * values);
  moment_gradients_.resize(kGradientPlanes * values);
  float* moments = moments_.on_device();
  float* gradients = moment_gradients_.on_device();
  run_kernel(
      values, 1, BlurMomentRows{rendered.on_device(), target.on_device(), window, planes, moments}
  );
  const double ssim = sum_kernel(rendered.size(), SsimAt{window, planes, moments, gradients});
  run_kernel(kGradientPlanes * values, 1, BlurGradientColumns{window, planes, gradients, moments});
  const auto count = static_cast<double>(values);
  const float per_value = 1.0f / static_cast<float>(values);
  const PhotometricAt loss_at{
      rendered.on_device(),
      target.on_device(),
      window,
      planes,
      moments,
      weights.l1 * per_value,
      -weights.ssim * per_value,
      gradient.on_device()};
  const PhotometricSums sums = sum_kernel(rendered.size(), loss_at);
  return {sums.l1 / count, 1.0 - ssim / count, sums.mse / count};
}

PhotometricTerms PhotometricLoss::evaluate(
    const Image& rendered, const Photo& photo, PhotometricWeights weights, Image& gradient
) {
  const Image& target = photo.rgb;
  const bool fits = rendered.size() == target.size() && rendered.size() == gradient.size() &&
                    rendered.channels() == 3 && target.channels() == 3 && gradient.channels() == 3;
  GLINT_CHECK(
      fits,
      kUsage,
      "photometric loss: render {}x{}, target {}x{}, both must be RGB of one size",
      rendered.width(),
      rendered.height(),
      target.width(),
      target.height()
  );
  PhotometricTerms terms =
      counted_.evaluate(rendered, photo, gradient, [&](const Image& picture, Image& dL_dpicture) {
        return evaluate_all(picture, target, weights, dL_dpicture);
      });
  if (!photo.all_count())
    terms.mse *= static_cast<double>(rendered.num_pixels()) /
                 sum_kernel(rendered.size(), SumPixels{photo.counted.on_device()});
  return terms;
}

PhotometricTerms PhotometricLoss::evaluate_all(
    const Image& rendered, const Image& target, PhotometricWeights weights, Image& gradient
) {
  width_ = rendered.width();
  height_ = rendered.height();
  if (on_gpu()) return evaluate_on_gpu(rendered, target, weights, gradient);
  stride_ = (static_cast<std::size_t>(width_) + 7) / 8 * 8;
  moments_.resize(5 * height_ * stride_);
  moment_gradients_.resize(3 * height_ * stride_);
  for (std::vector<double>* rows : {&row_ssim_, &row_l1_, &row_mse_}) rows->assign(height_, 0.0);
  for (int channel = 0; channel < 3; ++channel) {
    blur_rows(rendered, target, channel);
    ssim_rows();
    gradient_rows(rendered, target, channel, weights, gradient);
  }
  const double count = 3.0 * static_cast<double>(rendered.num_pixels());
  const double ssim = sum_of(row_ssim_);
  return {sum_of(row_l1_) / count, 1.0 - ssim / count, sum_of(row_mse_) / count};
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "metrics/lpips.h"

#include <algorithm>
#include <cmath>

#include "metrics/feature_net.h"
#include "metrics/lpips_formula.h"
#include "metrics/reduce.h"

namespace glint {
namespace {

// Where a position of the large image lies between two of the small one, pixel centres at 0.5.
struct Between {
  int low, high;
  double share;  // of high
};
Between between(int position, int large, int small) {
  const double at = std::max(0.0, (position + 0.5) * small / large - 0.5);
  const int low = std::min(static_cast<int>(at), small - 1);
  return {low, std::min(low + 1, small - 1), at - low};
}

void add_enlarged_row(const LpipsMap& tap, int y, LpipsMap& map) {
  const Between v = between(y, map.height(), tap.height());
  for (int x = 0; x < map.width(); ++x) {
    const Between u = between(x, map.width(), tap.width());
    const auto row = [&](int ty) {
      return std::lerp(tap.at(u.low, ty), tap.at(u.high, ty), u.share);
    };
    map.at(x, y) += std::lerp(row(v.low), row(v.high), v.share);
  }
}

double mean_of(const LpipsMap& map) {
  return *sum_pixels(map.size(), {}, [&](int x, int y) { return map.at(x, y); }).mean();
}

}  // namespace

Json lpips_provenance(const LpipsWeights& weights) {
  const bool known = !weights.version.empty();
  return {{"weights", known ? "LPIPS " + weights.version : "unknown"}, {"sha256", weights.sha256}};
}

class Lpips::Impl {
 public:
  Impl(std::shared_ptr<const LpipsWeights> weights, LpipsRange range)
      : weights_(std::move(weights)), range_(range) {}

  std::vector<LpipsMap> tap_maps(ImageView prediction, ImageView reference, bool clamp) {
    check_maps(prediction, reference, {}, 3);
    check_finite(prediction, ExitCode::kBadPrediction, "prediction");
    check_finite(reference, ExitCode::kBadReference, "reference");
    if (net_ == nullptr || net_->size() != reference.size())
      net_ = make_feature_net(weights_->steps, reference.size());
    feed(reference, false);
    keep_reference_taps();
    feed(prediction, clamp);
    std::vector<LpipsMap> maps;
    for (std::size_t i = 0; i < net_->num_taps(); ++i) maps.push_back(tap_map(i));
    return maps;
  }

  // After tap_maps().
  void add_gradient(float weight, ImageRef dL_dprediction) {
    const ImageView dL_dinput = net_->backward([&](std::size_t tap, ImageRef dL_dtap) {
      add_tap_gradient(tap, static_cast<double>(weight), dL_dtap);
    });
    for_each_row(dL_dinput.height, [&](int y) {
      for (int x = 0; x < dL_dinput.width; ++x)
        for (int c = 0; c < 3; ++c)
          dL_dprediction.at(x, y, c) += inputs(c).gain * dL_dinput.at(x, y, c);
    });
  }

  const LpipsWeights& weights() const { return *weights_; }
  LpipsRange range() const { return range_; }

 private:
  template <class F>
  static void for_each_row(int height, F&& row) {
    parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t y) {
      row(static_cast<int>(y));
    });
  }

  LpipsInput inputs(int channel) const {
    return lpips_input(range_ == LpipsRange::kSymmetric, channel);
  }

  void feed(ImageView image, bool clamp) {
    const ImageRef input = net_->input();
    for_each_row(image.height, [&](int y) {
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const float value = image.at(x, y, c);
          const LpipsInput to = inputs(c);
          input.at(x, y, c) = to.gain * (clamp ? std::clamp(value, 0.0f, 1.0f) : value) + to.offset;
        }
    });
    net_->forward();
  }

  void keep_reference_taps() {
    reference_.resize(net_->num_taps());
    for (std::size_t i = 0; i < reference_.size(); ++i) {
      const ImageView tap = net_->tap(i);
      reference_[i].assign(tap.data, tap.pixel(0, tap.height));
    }
  }

  ImageView reference_tap(std::size_t index) const {
    ImageView tap = net_->tap(index);
    tap.data = reference_[index].data();
    return tap;
  }

  LpipsMap tap_map(std::size_t index) const {
    const ImageView a = net_->tap(index), b = reference_tap(index);
    const float* lin = weights_->lin[index].data();
    LpipsMap map(a.width, a.height, 1);
    for_each_row(a.height, [&](int y) {
      for (int x = 0; x < a.width; ++x)
        map.at(x, y) = lpips_tap<double>(a.pixel(x, y), b.pixel(x, y), lin, a.channels);
    });
    return map;
  }

  void add_tap_gradient(std::size_t index, double weight, ImageRef dL_dtap) const {
    const ImageView a = net_->tap(index), b = reference_tap(index);
    const float* lin = weights_->lin[index].data();
    const double dL_dvalue = weight / static_cast<double>(a.num_pixels());
    for_each_row(a.height, [&](int y) {
      for (int x = 0; x < a.width; ++x)
        lpips_tap_vjp(
            a.pixel(x, y), b.pixel(x, y), lin, a.channels, dL_dvalue, dL_dtap.pixel(x, y)
        );
    });
  }

  std::shared_ptr<const LpipsWeights> weights_;
  LpipsRange range_;
  std::unique_ptr<FeatureNet> net_;            // for the size of the last images
  std::vector<std::vector<float>> reference_;  // its taps
};

Lpips::Lpips(std::shared_ptr<const LpipsWeights> weights, LpipsRange range)
    : impl_(std::make_unique<Impl>(std::move(weights), range)) {}
Lpips::~Lpips() = default;

std::vector<LpipsMap> Lpips::tap_maps(ImageView prediction, ImageView reference) {
  return impl_->tap_maps(prediction, reference, true);
}

double Lpips::distance(ImageView prediction, ImageView reference, MaskView mask) {
  check_same_shape(prediction, reference, mask);
  const std::optional<double> mean = lpips_mean(tap_maps(prediction, reference), mask);
  GLINT_CHECK(mean.has_value(), kBadReference, "no pixel to average LPIPS over: an empty mask");
  return *mean;
}

double Lpips::evaluate(ImageView rendered, ImageView target, float weight, ImageRef dL_drendered) {
  const double mean = lpips_mean(impl_->tap_maps(rendered, target, false));
  impl_->add_gradient(weight, dL_drendered);
  return mean;
}

bool Lpips::accepts(ImageSize size) const { return feature_net_accepts(weights().steps, size); }
const LpipsWeights& Lpips::weights() const { return impl_->weights(); }
LpipsRange Lpips::range() const { return impl_->range(); }

double lpips_mean(const std::vector<LpipsMap>& taps) {
  double sum = 0;
  for (const LpipsMap& tap : taps) sum += mean_of(tap);
  return sum;
}

LpipsMap lpips_map(const std::vector<LpipsMap>& taps, ImageSize size) {
  LpipsMap map(size.width, size.height, 1);
  parallel_for(static_cast<std::size_t>(size.height), 16, [&](std::size_t y) {
    for (const LpipsMap& tap : taps) add_enlarged_row(tap, static_cast<int>(y), map);
  });
  return map;
}

std::optional<double> lpips_mean(const std::vector<LpipsMap>& taps, MaskView mask) {
  if (mask.empty()) return lpips_mean(taps);
  const LpipsMap map = lpips_map(taps, mask.size());
  return sum_pixels(map.size(), mask, [&](int x, int y) { return map.at(x, y); }).mean();
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "metrics/lpips.h"

#include <algorithm>
#include <cmath>

#include "metrics/feature_net.h"
#include "metrics/lpips_kernels.h"
#include "metrics/lpips_targets.h"
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
  Impl(std::shared_ptr<const LpipsWeights> weights, LpipsRange range, std::size_t most_bytes)
      : weights_(std::move(weights)), range_(range), most_bytes_(most_bytes) {
    for (int c = 0; c < 3; ++c) inputs_[c] = lpips_input(range == LpipsRange::kSymmetric, c);
  }

  std::vector<LpipsMap> tap_maps(ImageView prediction, ImageView reference) {
    check_images(prediction, reference);
    fit_net(reference.size());
    const LpipsTaps& b = features(brought(reference), {});
    feed(brought(prediction), true);
    std::vector<LpipsMap> maps;
    for (std::size_t i = 0; i < net_->num_taps(); ++i) maps.push_back(tap_map(pair_at(i, b)));
    return maps;
  }

  double evaluate(
      const Image& rendered,
      const Image& target,
      float weight,
      Image& dL_drendered,
      std::optional<std::size_t> target_id
  ) {
    if (on_gpu())
      check_shapes(rendered, target);  // values: nobody waits for them
    else
      check_images(rendered, target);
    fit_net(rendered.size());
    const LpipsTaps& b = features(target.on_device(), target_id);
    feed(rendered.on_device(), false);
    const double mean = mean_distance(b);
    add_gradient(b, static_cast<double>(weight), dL_drendered.on_device());
    return mean;
  }

  const LpipsWeights& weights() const { return *weights_; }
  LpipsRange range() const { return range_; }
  std::size_t num_kept_targets() const { return targets_ ? targets_->num_kept() : 0; }

 private:
  static constexpr std::size_t kGrain = 1 << 10;  // pixels
  // For targets that are kept: a quarter of what is free, and bytes.
  static constexpr std::size_t kShareOfDevice = 4, kMostOnHost = std::size_t{1} << 30;

  static void check_images(ImageView prediction, ImageView reference) {
    check_maps(prediction, reference, {}, 3);
    check_finite(prediction, ExitCode::kBadPrediction, "prediction");
    check_finite(reference, ExitCode::kBadReference, "reference");
  }
  static void check_shapes(const Image& prediction, const Image& reference) {
    const bool fits = prediction.size() == reference.size() && prediction.channels() == 3 &&
                      reference.channels() == 3;
    GLINT_CHECK(fits, kBadPrediction, "LPIPS: two pictures of one size with 3 channels are needed");
  }

  // Nets and features are those of a device.
  void fit_net(ImageSize size) {
    if (net_ == nullptr || on_gpu() != net_on_gpu_) {
      net_on_gpu_ = on_gpu();
      const std::size_t room = on_gpu() ? device_room() / kShareOfDevice : kMostOnHost;
      targets_ = std::make_unique<LpipsTargets>(std::min(most_bytes_, room));
      lin_.clear();
      net_ = make_feature_net(weights_->steps, size);
    } else if (net_->size() != size && !net_->fit(size)) {
      net_ = make_feature_net(weights_->steps, size);
    }
  }

  // An image of the host where ops run, until the next one is.
  ImageView brought(ImageView image) {
    if (!on_gpu()) return image;
    glint::fit(brought_, image.size(), image.channels);
    std::copy_n(image.data, brought_.values().size(), brought_.data());
    return std::as_const(brought_).on_device();
  }

  void feed(ImageView image, bool clamp) {
    FeedLpips feed{image, {}, clamp, net_->input()};
    std::copy_n(inputs_, 3, feed.inputs);
    run_kernel(image.num_pixels(), kGrain, feed);
    net_->forward();
  }

  static std::size_t num_values(ImageView tap) {
    return tap.num_pixels() * static_cast<std::size_t>(tap.channels);
  }

  const LpipsTaps& features(ImageView reference, std::optional<std::size_t> id) {
    if (const LpipsTaps* kept = targets_->find(id)) return *kept;
    feed(reference, false);
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < net_->num_taps(); ++i)
      bytes += num_values(net_->tap(i)) * sizeof(float);
    LpipsTaps& place = targets_->place_for(id, bytes);
    place.resize(net_->num_taps());
    for (std::size_t i = 0; i < place.size(); ++i) {
      const ImageView tap = net_->tap(i);
      place[i].resize(num_values(tap));
      run_kernel(
          place[i].size(), kGrain, KeepFeatures{tap.data, place[i].device_for_overwriting()}
      );
    }
    return place;
  }

  // Filled up like the channels of taps.
  const float* lin(std::size_t index) {
    if (lin_.empty())
      for (const std::vector<float>& weights : weights_->lin) {
        const ImageView tap = net_->tap(lin_.size());
        FloatArray& lin = lin_.emplace_back(weights.begin(), weights.end());
        lin.resize(static_cast<std::size_t>(tap.channels));
      }
    return std::as_const(lin_[index]).on_device();
  }

  LpipsTapPair pair_at(std::size_t index, const LpipsTaps& reference) {
    LpipsTapPair pair{net_->tap(index), net_->tap(index), lin(index)};
    pair.b.data = reference[index].on_device();
    return pair;
  }

  static LpipsMap tap_map(const LpipsTapPair& pair) {
    LpipsMap map(pair.a.width, pair.a.height, 1);
    double* values = map.on_device();
    run_kernel(map.num_pixels(), kGrain, LpipsDistanceMap{pair, values});
    return map;
  }

  // Only told: in a silent step nobody asks.
  double mean_distance(const LpipsTaps& reference) {
    if (SilentStep::now()) return unknown<double>();
    double sum = 0;
    for (std::size_t i = 0; i < net_->num_taps(); ++i) {
      const LpipsTapPair pair = pair_at(i, reference);
      sum += sum_kernel(pair.a.size(), LpipsDistanceAt{pair}) /
             static_cast<double>(pair.a.num_pixels());
    }
    return sum;
  }

  void add_gradient(const LpipsTaps& reference, double weight, ImageRef dL_dimage) {
    const ImageView dL_dfed = net_->backward([&](std::size_t tap, ImageRef dL_dtap) {
      const LpipsTapPair pair = pair_at(tap, reference);
      const std::size_t count = pair.a.num_pixels();
      run_kernel(
          count, kGrain, LpipsDistanceVjp{pair, weight / static_cast<double>(count), dL_dtap}
      );
    });
    AddFedGradient add{dL_dfed, {}, dL_dimage};
    std::copy_n(inputs_, 3, add.inputs);
    run_kernel(dL_dfed.num_pixels(), kGrain, add);
  }

  std::shared_ptr<const LpipsWeights> weights_;
  LpipsRange range_;
  std::size_t most_bytes_;
  LpipsInput inputs_[3];
  std::unique_ptr<FeatureNet> net_;  // for the size of the last images
  bool net_on_gpu_ = false;
  std::unique_ptr<LpipsTargets> targets_;
  std::vector<FloatArray> lin_;
  Image brought_;
};

Lpips::Lpips(std::shared_ptr<const LpipsWeights> weights, LpipsRange range, std::size_t most_bytes)
    : impl_(std::make_unique<Impl>(std::move(weights), range, most_bytes)) {}
Lpips::~Lpips() = default;

std::vector<LpipsMap> Lpips::tap_maps(ImageView prediction, ImageView reference) {
  return impl_->tap_maps(prediction, reference);
}

double Lpips::distance(ImageView prediction, ImageView reference, MaskView mask) {
  check_same_shape(prediction, reference, mask);
  const std::optional<double> mean = lpips_mean(tap_maps(prediction, reference), mask);
  GLINT_CHECK(mean.has_value(), kBadReference, "no pixel to average LPIPS over: an empty mask");
  return *mean;
}

double Lpips::evaluate(
    const Image& rendered,
    const Image& target,
    float weight,
    Image& dL_drendered,
    std::optional<std::size_t> target_id
) {
  return impl_->evaluate(rendered, target, weight, dL_drendered, target_id);
}

std::size_t Lpips::num_kept_targets() const { return impl_->num_kept_targets(); }
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

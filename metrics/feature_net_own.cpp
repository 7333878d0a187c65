// SPDX-License-Identifier: MIT
// Networks by kernels of our own. Channels are filled up to fours with zeros, in weights, too.
#include <algorithm>
#include <array>

#include "metrics/feature_net_backends.h"
#include "metrics/feature_net_kernels.h"

namespace glint {
namespace {

constexpr std::size_t kGrain = 1 << 12;       // values a thread of the CPU takes at once
constexpr std::size_t kBlocksThatFill = 200;  // a large GPU

int in_fours(int channels) { return (channels + 3) / 4 * 4; }

std::size_t num_values(ImageSize size, int channels) {
  return size.num_pixels() * static_cast<std::size_t>(channels);
}

void convolve(
    const FeatureWindows& windows,
    const float* in,
    const float* weight,
    const float* bias,
    float* out
) {
  using Large = ConvolveTile<LargeFeatureTile>;
  using Small = ConvolveTile<SmallFeatureTile>;
  if (const std::size_t blocks = Large::num_blocks(windows); blocks >= kBlocksThatFill)
    run_block_kernel(blocks, Large{windows, in, weight, bias, out});
  else
    run_block_kernel(Small::num_blocks(windows), Small{windows, in, weight, bias, out});
}

// A step for images of one size at a time.
class OwnLayer {
 public:
  explicit OwnLayer(const FeatureStep& step)
      : windows_{
            {},
            {},
            in_fours(step.in_channels),
            in_fours(step.out_channels),
            step.kernel,
            step.stride,
            step.padding} {}
  virtual ~OwnLayer() = default;

  virtual void fit(ImageSize in, ImageSize out) {
    windows_.in = in, windows_.out = out;
    output_.resize(num_outputs());
  }
  virtual void forward(const float* in) = 0;
  // After forward(). Changes dL_dout.
  virtual void backward(float* dL_dout, float* dL_din) = 0;

  ImageSize size() const { return windows_.out; }
  int channels() const { return windows_.out_channels; }
  std::size_t num_inputs() const { return num_values(windows_.in, windows_.in_channels); }
  std::size_t num_outputs() const { return num_values(windows_.out, windows_.out_channels); }
  const float* output() const { return output_.on_device(); }

 protected:
  FeatureWindows windows_;
  FloatArray output_;
};

// With bias and ReLU.
class OwnConvolution final : public OwnLayer {
 public:
  explicit OwnConvolution(const FeatureStep& step)
      : OwnLayer(step),
        step_(step),
        weight_(forward_weights()),
        bias_(step.bias.begin(), step.bias.end()) {
    bias_.resize(static_cast<std::size_t>(windows_.out_channels));
  }

  void forward(const float* in) override {
    convolve(
        windows_, in, weight_.on_device(), bias_.on_device(), output_.device_for_overwriting()
    );
  }

  void backward(float* dL_dout, float* dL_din) override {
    make_weight_back();
    run_kernel(num_outputs(), kGrain, ReluVjp{output(), dL_dout});
    if (gathers())
      run_kernel(
          num_inputs() / 4,
          kGrain / 64,
          GatherConvolutionVjp{windows_, weight_back_.on_device(), dL_dout, dL_din}
      );
    else
      convolve(transposed(), dL_dout, weight_back_.on_device(), nullptr, dL_din);
  }

 private:
  // Tiles are for many channels, and for inputs that all windows reach alike.
  bool gathers() const { return windows_.stride > 1 || windows_.in_channels == 4; }

  // Of stride 1, back from the output to the input: a convolution with the window turned around.
  FeatureWindows transposed() const {
    FeatureWindows back = windows_;
    std::swap(back.in, back.out);
    std::swap(back.in_channels, back.out_channels);
    back.padding = windows_.kernel - 1 - windows_.padding;
    return back;
  }

  // Only a training asks.
  void make_weight_back() {
    if (!weight_back_.empty()) return;
    weight_back_ = backward_weights();
    step_.weight = {};
  }

  // f(place in the window, input, output, weight)
  template <class F>
  void for_each_weight(F&& f) const {
    const auto inputs = static_cast<std::size_t>(step_.in_channels);
    for (std::size_t i = 0; i < step_.weight.size(); ++i)
      f(i % places(), i / places() % inputs, i / places() / inputs, step_.weight[i]);
  }
  std::size_t places() const { return static_cast<std::size_t>(step_.kernel * step_.kernel); }

  // [place][input][output]
  FloatArray forward_weights() const {
    const auto inputs = static_cast<std::size_t>(windows_.in_channels);
    const auto outputs = static_cast<std::size_t>(windows_.out_channels);
    FloatArray weights(places() * inputs * outputs);
    float* values = weights.data();
    for_each_weight([&](std::size_t place, std::size_t i, std::size_t o, float value) {
      values[(place * inputs + i) * outputs + o] = value;
    });
    return weights;
  }

  // [place][output][input], the window turned around where it is used as one.
  FloatArray backward_weights() const {
    const auto inputs = static_cast<std::size_t>(windows_.in_channels);
    const auto outputs = static_cast<std::size_t>(windows_.out_channels);
    FloatArray weights(places() * inputs * outputs);
    float* values = weights.data();
    for_each_weight([&](std::size_t place, std::size_t i, std::size_t o, float value) {
      const std::size_t at = gathers() ? place : places() - 1 - place;
      values[(at * outputs + o) * inputs + i] = value;
    });
    return weights;
  }

  FeatureStep step_;
  FloatArray weight_, weight_back_, bias_;
};

class OwnPooling final : public OwnLayer {
 public:
  using OwnLayer::OwnLayer;

  void fit(ImageSize in, ImageSize out) override {
    OwnLayer::fit(in, out);
    place_.resize(num_outputs());
  }
  void forward(const float* in) override {
    run_kernel(
        num_outputs(),
        kGrain,
        MaxPool{windows_, in, output_.device_for_overwriting(), place_.device_for_overwriting()}
    );
  }
  void backward(float* dL_dout, float* dL_din) override {
    run_kernel(num_inputs(), kGrain, MaxPoolVjp{windows_, place_.on_device(), dL_dout, dL_din});
  }

 private:
  Array<unsigned char> place_;
};

std::unique_ptr<OwnLayer> make_layer(const FeatureStep& step) {
  if (step.pools) return std::make_unique<OwnPooling>(step);
  return std::make_unique<OwnConvolution>(step);
}

class OwnNet final : public FeatureNet {
 public:
  OwnNet(const std::vector<FeatureStep>& steps, ImageSize size) {
    for (const FeatureStep& step : steps) {
      if (step.tap) taps_.push_back(layers_.size());
      layers_.push_back(make_layer(step));
      shapes_.push_back(step);
      shapes_.back().weight.clear();
    }
    fit(size);
  }

  ImageSize size() const override { return input_.size(); }
  bool fit(ImageSize size) override {
    if (size == input_.size()) return true;
    std::vector<ImageSize> sizes{size};
    for (const FeatureStep& shape : shapes_)
      sizes.push_back(detail::checked_out_size(sizes.back(), shape));
    std::size_t largest = num_values(size, kInputChannels);
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      layers_[i]->fit(sizes[i], sizes[i + 1]);
      largest = std::max(largest, layers_[i]->num_outputs());
    }
    for (FloatArray& gradient : gradients_) gradient.resize(largest);
    FloatArray values = std::move(input_.array());
    values.resize(num_values(size, kInputChannels));
    values.fill(0);  // the channel that nobody fills
    input_ = Image(size.width, size.height, kInputChannels, std::move(values));
    return true;
  }

  ImageRef input() override { return input_.on_device(); }
  std::size_t num_taps() const override { return taps_.size(); }
  ImageView tap(std::size_t index) const override {
    const OwnLayer& layer = *layers_[taps_[index]];
    return {layer.output(), layer.size().width, layer.size().height, layer.channels()};
  }

  void forward() override {
    const float* in = std::as_const(input_).array().on_device();
    for (const auto& layer : layers_) {
      layer->forward(in);
      in = layer->output();
    }
  }

  ImageView backward(const AddTapGradient& add_tap_gradient) override {
    gradients_[0].fill(0);
    float* current = gradients_[0].on_device();
    float* next = gradients_[1].device_for_overwriting();
    std::size_t tap = taps_.size();
    for (std::size_t i = layers_.size(); i-- > 0;) {
      OwnLayer& layer = *layers_[i];
      if (tap > 0 && taps_[tap - 1] == i)
        add_tap_gradient(
            --tap, {current, layer.size().width, layer.size().height, layer.channels()}
        );
      layer.backward(current, next);
      std::swap(current, next);
    }
    return {current, size().width, size().height, kInputChannels};
  }

 private:
  static constexpr int kInputChannels = 4;
  std::vector<FeatureStep> shapes_;  // without weights
  std::vector<std::unique_ptr<OwnLayer>> layers_;
  std::vector<std::size_t> taps_;  // layers
  Image input_;
  std::array<FloatArray, 2> gradients_;
};

}  // namespace

std::unique_ptr<FeatureNet> detail::make_own_net(
    const std::vector<FeatureStep>& steps, ImageSize size
) {
  return std::make_unique<OwnNet>(steps, size);
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// Networks by cuDNN, 8 or later, in single precision without tensor cores: values are compared with
// published ones. Inside, features are planes [channels][H][W], which every algorithm takes.
#include <cudnn.h>

#include <algorithm>
#include <array>
#include <utility>

#include "glint/core/device.h"
#include "glint/core/error.h"
#include "metrics/feature_net_backends.h"

static_assert(CUDNN_MAJOR >= 8, "cuDNN 8 or later is needed");

namespace glint {
namespace {

void check(cudnnStatus_t status, const char* what) {
  GLINT_CHECK(
      status == CUDNN_STATUS_SUCCESS,
      kEnvironment,
      "LPIPS: cuDNN reports '{}' ({})",
      cudnnGetErrorString(status),
      what
  );
}

template <class T, cudnnStatus_t (*Create)(T*), cudnnStatus_t (*Destroy)(T)>
class Owned {
 public:
  Owned() { check(Create(&object_), "making an object"); }
  ~Owned() { Destroy(object_); }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  operator T() const { return object_; }

 private:
  T object_{};
};

using Handle = Owned<cudnnHandle_t, cudnnCreate, cudnnDestroy>;
using FilterShape =
    Owned<cudnnFilterDescriptor_t, cudnnCreateFilterDescriptor, cudnnDestroyFilterDescriptor>;
using ConvolutionShape = Owned<
    cudnnConvolutionDescriptor_t,
    cudnnCreateConvolutionDescriptor,
    cudnnDestroyConvolutionDescriptor>;
using PoolingShape =
    Owned<cudnnPoolingDescriptor_t, cudnnCreatePoolingDescriptor, cudnnDestroyPoolingDescriptor>;
using Activation = Owned<
    cudnnActivationDescriptor_t,
    cudnnCreateActivationDescriptor,
    cudnnDestroyActivationDescriptor>;

// One picture of features and how it lies in memory.
class Layout : public Owned<
                   cudnnTensorDescriptor_t,
                   cudnnCreateTensorDescriptor,
                   cudnnDestroyTensorDescriptor> {
 public:
  Layout(ImageSize size, int channels, cudnnTensorFormat_t format) {
    check(
        cudnnSetTensor4dDescriptor(
            *this, format, CUDNN_DATA_FLOAT, 1, channels, size.height, size.width
        ),
        "describing features"
    );
  }
  // The top left part of planes of another size.
  Layout(ImageSize size, int channels, ImageSize of) {
    const int plane = of.width * of.height;
    check(
        cudnnSetTensor4dDescriptorEx(
            *this,
            CUDNN_DATA_FLOAT,
            1,
            channels,
            size.height,
            size.width,
            channels * plane,
            plane,
            of.width,
            1
        ),
        "describing a part of features"
    );
  }
};

struct Planes : Layout {
  Planes(ImageSize size, int channels) : Layout(size, channels, CUDNN_TENSOR_NCHW) {}
};
struct Pixels : Layout {
  Pixels(ImageSize size, int channels) : Layout(size, channels, CUDNN_TENSOR_NHWC) {}
};

constexpr float kOne = 1, kZero = 0;

// to = from + keep * to, each in its own layout.
void copy(
    const Handle& cudnn,
    const Layout& from_layout,
    const float* from,
    float keep,
    const Layout& to_layout,
    float* to
) {
  check(
      cudnnTransformTensor(cudnn, &kOne, from_layout, from, &keep, to_layout, to),
      "reordering features"
  );
}

std::size_t num_values(ImageSize size, int channels) {
  return size.num_pixels() * static_cast<std::size_t>(channels);
}

// A step for images of one size.
class Layer {
 public:
  Layer(const FeatureStep& step, ImageSize in)
      : in_(in),
        out_(detail::checked_out_size(in, step)),
        channels_(step.out_channels),
        in_layout_(in, step.in_channels),
        out_layout_(out_, channels_),
        output_(num_values(out_, channels_)) {}
  virtual ~Layer() = default;

  virtual void forward(const Handle& cudnn, const float* input) = 0;
  // After forward(). Changes dL_doutput.
  virtual void backward(const Handle& cudnn, float* dL_doutput, float* dL_dinput) = 0;

  ImageSize size() const { return out_; }
  const Layout& layout() const { return out_layout_; }
  const float* output() const { return output_.device_for_reading(); }

 protected:
  ImageSize in_, out_;
  int channels_;
  Planes in_layout_, out_layout_;
  FloatArray output_;
};

// Of the algorithms that cuDNN proposes for these shapes, fastest first, the first that gives the
// same bytes twice.
template <class Proposal, int kMost, class Query, class... Shapes>
Proposal best_proposal(Query query, const Handle& cudnn, const Shapes&... shapes) {
  constexpr std::size_t kMostBytes = std::size_t{512} << 20;  // of workspace, beside a training
  std::array<Proposal, kMost> proposals{};
  int count = 0;
  check(
      query(cudnn, shapes..., kMost, &count, proposals.data()), "choosing a convolution's algorithm"
  );
  const auto end = proposals.begin() + count;
  const auto best = std::find_if(proposals.begin(), end, [](const Proposal& p) {
    return p.status == CUDNN_STATUS_SUCCESS && p.determinism == CUDNN_DETERMINISTIC &&
           p.memory <= kMostBytes &&
           (p.mathType == CUDNN_DEFAULT_MATH || p.mathType == CUDNN_FMA_MATH);
  });
  GLINT_CHECK(best != end, kEnvironment, "LPIPS: cuDNN has no algorithm for a convolution");
  return *best;
}

// With bias and ReLU.
class Convolution final : public Layer {
 public:
  Convolution(const Handle& cudnn, const FeatureStep& step, ImageSize in)
      : Layer(step, in),
        bias_layout_({1, 1}, channels_),
        weight_(step.weight.begin(), step.weight.end()),
        bias_(step.bias.begin(), step.bias.end()) {
    describe(step);
    choose_algorithms(cudnn);
  }

  void forward(const Handle& cudnn, const float* input) override {
    check(
        cudnnConvolutionForward(
            cudnn,
            &kOne,
            in_layout_,
            input,
            filter_,
            weight_.device_for_reading(),
            convolution_,
            forward_,
            workspace_.device_for_overwriting(),
            workspace_.size(),
            &kZero,
            out_layout_,
            output_.device_for_writing()
        ),
        "convolution"
    );
    check(
        cudnnAddTensor(
            cudnn,
            &kOne,
            bias_layout_,
            bias_.device_for_reading(),
            &kOne,
            out_layout_,
            output_.device_for_writing()
        ),
        "bias"
    );
    check(
        cudnnActivationForward(
            cudnn,
            relu_,
            &kOne,
            out_layout_,
            output_.device_for_writing(),
            &kZero,
            out_layout_,
            output_.device_for_writing()
        ),
        "ReLU"
    );
  }

  void backward(const Handle& cudnn, float* dL_doutput, float* dL_dinput) override {
    check(
        cudnnActivationBackward(
            cudnn,
            relu_,
            &kOne,
            out_layout_,
            output_.device_for_writing(),
            out_layout_,
            dL_doutput,
            out_layout_,
            output_.device_for_writing(),  // positive where its input is
            &kZero,
            out_layout_,
            dL_doutput
        ),
        "gradient of ReLU"
    );
    check(
        cudnnConvolutionBackwardData(
            cudnn,
            &kOne,
            filter_,
            weight_.device_for_reading(),
            out_layout_,
            dL_doutput,
            convolution_,
            backward_,
            workspace_.device_for_overwriting(),
            workspace_.size(),
            &kZero,
            in_layout_,
            dL_dinput
        ),
        "gradient of a convolution"
    );
  }

 private:
  void describe(const FeatureStep& step) {
    check(
        cudnnSetFilter4dDescriptor(
            filter_,
            CUDNN_DATA_FLOAT,
            CUDNN_TENSOR_NCHW,
            step.out_channels,
            step.in_channels,
            step.kernel,
            step.kernel
        ),
        "describing weights"
    );
    check(
        cudnnSetConvolution2dDescriptor(
            convolution_,
            step.padding,
            step.padding,
            step.stride,
            step.stride,
            1,
            1,
            CUDNN_CROSS_CORRELATION,
            CUDNN_DATA_FLOAT
        ),
        "describing a convolution"
    );
    check(cudnnSetConvolutionMathType(convolution_, CUDNN_FMA_MATH), "choosing single precision");
    check(
        cudnnSetActivationDescriptor(relu_, CUDNN_ACTIVATION_RELU, CUDNN_PROPAGATE_NAN, 0),
        "describing ReLU"
    );
  }

  void choose_algorithms(const Handle& cudnn) {
    const auto there =
        best_proposal<cudnnConvolutionFwdAlgoPerf_t, CUDNN_CONVOLUTION_FWD_ALGO_COUNT>(
            cudnnGetConvolutionForwardAlgorithm_v7,
            cudnn,
            in_layout_,
            filter_,
            convolution_,
            out_layout_
        );
    const auto back =
        best_proposal<cudnnConvolutionBwdDataAlgoPerf_t, CUDNN_CONVOLUTION_BWD_DATA_ALGO_COUNT>(
            cudnnGetConvolutionBackwardDataAlgorithm_v7,
            cudnn,
            filter_,
            out_layout_,
            convolution_,
            in_layout_
        );
    forward_ = there.algo;
    backward_ = back.algo;
    workspace_.resize(std::max(there.memory, back.memory));
  }

  FilterShape filter_;
  ConvolutionShape convolution_;
  Activation relu_;
  Planes bias_layout_;
  FloatArray weight_, bias_;
  Array<unsigned char> workspace_;
  cudnnConvolutionFwdAlgo_t forward_{};
  cudnnConvolutionBwdDataAlgo_t backward_{};
};

// Of features that are not negative, as ReLU leaves them: windows that reach beyond the image,
// which cuDNN does not know, see zeros there, which change no maximum.
class MaxPool final : public Layer {
 public:
  MaxPool(const FeatureStep& step, ImageSize in)
      : Layer(step, in),
        wide_(widened(step)),
        wide_layout_(wide_, channels_),
        inside_(in, channels_, wide_),
        wide_input_(num_values(wide_, channels_)),
        dL_dwide_(wide_input_.size()) {
    check(
        cudnnSetPooling2dDescriptor(
            pooling_,
            CUDNN_POOLING_MAX_DETERMINISTIC,
            CUDNN_PROPAGATE_NAN,
            step.kernel,
            step.kernel,
            step.padding,
            step.padding,
            step.stride,
            step.stride
        ),
        "describing pooling"
    );
  }

  void forward(const Handle& cudnn, const float* input) override {
    copy(cudnn, in_layout_, input, 0, inside_, wide_input_.device_for_writing());
    check(
        cudnnPoolingForward(
            cudnn,
            pooling_,
            &kOne,
            wide_layout_,
            wide_input_.device_for_writing(),
            &kZero,
            out_layout_,
            output_.device_for_writing()
        ),
        "pooling"
    );
  }

  void backward(const Handle& cudnn, float* dL_doutput, float* dL_dinput) override {
    check(
        cudnnPoolingBackward(
            cudnn,
            pooling_,
            &kOne,
            out_layout_,
            output_.device_for_writing(),
            out_layout_,
            dL_doutput,
            wide_layout_,
            wide_input_.device_for_writing(),
            &kZero,
            wide_layout_,
            dL_dwide_.device_for_writing()
        ),
        "gradient of pooling"
    );
    copy(cudnn, inside_, dL_dwide_.device_for_writing(), 0, in_layout_, dL_dinput);
  }

 private:
  ImageSize widened(const FeatureStep& step) const {
    const ImageSize beyond = detail::end_padding(in_, out_, step);
    return {
        in_.width + std::max(0, beyond.width - step.padding),
        in_.height + std::max(0, beyond.height - step.padding)};
  }

  PoolingShape pooling_;
  ImageSize wide_;
  Planes wide_layout_;
  Layout inside_;
  FloatArray wide_input_, dL_dwide_;
};

// A tap as metrics read it, and its gradient as they write it.
struct Tap {
  std::size_t layer;
  Pixels layout;
  Image features, gradient;
};

class CudnnNet final : public FeatureNet {
 public:
  CudnnNet(const std::vector<FeatureStep>& steps, ImageSize size)
      : pixels_(size, 3),
        planes_(size, 3),
        input_(size.width, size.height, 3),
        dL_dinput_(size.width, size.height, 3),
        input_planes_(input_.values().size()) {
    std::size_t largest = input_planes_.size();
    for (const FeatureStep& step : steps) {
      add(step, layers_.empty() ? size : layers_.back()->size());
      largest = std::max(largest, num_values(layers_.back()->size(), step.out_channels));
    }
    for (FloatArray& gradient : gradients_) gradient.resize(largest);
  }

  ImageSize size() const override { return input_.size(); }
  ImageRef input() override { return input_.ref(); }
  std::size_t num_taps() const override { return taps_.size(); }
  ImageView tap(std::size_t index) const override { return taps_[index]->features; }

  void forward() override {
    copy(cudnn_, pixels_, input_.on_device(), 0, planes_, input_planes_.on_device());
    for (std::size_t i = 0; i < layers_.size(); ++i) layers_[i]->forward(cudnn_, input_of(i));
    for (const auto& tap : taps_) {
      const Layer& layer = *layers_[tap->layer];
      copy(cudnn_, layer.layout(), layer.output(), 0, tap->layout, tap->features.on_device());
    }
  }

  ImageView backward(const AddTapGradient& add_tap_gradient) override {
    for (std::size_t i = taps_.size(); i-- > 0;) {
      Image& gradient = taps_[i]->gradient;
      std::fill(gradient.values().begin(), gradient.values().end(), 0.0f);
      add_tap_gradient(i, gradient.ref());
    }
    gradients_[0].fill(0);
    float *current = gradients_[0].on_device(), *next = gradients_[1].on_device();
    std::size_t tap = taps_.size();
    for (std::size_t i = layers_.size(); i-- > 0; std::swap(current, next)) {
      if (tap > 0 && taps_[tap - 1]->layer == i) add_gradient(*taps_[--tap], current);
      layers_[i]->backward(cudnn_, current, next);
    }
    copy(cudnn_, planes_, current, 0, pixels_, dL_dinput_.on_device());
    return std::as_const(dL_dinput_);
  }

 private:
  void add(const FeatureStep& step, ImageSize in) {
    if (step.pools)
      layers_.push_back(std::make_unique<MaxPool>(step, in));
    else
      layers_.push_back(std::make_unique<Convolution>(cudnn_, step, in));
    if (!step.tap) return;
    const ImageSize out = layers_.back()->size();
    const Image blank(out.width, out.height, step.out_channels);
    taps_.emplace_back(new Tap{layers_.size() - 1, Pixels(out, step.out_channels), blank, blank});
  }

  const float* input_of(std::size_t layer) const {
    return layer == 0 ? input_planes_.device_for_reading() : layers_[layer - 1]->output();
  }

  void add_gradient(const Tap& tap, float* planes) {
    copy(cudnn_, tap.layout, tap.gradient.on_device(), 1, layers_[tap.layer]->layout(), planes);
  }

  Handle cudnn_;
  Pixels pixels_;
  Planes planes_;
  Image input_, dL_dinput_;
  FloatArray input_planes_;
  std::vector<std::unique_ptr<Layer>> layers_;
  std::vector<std::unique_ptr<Tap>> taps_;
  FloatArray gradients_[2];
};

}  // namespace

std::unique_ptr<FeatureNet> detail::make_cudnn_net(
    const std::vector<FeatureStep>& steps, ImageSize size
) {
  return std::make_unique<CudnnNet>(steps, size);
}

std::string detail::cudnn_version() {
  const std::size_t version = cudnnGetVersion();
  const std::size_t thousands =
      version >= 90000 ? 10000 : 1000;  // of a major version, by cuDNN's own
  return fmt::format("{}.{}.{}", version / thousands, version % thousands / 100, version % 100);
}

}  // namespace glint

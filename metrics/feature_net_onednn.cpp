// SPDX-License-Identifier: MIT
#include <omp.h>

#include <fmt/format.h>

#include <algorithm>
#include <oneapi/dnnl/dnnl.hpp>
#include <unordered_map>

#include "glint/core/parallel.h"
#include "metrics/feature_net_backends.h"
#include "metrics/feature_net_kernels.h"

namespace glint {
namespace {

using dnnl::memory;
using Tag = memory::format_tag;
using Dims = memory::dims;

memory::desc plain(const Dims& dims, Tag tag) { return {dims, memory::data_type::f32, tag}; }
memory::desc any_order(const Dims& dims) { return plain(dims, Tag::any); }

Dims feature_dims(ImageSize size, int channels) { return {1, channels, size.height, size.width}; }
memory::desc features(ImageSize size, int channels) {
  return plain(feature_dims(size, channels), Tag::nhwc);
}

using Arguments = std::unordered_map<int, memory>;

// What a step reads, writes and was compiled to.
struct Stage {
  ImageSize in, out;
  int in_channels, out_channels;
  bool pools, tap;
  memory dst;
  dnnl::primitive forward, backward;
  Arguments forward_arguments, backward_arguments;  // without those that all stages have
};

// {rows, columns}
Dims padding_after(const FeatureStep& step, const Stage& stage) {
  const ImageSize padding = detail::end_padding(stage.in, stage.out, step);
  return {padding.height, padding.width};
}

class Compiler {
 public:
  Compiler(const dnnl::engine& engine, dnnl::stream& stream) : engine_(engine), stream_(stream) {}

  Stage compile(const FeatureStep& step, ImageSize in) {
    Stage stage{
        in,
        detail::checked_out_size(in, step),
        step.in_channels,
        step.out_channels,
        step.pools,
        step.tap};
    if (step.pools)
      compile_pooling(step, stage);
    else
      compile_convolution(step, stage);
    return stage;
  }

 private:
  void compile_pooling(const FeatureStep& step, Stage& stage) {
    using Forward = dnnl::pooling_forward;
    using Backward = dnnl::pooling_backward;
    const memory::desc src = features(stage.in, stage.in_channels);
    const memory::desc dst = features(stage.out, stage.out_channels);
    const Dims strides{step.stride, step.stride}, kernel{step.kernel, step.kernel};
    const Dims begin{step.padding, step.padding}, end = padding_after(step, stage);
    const auto algorithm = dnnl::algorithm::pooling_max;
    const Forward::primitive_desc forward(
        {dnnl::prop_kind::forward_training, algorithm, src, dst, strides, kernel, begin, end},
        engine_
    );
    const Backward::primitive_desc backward(
        {algorithm, src, dst, strides, kernel, begin, end}, engine_, forward
    );
    const memory workspace(forward.workspace_desc(), engine_);  // where each maximum was
    stage.dst = memory(dst, engine_);
    stage.forward = Forward(forward);
    stage.backward = Backward(backward);
    stage.forward_arguments = {{DNNL_ARG_WORKSPACE, workspace}};
    stage.backward_arguments = {{DNNL_ARG_WORKSPACE, workspace}};
  }

  void compile_convolution(const FeatureStep& step, Stage& stage) {
    using Forward = dnnl::convolution_forward;
    using Backward = dnnl::convolution_backward_data;
    const memory::desc src = features(stage.in, stage.in_channels);
    const memory::desc dst = features(stage.out, stage.out_channels);
    const Dims weight_dims{step.out_channels, step.in_channels, step.kernel, step.kernel};
    const memory::desc bias = plain({step.out_channels}, Tag::x);
    const Dims strides{step.stride, step.stride};
    const Dims begin{step.padding, step.padding}, end = padding_after(step, stage);
    const auto algorithm = dnnl::algorithm::convolution_direct;

    dnnl::post_ops relu;
    relu.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
    dnnl::primitive_attr with_relu;
    with_relu.set_post_ops(relu);
    const memory::desc weight = any_order(weight_dims);
    const Forward::primitive_desc forward(
        {dnnl::prop_kind::forward_inference,
         algorithm,
         src,
         weight,
         bias,
         dst,
         strides,
         begin,
         end},
        with_relu,
        engine_
    );
    // What backward asks for as a hint has no ReLU: that one's gradient is applied before.
    const Forward::primitive_desc hint(
        {dnnl::prop_kind::forward_training, algorithm, src, weight, bias, dst, strides, begin, end},
        engine_
    );
    const Backward::primitive_desc backward(
        {algorithm, src, weight, dst, strides, begin, end}, engine_, hint
    );
    stage.dst = memory(dst, engine_);
    stage.forward = Forward(forward);
    stage.backward = Backward(backward);
    stage.forward_arguments = {
        {DNNL_ARG_WEIGHTS, reordered(step.weight, weight_dims, forward.weights_desc())},
        {DNNL_ARG_BIAS, copied(step.bias, bias)}};
    stage.backward_arguments = {
        {DNNL_ARG_WEIGHTS, reordered(step.weight, weight_dims, backward.weights_desc())}};
  }

  memory copied(const std::vector<float>& values, const memory::desc& desc) {
    const memory result(desc, engine_);
    std::copy(values.begin(), values.end(), static_cast<float*>(result.get_data_handle()));
    return result;
  }

  memory reordered(const std::vector<float>& values, const Dims& dims, const memory::desc& wanted) {
    memory from(
        plain(dims, Tag::oihw), engine_, const_cast<float*>(values.data())  // only read
    );
    memory to(wanted, engine_);
    dnnl::reorder(from, to).execute(stream_, from, to);
    stream_.wait();
    return to;
  }

  const dnnl::engine& engine_;
  dnnl::stream& stream_;
};

class OneDnnNet final : public FeatureNet {
 public:
  OneDnnNet(const std::vector<FeatureStep>& steps, ImageSize size)
      : size_(size),
        engine_(dnnl::engine::kind::cpu, 0),
        stream_(engine_),
        input_(features(size, 3), engine_) {
    Compiler compiler(engine_, stream_);
    std::size_t largest = 3 * size.num_pixels();
    for (const FeatureStep& step : steps) {
      stages_.push_back(compiler.compile(step, stages_.empty() ? size : stages_.back().out));
      if (step.tap) taps_.push_back(stages_.size() - 1);
      largest = std::max(
          largest, stages_.back().out.num_pixels() * static_cast<std::size_t>(step.out_channels)
      );
    }
    largest_ = largest;
  }

  ImageSize size() const override { return size_; }
  ImageRef input() override { return {data_of(input_), size_.width, size_.height, 3}; }
  std::size_t num_taps() const override { return taps_.size(); }
  ImageView tap(std::size_t index) const override { return output(stages_[taps_[index]]); }

  void forward() override {
    const memory* src = &input_;
    for (Stage& stage : stages_) {
      Arguments arguments = stage.forward_arguments;
      arguments.insert({{DNNL_ARG_SRC, *src}, {DNNL_ARG_DST, stage.dst}});
      execute(stage.forward, arguments);
      src = &stage.dst;
    }
  }

  ImageView backward(const AddTapGradient& add_tap_gradient) override {
    for (auto& gradient : gradients_) gradient.resize(largest_);
    float *current = gradients_[0].data(), *next = gradients_[1].data();
    std::fill_n(current, largest_, 0.0f);
    std::size_t tap = taps_.size();
    for (auto stage = stages_.rbegin(); stage != stages_.rend(); ++stage) {
      if (stage->tap)
        add_tap_gradient(
            --tap, {current, stage->out.width, stage->out.height, stage->out_channels}
        );
      if (!stage->pools) apply_relu_vjp(output(*stage), current);
      backward(*stage, current, next);
      std::swap(current, next);
    }
    return {current, size_.width, size_.height, 3};
  }

 private:
  static float* data_of(const memory& block) {
    return static_cast<float*>(block.get_data_handle());
  }
  static ImageView output(const Stage& stage) {
    return {data_of(stage.dst), stage.out.width, stage.out.height, stage.out_channels};
  }

  static void apply_relu_vjp(ImageView output, float* gradient) {
    const std::size_t count = output.num_pixels() * static_cast<std::size_t>(output.channels);
    run_kernel(count, 1 << 16, ReluVjp{output.data, gradient});
  }

  void backward(Stage& stage, float* dL_dout, float* dL_din) {
    Arguments arguments = stage.backward_arguments;
    arguments.insert(
        {{DNNL_ARG_DIFF_DST, memory(features(stage.out, stage.out_channels), engine_, dL_dout)},
         {DNNL_ARG_DIFF_SRC, memory(features(stage.in, stage.in_channels), engine_, dL_din)}}
    );
    execute(stage.backward, arguments);
  }

  void execute(dnnl::primitive& primitive, const Arguments& arguments) {
    omp_set_num_threads(num_threads());  // oneDNN's threads; of this thread's loops only
    primitive.execute(stream_, arguments);
    stream_.wait();
  }

  ImageSize size_;
  dnnl::engine engine_;
  dnnl::stream stream_;
  memory input_;
  std::vector<Stage> stages_;
  std::vector<std::size_t> taps_;  // stages
  std::size_t largest_ = 0;        // values of a stage's output
  std::vector<float> gradients_[2];
};

std::unique_ptr<FeatureNet> make_net(const std::vector<FeatureStep>& steps, ImageSize size) {
  return std::make_unique<OneDnnNet>(steps, size);
}

std::string version_text() {
  const dnnl_version_t* version = dnnl_version();
  return fmt::format("{}.{}.{}", version->major, version->minor, version->patch);
}

}  // namespace

GLINT_PROVIDE(make_onednn_net, make_net)
GLINT_PROVIDE(onednn_version, version_text)

}  // namespace glint

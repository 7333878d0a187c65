// SPDX-License-Identifier: MIT
// cuDNN's operations as plain loops over strided tensors, and its checks of shapes, so that calls
// it would refuse fail here too. Sums in double.
#include <cudnn.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace glint::test {
bool cudnn_fails = false;  // there is no handle then, as without a driver
int cudnn_handles = 0;     // made so far
}  // namespace glint::test

struct cudnnContext {};
struct cudnnTensorStruct {
  std::array<int, 4> extent{}, stride{};  // n c h w
};
struct cudnnFilterStruct {
  int out = 0, in = 0, height = 0, width = 0;
};
struct cudnnConvolutionStruct {
  int pad = 0, step = 0;
};
struct cudnnPoolingStruct {
  int window = 0, pad = 0, step = 0;
};
struct cudnnActivationStruct {};

namespace {

using Tensor = cudnnTensorStruct;
constexpr std::size_t kForwardBytes = 96, kBackwardBytes = 160;  // of workspace: any numbers

float value_of(const void* scalar) { return *static_cast<const float*>(scalar); }

std::size_t at(const Tensor& t, int c, int y, int x) {
  return static_cast<std::size_t>(c * t.stride[1] + y * t.stride[2] + x * t.stride[3]);
}

template <class F>
void each(const Tensor& t, F&& f) {
  for (int c = 0; c < t.extent[1]; ++c)
    for (int y = 0; y < t.extent[2]; ++y)
      for (int x = 0; x < t.extent[3]; ++x) f(c, y, x);
}

// out = alpha * value + beta * out; what out held is not looked at where beta is 0.
void blend(const void* alpha, double value, const void* beta, float& out) {
  const float kept = value_of(beta) == 0 ? 0 : value_of(beta) * out;
  out = static_cast<float>(static_cast<double>(value_of(alpha)) * value) + kept;
}

cudnnStatus_t ok_if(bool condition) {
  return condition ? CUDNN_STATUS_SUCCESS : CUDNN_STATUS_BAD_PARAM;
}

int windows(int extent, int window, int pad, int step) {
  return (extent + 2 * pad - window) / step + 1;
}

bool convolution_fits(
    const Tensor& x, const cudnnFilterStruct& w, const cudnnConvolutionStruct& c, const Tensor& y
) {
  return x.extent[1] == w.in && y.extent[1] == w.out &&
         y.extent[2] == windows(x.extent[2], w.height, c.pad, c.step) &&
         y.extent[3] == windows(x.extent[3], w.width, c.pad, c.step);
}

// f(out channel, y, x of the output; in channel, v, u of the input; index of the weight).
template <class F>
void each_product(
    const Tensor& in,
    const cudnnFilterStruct& w,
    const cudnnConvolutionStruct& conv,
    const Tensor& out,
    F&& f
) {
  each(out, [&](int o, int y, int x) {
    for (int c = 0; c < w.in; ++c)
      for (int j = 0; j < w.height; ++j)
        for (int i = 0; i < w.width; ++i) {
          const int v = y * conv.step + j - conv.pad, u = x * conv.step + i - conv.pad;
          if (v < 0 || u < 0 || v >= in.extent[2] || u >= in.extent[3]) continue;
          f(at(out, o, y, x), at(in, c, v, u), ((o * w.in + c) * w.height + j) * w.width + i);
        }
  });
}

bool pooling_fits(const Tensor& x, const cudnnPoolingStruct& p, const Tensor& y) {
  return x.extent[1] == y.extent[1] &&
         y.extent[2] == windows(x.extent[2], p.window, p.pad, p.step) &&
         y.extent[3] == windows(x.extent[3], p.window, p.pad, p.step);
}

// Where the first largest value under a window is.
std::size_t largest_under(
    const Tensor& t, const cudnnPoolingStruct& p, const float* x, int c, int row, int column
) {
  std::size_t best = 0;
  bool found = false;
  for (int j = 0; j < p.window; ++j)
    for (int i = 0; i < p.window; ++i) {
      const int v = row * p.step + j - p.pad, u = column * p.step + i - p.pad;
      if (v < 0 || u < 0 || v >= t.extent[2] || u >= t.extent[3]) continue;
      const std::size_t here = at(t, c, v, u);
      if (found && x[here] <= x[best]) continue;
      best = here;
      found = true;
    }
  return best;
}

// One that may not be used comes first: its bytes differ from run to run.
template <class Perf, class Algorithm>
void propose(Perf* proposals, int* count, Algorithm loose, Algorithm good, std::size_t bytes) {
  proposals[0] = {loose, CUDNN_STATUS_SUCCESS, 1, 0, CUDNN_NON_DETERMINISTIC, CUDNN_FMA_MATH, {}};
  proposals[1] = {good, CUDNN_STATUS_SUCCESS, 2, 0, CUDNN_DETERMINISTIC, CUDNN_TENSOR_OP_MATH, {}};
  proposals[2] = {good, CUDNN_STATUS_SUCCESS, 3, bytes, CUDNN_DETERMINISTIC, CUDNN_FMA_MATH, {}};
  *count = 3;
}

template <class T>
cudnnStatus_t make(T** object) {
  *object = new T;
  return CUDNN_STATUS_SUCCESS;
}
template <class T>
cudnnStatus_t destroy(T* object) {
  delete object;
  return CUDNN_STATUS_SUCCESS;
}

}  // namespace

extern "C" {

std::size_t cudnnGetVersion() { return 8907; }
const char* cudnnGetErrorString(cudnnStatus_t status) {
  return status == CUDNN_STATUS_NOT_INITIALIZED ? "CUDNN_STATUS_NOT_INITIALIZED" : "another status";
}

cudnnStatus_t cudnnCreate(cudnnHandle_t* h) {
  if (glint::test::cudnn_fails) return CUDNN_STATUS_NOT_INITIALIZED;
  ++glint::test::cudnn_handles;
  return make(h);
}
cudnnStatus_t cudnnDestroy(cudnnHandle_t h) { return destroy(h); }
cudnnStatus_t cudnnCreateTensorDescriptor(cudnnTensorDescriptor_t* d) { return make(d); }
cudnnStatus_t cudnnDestroyTensorDescriptor(cudnnTensorDescriptor_t d) { return destroy(d); }
cudnnStatus_t cudnnCreateFilterDescriptor(cudnnFilterDescriptor_t* d) { return make(d); }
cudnnStatus_t cudnnDestroyFilterDescriptor(cudnnFilterDescriptor_t d) { return destroy(d); }
cudnnStatus_t cudnnCreateConvolutionDescriptor(cudnnConvolutionDescriptor_t* d) { return make(d); }
cudnnStatus_t cudnnDestroyConvolutionDescriptor(cudnnConvolutionDescriptor_t d) {
  return destroy(d);
}
cudnnStatus_t cudnnCreatePoolingDescriptor(cudnnPoolingDescriptor_t* d) { return make(d); }
cudnnStatus_t cudnnDestroyPoolingDescriptor(cudnnPoolingDescriptor_t d) { return destroy(d); }
cudnnStatus_t cudnnCreateActivationDescriptor(cudnnActivationDescriptor_t* d) { return make(d); }
cudnnStatus_t cudnnDestroyActivationDescriptor(cudnnActivationDescriptor_t d) { return destroy(d); }

cudnnStatus_t cudnnSetTensor4dDescriptor(
    cudnnTensorDescriptor_t d,
    cudnnTensorFormat_t format,
    cudnnDataType_t,
    int n,
    int c,
    int h,
    int w
) {
  d->extent = {n, c, h, w};
  if (format == CUDNN_TENSOR_NCHW)
    d->stride = {c * h * w, h * w, w, 1};
  else
    d->stride = {c * h * w, 1, w * c, c};
  return ok_if(n == 1 && c > 0 && h > 0 && w > 0);
}
cudnnStatus_t cudnnSetTensor4dDescriptorEx(
    cudnnTensorDescriptor_t d,
    cudnnDataType_t,
    int n,
    int c,
    int h,
    int w,
    int n_stride,
    int c_stride,
    int h_stride,
    int w_stride
) {
  *d = {{n, c, h, w}, {n_stride, c_stride, h_stride, w_stride}};
  return ok_if(n == 1 && h_stride >= w && c_stride >= h * h_stride);
}
cudnnStatus_t cudnnSetFilter4dDescriptor(
    cudnnFilterDescriptor_t d,
    cudnnDataType_t,
    cudnnTensorFormat_t format,
    int k,
    int c,
    int h,
    int w
) {
  *d = {k, c, h, w};
  return ok_if(format == CUDNN_TENSOR_NCHW);
}
cudnnStatus_t cudnnSetConvolution2dDescriptor(
    cudnnConvolutionDescriptor_t d,
    int pad_h,
    int pad_w,
    int stride_h,
    int stride_w,
    int dilation_h,
    int dilation_w,
    cudnnConvolutionMode_t mode,
    cudnnDataType_t
) {
  *d = {pad_h, stride_h};
  return ok_if(
      pad_w == pad_h && stride_w == stride_h && dilation_h == 1 && dilation_w == 1 &&
      mode == CUDNN_CROSS_CORRELATION
  );
}
cudnnStatus_t cudnnSetConvolutionMathType(cudnnConvolutionDescriptor_t, cudnnMathType_t type) {
  return ok_if(type == CUDNN_FMA_MATH);
}
cudnnStatus_t cudnnSetPooling2dDescriptor(
    cudnnPoolingDescriptor_t d,
    cudnnPoolingMode_t,
    cudnnNanPropagation_t,
    int window_h,
    int window_w,
    int pad_h,
    int pad_w,
    int stride_h,
    int stride_w
) {
  *d = {window_h, pad_h, stride_h};
  return ok_if(window_w == window_h && pad_w == pad_h && stride_w == stride_h);
}
cudnnStatus_t cudnnSetActivationDescriptor(
    cudnnActivationDescriptor_t, cudnnActivationMode_t, cudnnNanPropagation_t, double
) {
  return CUDNN_STATUS_SUCCESS;
}

cudnnStatus_t cudnnTransformTensor(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t from,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t to,
    void* y
) {
  if (from->extent != to->extent) return CUDNN_STATUS_BAD_PARAM;
  each(*to, [&](int c, int v, int u) {
    const auto value = static_cast<double>(static_cast<const float*>(x)[at(*from, c, v, u)]);
    blend(alpha, value, beta, static_cast<float*>(y)[at(*to, c, v, u)]);
  });
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnAddTensor(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t from,
    const void* a,
    const void* beta,
    const cudnnTensorDescriptor_t to,
    void* c
) {
  if (from->extent != std::array{1, to->extent[1], 1, 1}) return CUDNN_STATUS_BAD_PARAM;
  each(*to, [&](int channel, int v, int u) {
    const auto value = static_cast<double>(static_cast<const float*>(a)[at(*from, channel, 0, 0)]);
    blend(alpha, value, beta, static_cast<float*>(c)[at(*to, channel, v, u)]);
  });
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnActivationForward(
    cudnnHandle_t,
    cudnnActivationDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t from,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t to,
    void* y
) {
  if (from->extent != to->extent) return CUDNN_STATUS_BAD_PARAM;
  each(*to, [&](int c, int v, int u) {
    const float value = std::max(0.0f, static_cast<const float*>(x)[at(*from, c, v, u)]);
    blend(alpha, static_cast<double>(value), beta, static_cast<float*>(y)[at(*to, c, v, u)]);
  });
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnActivationBackward(
    cudnnHandle_t,
    cudnnActivationDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t y_shape,
    const void*,
    const cudnnTensorDescriptor_t dy_shape,
    const void* dy,
    const cudnnTensorDescriptor_t x_shape,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t dx_shape,
    void* dx
) {
  if (y_shape->extent != x_shape->extent || dy_shape->extent != dx_shape->extent)
    return CUDNN_STATUS_BAD_PARAM;
  each(*dx_shape, [&](int c, int v, int u) {
    const bool passes = static_cast<const float*>(x)[at(*x_shape, c, v, u)] > 0;
    const float value = passes ? static_cast<const float*>(dy)[at(*dy_shape, c, v, u)] : 0.0f;
    blend(alpha, static_cast<double>(value), beta, static_cast<float*>(dx)[at(*dx_shape, c, v, u)]);
  });
  return CUDNN_STATUS_SUCCESS;
}

cudnnStatus_t cudnnPoolingForward(
    cudnnHandle_t,
    const cudnnPoolingDescriptor_t p,
    const void* alpha,
    const cudnnTensorDescriptor_t from,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t to,
    void* y
) {
  if (!pooling_fits(*from, *p, *to)) return CUDNN_STATUS_BAD_PARAM;
  const auto* in = static_cast<const float*>(x);
  each(*to, [&](int c, int v, int u) {
    const auto value = static_cast<double>(in[largest_under(*from, *p, in, c, v, u)]);
    blend(alpha, value, beta, static_cast<float*>(y)[at(*to, c, v, u)]);
  });
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnPoolingBackward(
    cudnnHandle_t,
    const cudnnPoolingDescriptor_t p,
    const void* alpha,
    const cudnnTensorDescriptor_t y_shape,
    const void*,
    const cudnnTensorDescriptor_t dy_shape,
    const void* dy,
    const cudnnTensorDescriptor_t x_shape,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t dx_shape,
    void* dx
) {
  if (!pooling_fits(*x_shape, *p, *y_shape) || dy_shape->extent != y_shape->extent ||
      dx_shape->extent != x_shape->extent || dx_shape->stride != x_shape->stride)
    return CUDNN_STATUS_BAD_PARAM;
  const auto* in = static_cast<const float*>(x);
  auto* out = static_cast<float*>(dx);
  each(*dx_shape, [&](int c, int v, int u) { blend(alpha, 0, beta, out[at(*dx_shape, c, v, u)]); });
  each(*dy_shape, [&](int c, int v, int u) {
    out[largest_under(*x_shape, *p, in, c, v, u)] +=
        value_of(alpha) * static_cast<const float*>(dy)[at(*dy_shape, c, v, u)];
  });
  return CUDNN_STATUS_SUCCESS;
}

cudnnStatus_t cudnnGetConvolutionForwardAlgorithm_v7(
    cudnnHandle_t,
    const cudnnTensorDescriptor_t x,
    const cudnnFilterDescriptor_t w,
    const cudnnConvolutionDescriptor_t conv,
    const cudnnTensorDescriptor_t y,
    int wanted,
    int* count,
    cudnnConvolutionFwdAlgoPerf_t* proposals
) {
  if (wanted < 3 || !convolution_fits(*x, *w, *conv, *y)) return CUDNN_STATUS_BAD_PARAM;
  propose(
      proposals,
      count,
      CUDNN_CONVOLUTION_FWD_ALGO_IMPLICIT_GEMM,
      CUDNN_CONVOLUTION_FWD_ALGO_IMPLICIT_PRECOMP_GEMM,
      kForwardBytes
  );
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnGetConvolutionBackwardDataAlgorithm_v7(
    cudnnHandle_t,
    const cudnnFilterDescriptor_t w,
    const cudnnTensorDescriptor_t dy,
    const cudnnConvolutionDescriptor_t conv,
    const cudnnTensorDescriptor_t dx,
    int wanted,
    int* count,
    cudnnConvolutionBwdDataAlgoPerf_t* proposals
) {
  if (wanted < 3 || !convolution_fits(*dx, *w, *conv, *dy)) return CUDNN_STATUS_BAD_PARAM;
  propose(
      proposals,
      count,
      CUDNN_CONVOLUTION_BWD_DATA_ALGO_0,
      CUDNN_CONVOLUTION_BWD_DATA_ALGO_1,
      kBackwardBytes
  );
  return CUDNN_STATUS_SUCCESS;
}

cudnnStatus_t cudnnConvolutionForward(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t x_shape,
    const void* x,
    const cudnnFilterDescriptor_t w_shape,
    const void* w,
    const cudnnConvolutionDescriptor_t conv,
    cudnnConvolutionFwdAlgo_t algorithm,
    void*,
    std::size_t workspace_bytes,
    const void* beta,
    const cudnnTensorDescriptor_t y_shape,
    void* y
) {
  if (!convolution_fits(*x_shape, *w_shape, *conv, *y_shape) || workspace_bytes < kForwardBytes ||
      algorithm != CUDNN_CONVOLUTION_FWD_ALGO_IMPLICIT_PRECOMP_GEMM)
    return CUDNN_STATUS_BAD_PARAM;
  std::vector<double> sums(static_cast<std::size_t>(y_shape->stride[0]));
  each_product(
      *x_shape,
      *w_shape,
      *conv,
      *y_shape,
      [&](std::size_t out, std::size_t in, int weight) {
        sums[out] += static_cast<double>(static_cast<const float*>(w)[weight]) *
                     static_cast<double>(static_cast<const float*>(x)[in]);
      }
  );
  each(*y_shape, [&](int c, int v, int u) {
    const std::size_t i = at(*y_shape, c, v, u);
    blend(alpha, sums[i], beta, static_cast<float*>(y)[i]);
  });
  return CUDNN_STATUS_SUCCESS;
}
cudnnStatus_t cudnnConvolutionBackwardData(
    cudnnHandle_t,
    const void* alpha,
    const cudnnFilterDescriptor_t w_shape,
    const void* w,
    const cudnnTensorDescriptor_t dy_shape,
    const void* dy,
    const cudnnConvolutionDescriptor_t conv,
    cudnnConvolutionBwdDataAlgo_t algorithm,
    void*,
    std::size_t workspace_bytes,
    const void* beta,
    const cudnnTensorDescriptor_t dx_shape,
    void* dx
) {
  if (!convolution_fits(*dx_shape, *w_shape, *conv, *dy_shape) ||
      workspace_bytes < kBackwardBytes || algorithm != CUDNN_CONVOLUTION_BWD_DATA_ALGO_1)
    return CUDNN_STATUS_BAD_PARAM;
  std::vector<double> sums(static_cast<std::size_t>(dx_shape->stride[0]));
  each_product(
      *dx_shape,
      *w_shape,
      *conv,
      *dy_shape,
      [&](std::size_t out, std::size_t in, int weight) {
        sums[in] += static_cast<double>(static_cast<const float*>(w)[weight]) *
                    static_cast<double>(static_cast<const float*>(dy)[out]);
      }
  );
  each(*dx_shape, [&](int c, int v, int u) {
    const std::size_t i = at(*dx_shape, c, v, u);
    blend(alpha, sums[i], beta, static_cast<float*>(dx)[i]);
  });
  return CUDNN_STATUS_SUCCESS;
}

}  // extern "C"

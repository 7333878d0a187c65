// SPDX-License-Identifier: MIT
// Stands in for cuDNN where tests run on the host: the few declarations that this project calls, in
// the names and values of cuDNN 8's interface. The functions are plain loops (cudnn.cpp).
#pragma once

#include <cstddef>

#define CUDNN_MAJOR 8

extern "C" {

enum cudnnStatus_t {
  CUDNN_STATUS_SUCCESS = 0,
  CUDNN_STATUS_NOT_INITIALIZED = 1,
  CUDNN_STATUS_BAD_PARAM = 3,
  CUDNN_STATUS_NOT_SUPPORTED = 9
};
enum cudnnDataType_t { CUDNN_DATA_FLOAT = 0 };
enum cudnnTensorFormat_t { CUDNN_TENSOR_NCHW = 0, CUDNN_TENSOR_NHWC = 1 };
enum cudnnMathType_t { CUDNN_DEFAULT_MATH = 0, CUDNN_TENSOR_OP_MATH = 1, CUDNN_FMA_MATH = 3 };
enum cudnnNanPropagation_t { CUDNN_PROPAGATE_NAN = 1 };
enum cudnnDeterminism_t { CUDNN_NON_DETERMINISTIC = 0, CUDNN_DETERMINISTIC = 1 };
enum cudnnPoolingMode_t { CUDNN_POOLING_MAX_DETERMINISTIC = 3 };
enum cudnnActivationMode_t { CUDNN_ACTIVATION_RELU = 1 };
enum cudnnConvolutionMode_t { CUDNN_CROSS_CORRELATION = 1 };
enum cudnnConvolutionFwdAlgo_t {
  CUDNN_CONVOLUTION_FWD_ALGO_IMPLICIT_GEMM = 0,
  CUDNN_CONVOLUTION_FWD_ALGO_IMPLICIT_PRECOMP_GEMM = 1,
  CUDNN_CONVOLUTION_FWD_ALGO_COUNT = 8
};
enum cudnnConvolutionBwdDataAlgo_t {
  CUDNN_CONVOLUTION_BWD_DATA_ALGO_0 = 0,
  CUDNN_CONVOLUTION_BWD_DATA_ALGO_1 = 1,
  CUDNN_CONVOLUTION_BWD_DATA_ALGO_COUNT = 6
};

typedef struct cudnnContext* cudnnHandle_t;
typedef struct cudnnTensorStruct* cudnnTensorDescriptor_t;
typedef struct cudnnFilterStruct* cudnnFilterDescriptor_t;
typedef struct cudnnConvolutionStruct* cudnnConvolutionDescriptor_t;
typedef struct cudnnPoolingStruct* cudnnPoolingDescriptor_t;
typedef struct cudnnActivationStruct* cudnnActivationDescriptor_t;

struct cudnnConvolutionFwdAlgoPerf_t {
  cudnnConvolutionFwdAlgo_t algo;
  cudnnStatus_t status;
  float time;
  std::size_t memory;
  cudnnDeterminism_t determinism;
  cudnnMathType_t mathType;
  int reserved[3];
};
struct cudnnConvolutionBwdDataAlgoPerf_t {
  cudnnConvolutionBwdDataAlgo_t algo;
  cudnnStatus_t status;
  float time;
  std::size_t memory;
  cudnnDeterminism_t determinism;
  cudnnMathType_t mathType;
  int reserved[3];
};

std::size_t cudnnGetVersion();
const char* cudnnGetErrorString(cudnnStatus_t status);

cudnnStatus_t cudnnCreate(cudnnHandle_t*);
cudnnStatus_t cudnnDestroy(cudnnHandle_t);
cudnnStatus_t cudnnCreateTensorDescriptor(cudnnTensorDescriptor_t*);
cudnnStatus_t cudnnDestroyTensorDescriptor(cudnnTensorDescriptor_t);
cudnnStatus_t cudnnCreateFilterDescriptor(cudnnFilterDescriptor_t*);
cudnnStatus_t cudnnDestroyFilterDescriptor(cudnnFilterDescriptor_t);
cudnnStatus_t cudnnCreateConvolutionDescriptor(cudnnConvolutionDescriptor_t*);
cudnnStatus_t cudnnDestroyConvolutionDescriptor(cudnnConvolutionDescriptor_t);
cudnnStatus_t cudnnCreatePoolingDescriptor(cudnnPoolingDescriptor_t*);
cudnnStatus_t cudnnDestroyPoolingDescriptor(cudnnPoolingDescriptor_t);
cudnnStatus_t cudnnCreateActivationDescriptor(cudnnActivationDescriptor_t*);
cudnnStatus_t cudnnDestroyActivationDescriptor(cudnnActivationDescriptor_t);

cudnnStatus_t cudnnSetTensor4dDescriptor(
    cudnnTensorDescriptor_t, cudnnTensorFormat_t, cudnnDataType_t, int n, int c, int h, int w
);
cudnnStatus_t cudnnSetTensor4dDescriptorEx(
    cudnnTensorDescriptor_t,
    cudnnDataType_t,
    int n,
    int c,
    int h,
    int w,
    int n_stride,
    int c_stride,
    int h_stride,
    int w_stride
);
cudnnStatus_t cudnnSetFilter4dDescriptor(
    cudnnFilterDescriptor_t, cudnnDataType_t, cudnnTensorFormat_t, int k, int c, int h, int w
);
cudnnStatus_t cudnnSetConvolution2dDescriptor(
    cudnnConvolutionDescriptor_t,
    int pad_h,
    int pad_w,
    int stride_h,
    int stride_w,
    int dilation_h,
    int dilation_w,
    cudnnConvolutionMode_t,
    cudnnDataType_t
);
cudnnStatus_t cudnnSetConvolutionMathType(cudnnConvolutionDescriptor_t, cudnnMathType_t);
cudnnStatus_t cudnnSetPooling2dDescriptor(
    cudnnPoolingDescriptor_t,
    cudnnPoolingMode_t,
    cudnnNanPropagation_t,
    int window_h,
    int window_w,
    int pad_h,
    int pad_w,
    int stride_h,
    int stride_w
);
cudnnStatus_t cudnnSetActivationDescriptor(
    cudnnActivationDescriptor_t, cudnnActivationMode_t, cudnnNanPropagation_t, double coefficient
);

cudnnStatus_t cudnnTransformTensor(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* y
);
cudnnStatus_t cudnnAddTensor(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* a,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* c
);
cudnnStatus_t cudnnActivationForward(
    cudnnHandle_t,
    cudnnActivationDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* y
);
cudnnStatus_t cudnnActivationBackward(
    cudnnHandle_t,
    cudnnActivationDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* y,
    const cudnnTensorDescriptor_t,
    const void* dy,
    const cudnnTensorDescriptor_t,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* dx
);
cudnnStatus_t cudnnPoolingForward(
    cudnnHandle_t,
    const cudnnPoolingDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* y
);
cudnnStatus_t cudnnPoolingBackward(
    cudnnHandle_t,
    const cudnnPoolingDescriptor_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* y,
    const cudnnTensorDescriptor_t,
    const void* dy,
    const cudnnTensorDescriptor_t,
    const void* x,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* dx
);
cudnnStatus_t cudnnGetConvolutionForwardAlgorithm_v7(
    cudnnHandle_t,
    const cudnnTensorDescriptor_t x,
    const cudnnFilterDescriptor_t,
    const cudnnConvolutionDescriptor_t,
    const cudnnTensorDescriptor_t y,
    int wanted,
    int* count,
    cudnnConvolutionFwdAlgoPerf_t* proposals
);
cudnnStatus_t cudnnGetConvolutionBackwardDataAlgorithm_v7(
    cudnnHandle_t,
    const cudnnFilterDescriptor_t,
    const cudnnTensorDescriptor_t dy,
    const cudnnConvolutionDescriptor_t,
    const cudnnTensorDescriptor_t dx,
    int wanted,
    int* count,
    cudnnConvolutionBwdDataAlgoPerf_t* proposals
);
cudnnStatus_t cudnnConvolutionForward(
    cudnnHandle_t,
    const void* alpha,
    const cudnnTensorDescriptor_t,
    const void* x,
    const cudnnFilterDescriptor_t,
    const void* w,
    const cudnnConvolutionDescriptor_t,
    cudnnConvolutionFwdAlgo_t,
    void* workspace,
    std::size_t workspace_bytes,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* y
);
cudnnStatus_t cudnnConvolutionBackwardData(
    cudnnHandle_t,
    const void* alpha,
    const cudnnFilterDescriptor_t,
    const void* w,
    const cudnnTensorDescriptor_t,
    const void* dy,
    const cudnnConvolutionDescriptor_t,
    cudnnConvolutionBwdDataAlgo_t,
    void* workspace,
    std::size_t workspace_bytes,
    const void* beta,
    const cudnnTensorDescriptor_t,
    void* dx
);

}  // extern "C"

// SPDX-License-Identifier: MIT
// Convolutions and max pooling of feature_net.h as kernels. Features are [H][W][channels] with
// channels in fours, so that every access has sixteen bytes; those that fill up are zero. Every sum
// is a chain of fma in one order, on whichever device and in tiles of whichever size.
#pragma once

#include "glint/core/block_kernel.h"
#include "glint/core/real.h"

namespace glint {

// How the windows of a step lie over its input.
struct FeatureWindows {
  ImageSize in, out;
  int in_channels, out_channels;  // in fours
  int kernel, stride, padding;
};

struct alignas(16) FeatureQuad {
  float v[4];
};
GLINT_HD const FeatureQuad& quad_at(const float* features) {
  return *reinterpret_cast<const FeatureQuad*>(features);
}
GLINT_HD FeatureQuad& quad_at(float* features) { return *reinterpret_cast<FeatureQuad*>(features); }

// f(0), ..., f(kCount - 1); on GPUs as so many statements, so that arrays stay in registers.
template <int kCount, class F>
GLINT_HD void repeat(F&& f) {
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < kCount; ++i) f(i);
}

// What a block computes at once: kPixels x kChannels outputs, of which each thread has
// kPixelsEach x kChannelsEach; kDepth products of each at a time.
struct LargeFeatureTile {
  static constexpr int kPixels = 128, kChannels = 64, kPixelsEach = 8, kChannelsEach = 8;
  static constexpr int kDepth = 8;
};
// For few pixels: more blocks.
struct SmallFeatureTile {
  static constexpr int kPixels = 32, kChannels = 64, kPixelsEach = 4, kChannelsEach = 4;
  static constexpr int kDepth = 16;
};

// A convolution as a product of matrices, [pixels][window, channel] x [window, channel][outputs],
// of which the first is gathered on the way ("implicit GEMM"). While a block multiplies what it
// has in one half of its shared memory, its threads load what comes next.
template <class Tile>
struct ConvolveTile {
  static constexpr int kRows = Tile::kPixels / Tile::kPixelsEach;
  static constexpr int kColumns = Tile::kChannels / Tile::kChannelsEach;
  static constexpr int kThreads = kRows * kColumns;
  static constexpr int kDepth = Tile::kDepth;
  static constexpr int kPixelQuads = Tile::kPixelsEach / 4;
  static constexpr int kChannelQuads = Tile::kChannelsEach / 4;
  static constexpr int kLoads = Tile::kPixels * kDepth / 4 / kThreads;          // of the input
  static constexpr int kWeightLoads = Tile::kChannels * kDepth / 4 / kThreads;  // of quads each
  static constexpr int kBlocksAtOnce = 3;
  static_assert(kThreads % Tile::kPixels == 0);
  static_assert(kLoads * 4 * kThreads == Tile::kPixels * kDepth);
  static_assert(kWeightLoads * 4 * kThreads == Tile::kChannels * kDepth);

  struct Shared {
    FeatureQuad in[2][kDepth][Tile::kPixels / 4];
    FeatureQuad weight[2][kDepth][Tile::kChannels / 4];
  };

  FeatureWindows windows;
  const float* in;
  const float* weight;  // [window's row, column][in_channels][out_channels]
  const float* bias;    // null: neither bias nor ReLU
  float* out;

  GLINT_HD static std::size_t num_blocks(const FeatureWindows& w) {
    return (w.out.num_pixels() + Tile::kPixels - 1) / Tile::kPixels * channel_tiles(w);
  }

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    typename Block::template PerThread<Thread> threads;
    const std::size_t tiles = channel_tiles(windows);
    const auto index = static_cast<std::size_t>(block.index);
    const Corner corner{
        index / tiles * Tile::kPixels, static_cast<int>(index % tiles) * Tile::kChannels};
    const int steps = (depth() + kDepth - 1) / kDepth;
    block.each([&](int t) {
      start(t, corner, threads[t]);
      load(t, corner, 0, threads[t]);
      put(t, threads[t], 0, shared);
    });
    for (int step = 0; step < steps; ++step)
      block.each([&](int t) {
        const bool more = step + 1 < steps;
        if (more) load(t, corner, step + 1, threads[t]);
        multiply(t, shared, step % 2, threads[t]);
        if (more) put(t, threads[t], (step + 1) % 2, shared);
      });
    block.each([&](int t) { write(t, corner, threads[t]); });
  }

 private:
  struct Corner {
    std::size_t pixel;
    int channel;
  };
  // A place in a window.
  struct Place {
    int channel, column, row;
  };
  struct Thread {
    int x, y;  // the window's first pixel of the pixel whose inputs the thread loads
    Place places[kLoads];
    FeatureQuad in[kLoads], weight[kWeightLoads];
    float sums[Tile::kPixelsEach][Tile::kChannelsEach];
  };
  static constexpr int kOutside = -(1 << 28);

  GLINT_HD static std::size_t channel_tiles(const FeatureWindows& w) {
    return static_cast<std::size_t>((w.out_channels + Tile::kChannels - 1) / Tile::kChannels);
  }
  GLINT_HD int depth() const { return windows.kernel * windows.kernel * windows.in_channels; }

  GLINT_HD void advance(Place& place, int by) const {
    place.channel += by;
    while (place.channel >= windows.in_channels) {
      place.channel -= windows.in_channels;
      if (++place.column < windows.kernel) continue;
      place.column = 0;
      ++place.row;
    }
  }

  // Threads load for one pixel each, and start at places four channels apart.
  GLINT_HD static int first_quad(int t) { return t / Tile::kPixels; }
  static constexpr int kQuadStride = kThreads / Tile::kPixels;

  GLINT_HD void start(int t, const Corner& corner, Thread& thread) const {
    const std::size_t pixel = corner.pixel + static_cast<std::size_t>(t % Tile::kPixels);
    const auto width = static_cast<std::size_t>(windows.out.width);
    const bool inside = pixel < windows.out.num_pixels();
    thread.x = static_cast<int>(pixel % width) * windows.stride - windows.padding;
    thread.y =
        inside ? static_cast<int>(pixel / width) * windows.stride - windows.padding : kOutside;
    repeat<kLoads>([&](int l) {
      thread.places[l] = {0, 0, 0};
      advance(thread.places[l], 4 * (first_quad(t) + l * kQuadStride));
    });
    const int column = t % kColumns;
    repeat<Tile::kChannelsEach>([&](int c) {
      const int channel = corner.channel + in_tile(column, kColumns, c);
      const float sum = bias != nullptr && channel < windows.out_channels ? bias[channel] : 0.0f;
      repeat<Tile::kPixelsEach>([&](int p) { thread.sums[p][c] = sum; });
    });
  }

  // A thread's i-th pixel or channel: fours that lie side by side among the threads.
  GLINT_HD static int in_tile(int place, int places, int i) {
    return 4 * (place + i / 4 * places) + i % 4;
  }

  GLINT_HD FeatureQuad input(const Thread& thread, const Place& place) const {
    const int x = thread.x + place.column, y = thread.y + place.row;
    const bool inside = place.row < windows.kernel && x >= 0 && y >= 0 && x < windows.in.width &&
                        y < windows.in.height;
    if (!inside) return {};
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(windows.in.width) +
        static_cast<std::size_t>(x);
    return quad_at(in + pixel * static_cast<std::size_t>(windows.in_channels) + place.channel);
  }
  GLINT_HD FeatureQuad weights(int row, int channel) const {
    if (row >= depth() || channel >= windows.out_channels) return {};
    const auto channels = static_cast<std::size_t>(windows.out_channels);
    return quad_at(weight + static_cast<std::size_t>(row) * channels + channel);
  }
  GLINT_HD void load(int t, const Corner& corner, int step, Thread& thread) const {
    repeat<kLoads>([&](int l) {
      thread.in[l] = input(thread, thread.places[l]);
      advance(thread.places[l], kDepth);
    });
    repeat<kWeightLoads>([&](int l) {
      const int quad = t + l * kThreads;
      thread.weight[l] = weights(
          step * kDepth + quad / (Tile::kChannels / 4),
          corner.channel + 4 * (quad % (Tile::kChannels / 4))
      );
    });
  }
  GLINT_HD static void put(int t, const Thread& thread, int half, Shared& shared) {
    const int pixel = t % Tile::kPixels;
    repeat<kLoads>([&](int l) {
      const int row = 4 * (first_quad(t) + l * kQuadStride);
      repeat<4>([&](int c) { shared.in[half][row + c][pixel / 4].v[pixel % 4] = thread.in[l].v[c]; }
      );
    });
    repeat<kWeightLoads>([&](int l) {
      const int quad = t + l * kThreads;
      shared.weight[half][quad / (Tile::kChannels / 4)][quad % (Tile::kChannels / 4)] =
          thread.weight[l];
    });
  }

  GLINT_HD static void multiply(int t, const Shared& shared, int half, Thread& thread) {
    const int row = t / kColumns, column = t % kColumns;
    repeat<kDepth>([&](int k) {
      FeatureQuad a[kPixelQuads], b[kChannelQuads];
      repeat<kPixelQuads>([&](int q) { a[q] = shared.in[half][k][row + q * kRows]; });
      repeat<kChannelQuads>([&](int q) { b[q] = shared.weight[half][k][column + q * kColumns]; });
      repeat<Tile::kPixelsEach>([&](int p) {
        repeat<Tile::kChannelsEach>([&](int c) {
          float& sum = thread.sums[p][c];
          sum = fma_of(a[p / 4].v[p % 4], b[c / 4].v[c % 4], sum);
        });
      });
    });
  }

  GLINT_HD void write(int t, const Corner& corner, const Thread& thread) const {
    const int row = t / kColumns, column = t % kColumns;
    const auto channels = static_cast<std::size_t>(windows.out_channels);
    repeat<Tile::kPixelsEach>([&](int p) {
      const std::size_t pixel = corner.pixel + static_cast<std::size_t>(in_tile(row, kRows, p));
      repeat<kChannelQuads>([&](int q) {
        const int channel = corner.channel + in_tile(column, kColumns, 4 * q);
        if (pixel >= windows.out.num_pixels() || channel >= windows.out_channels) return;
        FeatureQuad values;
        repeat<4>([&](int c) {
          const float sum = thread.sums[p][4 * q + c];
          values.v[c] = bias == nullptr ? sum : max_of(sum, 0.0f);
        });
        quad_at(out + pixel * channels + channel) = values;
      });
    });
  }
};

// The gradient of a convolution's input, of few channels or behind large strides: element i =
// (pixel of the input, four channels), the sum over the windows that see it.
struct GatherConvolutionVjp {
  FeatureWindows windows;
  const float* weight;  // [window's row, column][out_channels][in_channels]
  const float* dL_dout;
  float* dL_din;

  GLINT_HD void operator()(std::size_t i) const {
    const auto quads = static_cast<std::size_t>(windows.in_channels / 4);
    const auto width = static_cast<std::size_t>(windows.in.width);
    const std::size_t pixel = i / quads;
    const int x = static_cast<int>(pixel % width) + windows.padding;
    const int y = static_cast<int>(pixel / width) + windows.padding;
    FeatureQuad sum{};
    for (int row = 0; row < windows.kernel; ++row)
      for (int column = 0; column < windows.kernel; ++column)
        add(x - column, y - row, row * windows.kernel + column, i % quads, sum);
    quad_at(dL_din + 4 * i) = sum;
  }

 private:
  // Of the window that begins at (x, y) of the padded input, if there is one.
  GLINT_HD void add(int x, int y, int place, std::size_t quad, FeatureQuad& sum) const {
    if (x < 0 || y < 0 || x % windows.stride != 0 || y % windows.stride != 0) return;
    const int u = x / windows.stride, v = y / windows.stride;
    if (u >= windows.out.width || v >= windows.out.height) return;
    const auto outputs = static_cast<std::size_t>(windows.out_channels);
    const auto inputs = static_cast<std::size_t>(windows.in_channels);
    const std::size_t pixel =
        static_cast<std::size_t>(v) * static_cast<std::size_t>(windows.out.width) +
        static_cast<std::size_t>(u);
    const float* gradient = dL_dout + pixel * outputs;
    const float* weights = weight + static_cast<std::size_t>(place) * outputs * inputs + 4 * quad;
    for (std::size_t o = 0; o < outputs; ++o) {
      const FeatureQuad& w = quad_at(weights + o * inputs);
      repeat<4>([&](int c) { sum.v[c] = fma_of(gradient[o], w.v[c], sum.v[c]); });
    }
  }
};

// ReLU's gradient, from its output.
struct ReluVjp {
  const float* output;
  float* gradient;
  GLINT_HD void operator()(std::size_t i) const {
    if (!(output[i] > 0)) gradient[i] = 0;
  }
};

// Element i of the output = (pixel, channel): the largest of its window, the first of equal ones.
struct MaxPool {
  FeatureWindows windows;
  const float* in;
  float* out;
  unsigned char* place;  // where in its window each maximum was

  GLINT_HD void operator()(std::size_t i) const {
    const auto channels = static_cast<std::size_t>(windows.out_channels);
    const auto width = static_cast<std::size_t>(windows.out.width);
    const std::size_t pixel = i / channels;
    const int x = static_cast<int>(pixel % width) * windows.stride - windows.padding;
    const int y = static_cast<int>(pixel / width) * windows.stride - windows.padding;
    const ImageView features{in, windows.in.width, windows.in.height, windows.in_channels};
    int found = -1;
    float largest = 0;
    for (int k = 0; k < windows.kernel * windows.kernel; ++k) {
      const int u = x + k % windows.kernel, v = y + k / windows.kernel;
      if (u < 0 || v < 0 || u >= windows.in.width || v >= windows.in.height) continue;
      const float value = features.at(u, v, static_cast<int>(i % channels));
      if (found >= 0 && !(value > largest)) continue;
      largest = value;
      found = k;
    }
    out[i] = largest;
    place[i] = static_cast<unsigned char>(found);
  }
};

// Element i of the input: the sum over the windows of which it was the largest.
struct MaxPoolVjp {
  FeatureWindows windows;
  const unsigned char* place;
  const float* dL_dout;
  float* dL_din;

  GLINT_HD void operator()(std::size_t i) const {
    const auto channels = static_cast<std::size_t>(windows.in_channels);
    const auto width = static_cast<std::size_t>(windows.in.width);
    const std::size_t pixel = i / channels;
    const int x = static_cast<int>(pixel % width) + windows.padding;
    const int y = static_cast<int>(pixel / width) + windows.padding;
    float sum = 0;
    for (int v = first_window(y); v <= y / windows.stride && v < windows.out.height; ++v)
      for (int u = first_window(x); u <= x / windows.stride && u < windows.out.width; ++u) {
        const std::size_t at =
            (static_cast<std::size_t>(v) * static_cast<std::size_t>(windows.out.width) +
             static_cast<std::size_t>(u)) *
                channels +
            i % channels;
        const int here = (y - v * windows.stride) * windows.kernel + x - u * windows.stride;
        if (place[at] == here) sum += dL_dout[at];
      }
    dL_din[i] = sum;
  }

 private:
  // That reaches a place of the padded input.
  GLINT_HD int first_window(int at) const {
    const int before = at - windows.kernel + windows.stride;
    return before < 0 ? 0 : before / windows.stride;
  }
};

using FeatureNetKernels = KernelList<
    ConvolveTile<LargeFeatureTile>,
    ConvolveTile<SmallFeatureTile>,
    GatherConvolutionVjp,
    ReluVjp,
    MaxPool,
    MaxPoolVjp>;

}  // namespace glint

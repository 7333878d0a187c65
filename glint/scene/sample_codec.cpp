// SPDX-License-Identifier: MIT
#include "glint/scene/sample_codec.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <vector>

#include "glint/scene/range_coder.h"

namespace glint {
namespace {

using Value = std::int64_t;

// Of a sample's value: from its own channel, and some of these moved by what the channel before it
// did here against its own prediction of the kind.
constexpr std::size_t kOwn = 8, kMoved = 6, kPredictions = kOwn + kMoved;
using Predictions = std::array<Value, kPredictions>;

// Differences of up to 8 bits are coded whole, bit by bit from the top; of more bits by their
// length, and by what follows the first one.
constexpr int kTreeBits = 8;
constexpr int kLengths = 36, kModeledBits = 3;  // of those that follow, so many are foreseen
constexpr std::size_t kLengthModels = 64;
constexpr std::size_t kTreeModels = std::size_t{1} << (kTreeBits + 1);
constexpr std::size_t kLongModels = kLengthModels + (kLengths << kModeledBits);
constexpr int kEnergies = 40;

// Bits up to the highest that is set.
int length_of(std::uint64_t number) { return static_cast<int>(std::bit_width(number)); }

// The activity around a sample in half octaves.
int energy_class(Value energy) {
  if (energy <= 0) return 0;
  const int length = length_of(static_cast<std::uint64_t>(energy));
  const int half = length >= 2 ? static_cast<int>(energy >> (length - 2)) & 1 : 0;
  return std::min(2 * length - 1 + half, kEnergies - 1);
}

// w + n - nw where that lies between w and n, else the nearer of them: flat parts and edges alike
// (Martucci 1990; the predictor of JPEG-LS).
Value median_edge(Value w, Value n, Value nw) {
  return std::clamp(w + n - nw, std::min(w, n), std::max(w, n));
}

// Around a sample: left, above, above left, above right, the next but one to the left and above.
struct Neighbours {
  Value w, n, nw, ne, ww, nn;
};

// Three rows of one channel, with what stands beside the picture: left of a row its first
// neighbour above, right of it its last one.
class Rows {
 public:
  Rows(int width, Value middle) {
    for (auto& row : rows_) row.assign(static_cast<std::size_t>(width) + kLeft + 1, middle);
  }
  void next_row() {
    std::rotate(rows_.begin(), rows_.begin() + 2, rows_.end());
    auto& [now, above, second] = rows_;
    above.back() = above[above.size() - 2];
    for (auto* row : {&now, &above, &second}) std::fill_n(row->begin(), kLeft, above[kLeft]);
  }
  Value& at(int x) { return rows_[0][static_cast<std::size_t>(x) + kLeft]; }
  Neighbours around(int x) const {
    const auto i = static_cast<std::size_t>(x) + kLeft;
    const auto& [now, above, second] = rows_;
    return {now[i - 1], above[i], above[i - 1], above[i + 1], now[i - 2], second[i]};
  }

 private:
  static constexpr std::size_t kLeft = 2;   // beside the picture
  std::array<std::vector<Value>, 3> rows_;  // this one, those above
};

// Errors that predictions had in this row and the one above, zero beside the picture.
template <class T>
class ErrorRows {
 public:
  explicit ErrorRows(int width) {
    for (auto& row : rows_) row.assign(static_cast<std::size_t>(width) + 2, T{});
  }
  void next_row() { std::swap(rows_[0], rows_[1]); }
  T& at(int x) { return rows_[0][static_cast<std::size_t>(x) + 1]; }
  const T& left(int x) const { return rows_[0][static_cast<std::size_t>(x)]; }
  const T& above(int x) const { return rows_[1][static_cast<std::size_t>(x) + 1]; }

 private:
  std::array<std::vector<T>, 2> rows_;
};

// 2^24 / (e^2 + 1).
const std::array<std::int32_t, 1024> kWeights = [] {
  std::array<std::int32_t, 1024> weights{};
  for (std::int64_t e = 0; e < 1024; ++e)
    weights[static_cast<std::size_t>(e)] = static_cast<std::int32_t>((1 << 24) / (e * e + 1));
  return weights;
}();

// Of the first `count`, each by the inverse square of its errors.
Value weighted_mean(const Predictions& predictions, const Predictions& errors, std::size_t count) {
  // Errors of many bits are compared by their leading ones.
  const Value least =
      *std::min_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(count));
  const int shift = std::max(0, length_of(static_cast<std::uint64_t>(least)) - 7);
  Value sum = 0, weights = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Value error = std::min<Value>(errors[i] >> shift, 1023);
    const Value weight = kWeights[static_cast<std::size_t>(error)];
    sum += weight * (predictions[i] - predictions[0]);
    weights += weight;
  }
  return predictions[0] + sum / std::max<Value>(weights, 1);
}

// From the channel itself, into the first kOwn.
void predict(const Neighbours& a, Value* to) {
  const auto [w, n, nw, ne, ww, nn] = a;
  to[0] = median_edge(w, n, nw);
  to[1] = (2 * w + n + ne) >> 2;
  to[2] = (w + n) >> 1;
  to[3] = (w + n + nw + ne + ww + nn) / 6;
  to[4] = w;
  to[5] = n;
  to[6] = w + n - nw;
  to[7] = 2 * w - ww;
}

// Differences of one channel, by the class of activity.
template <class Coder>
class Differences {
 public:
  Differences(int bits, Coder& coder)
      : bits_(bits),
        coder_(coder),
        models_(kEnergies * (bits <= kTreeBits ? kTreeModels : kLongModels)) {}

  // `value` when coding; what it was when decoding.
  Value code(int energy, Value prediction, Value value) {
    return bits_ <= kTreeBits ? code_whole(energy, prediction, value)
                              : code_by_length(energy, prediction, value);
  }

 private:
  Value code_whole(int energy, Value prediction, Value value) {
    const std::uint32_t mask = (1u << bits_) - 1, middle = 1u << (bits_ - 1);
    const std::uint32_t difference =
        (static_cast<std::uint32_t>(value - prediction) + middle) & mask;
    BitModel* models = &models_[static_cast<std::size_t>(energy) * kTreeModels];
    std::uint32_t node = 1;
    for (int bit = bits_ - 1; bit >= 0; --bit)
      node = 2 * node + coder_.code(models[node], difference >> bit & 1);
    return (prediction + static_cast<Value>(node & mask) - middle) & mask;
  }

  Value code_by_length(int energy, Value prediction, Value value) {
    const Value signed_difference = value - prediction;
    const auto folded = static_cast<std::uint64_t>(
        signed_difference >= 0 ? 2 * signed_difference : -2 * signed_difference - 1
    );
    BitModel* models = &models_[static_cast<std::size_t>(energy) * kLongModels];
    const int length = code_length(models, length_of(folded));
    const std::uint64_t found = code_rest(models + kLengthModels, length, folded);
    const auto half = static_cast<Value>(found >> 1);
    return prediction + ((found & 1) != 0 ? -half - 1 : half);
  }
  int code_length(BitModel* models, int length) {
    int found = 0;
    while (found < kLengths - 1 && coder_.code(models[found], found < length)) ++found;
    return found;
  }
  std::uint64_t code_rest(BitModel* models, int length, std::uint64_t folded) {
    if (length <= 1) return static_cast<std::uint64_t>(length);
    std::uint64_t found = 1;
    for (int bit = length - 2; bit >= 0; --bit) {
      const bool wanted = (folded >> bit & 1) != 0;
      const bool modeled = length - 2 - bit < kModeledBits;
      BitModel* model = models + (static_cast<std::size_t>(length) << kModeledBits);
      found = 2 * found + (modeled ? coder_.code(model[found], wanted) : coder_.code(wanted));
    }
    return found;
  }

  int bits_;
  Coder& coder_;
  std::vector<BitModel> models_;
};

// One channel of the picture at hand.
struct ChannelRows {
  Rows samples;
  ErrorRows<Predictions> errors;
  ErrorRows<Value> differences;  // magnitudes
  ChannelRows(int width, Value middle)
      : samples(width, middle), errors(width), differences(width) {}
  void next_row() {
    samples.next_row();
    errors.next_row();
    differences.next_row();
  }
};

template <class Coder>
class Walk {
 public:
  Walk(const SampleFormat& format, Coder& coder)
      : format_(format), most_((Value{1} << format.bits) - 1) {
    for (int c = 0; c < format.channels; ++c) differences_.emplace_back(format.bits, coder);
  }

  // False: `go_on` said so after a row.
  template <class Sample, class F>
  bool picture(ImageSize size, std::span<Sample> samples, F&& go_on) {
    std::vector<ChannelRows> channels(
        static_cast<std::size_t>(format_.channels), ChannelRows(size.width, (most_ + 1) / 2)
    );
    Sample* sample = samples.data();
    for (int y = 0; y < size.height; ++y) {
      for (ChannelRows& channel : channels) channel.next_row();
      for (int x = 0; x < size.width; ++x)
        for (std::size_t c = 0; c < channels.size(); ++c, ++sample) {
          const Value value = code(channels, c, x, *sample);
          if constexpr (!std::is_const_v<Sample>) *sample = static_cast<Sample>(value);
        }
      if (!go_on()) return false;
    }
    return true;
  }

 private:
  Value code(std::vector<ChannelRows>& channels, std::size_t c, int x, Value value) {
    ChannelRows& channel = channels[c];
    ChannelRows* before = c > 0 ? &channels[c - 1] : nullptr;
    const Predictions predictions = predictions_at(channel, before, x);
    const Value mean = weighted_mean(
        predictions, errors_around(channel, x), before != nullptr ? kPredictions : kOwn
    );
    const Value prediction = std::clamp(mean, Value{0}, most_);
    const int energy = energy_class(energy_around(channel, before, x));
    value = differences_[c].code(energy, prediction, value);
    channel.samples.at(x) = value;
    for (std::size_t i = 0; i < kPredictions; ++i)
      channel.errors.at(x)[i] = std::abs(value - predictions[i]);
    channel.differences.at(x) = std::abs(value - prediction);
    return value;
  }

  static Predictions predictions_at(ChannelRows& channel, ChannelRows* before, int x) {
    Predictions predictions{};
    predict(channel.samples.around(x), predictions.data());
    if (before == nullptr) return predictions;
    std::array<Value, kOwn> foreseen;
    predict(before->samples.around(x), foreseen.data());
    for (std::size_t i = 0; i < kMoved; ++i)
      predictions[kOwn + i] = predictions[i] + before->samples.at(x) - foreseen[i];
    return predictions;
  }
  static Predictions errors_around(const ChannelRows& channel, int x) {
    const auto &w = channel.errors.left(x), &n = channel.errors.above(x),
               &nw = channel.errors.above(x - 1), &ne = channel.errors.above(x + 1);
    Predictions sums;
    for (std::size_t i = 0; i < kPredictions; ++i) sums[i] = w[i] + n[i] + nw[i] + ne[i];
    return sums;
  }
  static Value energy_around(const ChannelRows& channel, ChannelRows* before, int x) {
    const ErrorRows<Value>& d = channel.differences;
    Value energy = 2 * d.left(x) + 2 * d.above(x) + d.above(x - 1) + d.above(x + 1);
    if (before != nullptr) energy += 2 * before->differences.at(x);
    return energy;
  }

  SampleFormat format_;
  Value most_;
  std::vector<Differences<Coder>> differences_;
};

}  // namespace

struct SampleEncoder::State {
  RangeEncoder coder;
  Walk<RangeEncoder> walk;
  explicit State(const SampleFormat& format) : walk(format, coder) {}
};

SampleEncoder::SampleEncoder(const SampleFormat& format)
    : state_(std::make_unique<State>(format)) {}
SampleEncoder::~SampleEncoder() = default;

void SampleEncoder::add(ImageSize size, std::span<const std::uint32_t> samples) {
  state_->walk.picture(size, samples, [] { return true; });
}

std::string SampleEncoder::finish() { return state_->coder.finish(); }

struct SampleDecoder::State {
  RangeDecoder coder;
  Walk<RangeDecoder> walk;
  State(const SampleFormat& format, std::string_view coded) : coder(coded), walk(format, coder) {}
};

SampleDecoder::SampleDecoder(const SampleFormat& format, std::string_view coded)
    : state_(std::make_unique<State>(format, coded)) {}
SampleDecoder::~SampleDecoder() = default;

bool SampleDecoder::read(ImageSize size, std::span<std::uint32_t> samples) {
  return state_->walk.picture(size, samples, [&] { return !state_->coder.passed_end(); });
}

bool SampleDecoder::ended_well() const { return state_->coder.ended_well(); }

}  // namespace glint

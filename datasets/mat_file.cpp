// SPDX-License-Identifier: MIT
// "MAT-File Format", MathWorks, chapter 1: a header of 128 bytes, then elements of a tag (kind,
// bytes) and data in multiples of eight.
#include "datasets/mat_file.h"

#include <libdeflate.h>

#include <cstring>
#include <memory>
#include <string_view>

#include "glint/core/error.h"

namespace glint {
namespace {

enum Kind : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
  kInt64 = 12,
  kUint64 = 13,
  kMatrix = 14,
  kCompressed = 15,
};
constexpr std::uint32_t kStructClass = 2;
constexpr int kDeepest = 8;

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(
      ExitCode::kBadReference,
      fmt::format("{}: not a whole MAT file of level 5 ({}); save it again with -v7", path, what)
  );
}

struct Element {
  std::uint32_t kind = 0;
  std::string_view data;
};

template <class T>
T take(std::string_view bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

// Elements one after the other, little-endian.
class Elements {
 public:
  Elements(const std::string& path, std::string_view bytes) : path_(path), rest_(bytes) {}

  bool empty() const { return rest_.size() < 8; }

  Element next() {
    if (empty()) fail(path_, "it ends inside an element");
    const auto first = take<std::uint32_t>(rest_);
    if (first >> 16 != 0) return small(first);
    const auto size = take<std::uint32_t>(rest_.substr(4));
    if (size > rest_.size() - 8) fail(path_, "an element is longer than the file");
    const Element element{first, rest_.substr(8, size)};
    const std::size_t padded = first == kCompressed ? size : (size + std::size_t{7}) / 8 * 8;
    rest_.remove_prefix(std::min(8 + padded, rest_.size()));
    return element;
  }

 private:
  // Up to four bytes stand in the tag itself.
  Element small(std::uint32_t first) {
    const std::uint32_t size = first >> 16;
    if (size > 4) fail(path_, "a short element of more than four bytes");
    const Element element{first & 0xffff, rest_.substr(4, size)};
    rest_.remove_prefix(8);
    return element;
  }

  const std::string& path_;
  std::string_view rest_;
};

template <class T>
std::vector<double> converted(std::string_view data) {
  std::vector<double> values(data.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<double>(take<T>(data.substr(i * sizeof(T))));
  return values;
}

// Empty: no numbers.
std::vector<double> numbers_of(const Element& element) {
  switch (element.kind) {
    case kInt8:
      return converted<std::int8_t>(element.data);
    case kUint8:
      return converted<std::uint8_t>(element.data);
    case kInt16:
      return converted<std::int16_t>(element.data);
    case kUint16:
      return converted<std::uint16_t>(element.data);
    case kInt32:
      return converted<std::int32_t>(element.data);
    case kUint32:
      return converted<std::uint32_t>(element.data);
    case kSingle:
      return converted<float>(element.data);
    case kDouble:
      return converted<double>(element.data);
    case kInt64:
      return converted<std::int64_t>(element.data);
    case kUint64:
      return converted<std::uint64_t>(element.data);
    default:
      return {};
  }
}

struct FreeDecompressor {
  void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

std::string inflated(const std::string& path, std::string_view data) {
  constexpr std::size_t kMostRatio = 1032;  // of deflate
  const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(
      libdeflate_alloc_decompressor()
  );
  GLINT_CHECK(decompressor != nullptr, kEnvironment, "out of memory while reading {}", path);
  for (std::size_t size = 4 * data.size() + 64; size <= kMostRatio * data.size() + 4096;
       size *= 4) {
    std::string bytes(size, '\0');
    std::size_t found = 0;
    const auto result = libdeflate_zlib_decompress(
        decompressor.get(), data.data(), data.size(), bytes.data(), bytes.size(), &found
    );
    if (result == LIBDEFLATE_SUCCESS) {
      bytes.resize(found);
      return bytes;
    }
    if (result != LIBDEFLATE_INSUFFICIENT_SPACE) break;
  }
  fail(path, "compressed data are damaged");
}

struct NamedValue {
  std::string name;
  MatValue value;
};

NamedValue matrix_of(const std::string& path, std::string_view data, int depth);

std::string text_of(std::string_view bytes) {
  return std::string(bytes.substr(0, bytes.find('\0')));
}

// The names of a struct's fields have one length each; of its elements the first counts.
void read_fields(const std::string& path, Elements& elements, int depth, MatValue& value) {
  const std::vector<double> length = numbers_of(elements.next());
  const std::string_view names = elements.next().data;
  const auto each = length.empty() ? 0 : static_cast<std::int64_t>(length[0]);
  if (each < 1 || each > 1024) fail(path, "a struct's fields have names of no length");
  for (std::size_t at = 0; at + static_cast<std::size_t>(each) <= names.size();
       at += static_cast<std::size_t>(each)) {
    if (elements.empty()) return;  // a struct of no elements
    const Element field = elements.next();
    if (field.kind != kMatrix) fail(path, "a field that is no array");
    value.fields[text_of(names.substr(at, static_cast<std::size_t>(each)))] =
        matrix_of(path, field.data, depth + 1).value;
  }
}

NamedValue matrix_of(const std::string& path, std::string_view data, int depth) {
  if (depth > kDeepest) fail(path, "nested more than 8 deep");
  Elements elements(path, data);
  if (elements.empty()) return {};  // an empty array may have no parts
  const std::vector<double> flags = numbers_of(elements.next());
  NamedValue matrix;
  std::size_t count = 1;
  for (const double extent : numbers_of(elements.next())) {
    if (!(extent >= 0 && extent < 1e9)) fail(path, "an array with an impossible extent");
    matrix.value.extents.push_back(static_cast<std::size_t>(extent));
    count *= matrix.value.extents.back();
  }
  matrix.name = std::string(elements.next().data);
  const auto kind = flags.empty() ? 0 : static_cast<std::uint32_t>(flags[0]) & 0xff;
  if (kind == kStructClass) {
    read_fields(path, elements, depth, matrix.value);
  } else if (!elements.empty()) {
    matrix.value.values = numbers_of(elements.next());
    if (!matrix.value.values.empty() && matrix.value.values.size() != count)
      fail(path, fmt::format("'{}' does not have the size that it states", matrix.name));
  }
  return matrix;
}

}  // namespace

std::map<std::string, MatValue> read_mat(const fs::path& path) {
  constexpr std::size_t kHeader = 128;
  const std::string name = path.string(), file = read_file(path);
  if (file.size() < kHeader || std::string_view(file).substr(126, 2) != "IM")
    fail(name, file.starts_with("MATLAB 7.3") ? "it is level 7.3, which is HDF5" : "its header");
  std::map<std::string, MatValue> values;
  Elements elements(name, std::string_view(file).substr(kHeader));
  while (!elements.empty()) {
    const Element element = elements.next();
    const std::string unpacked =
        element.kind == kCompressed ? inflated(name, element.data) : std::string();
    const Element inner = element.kind == kCompressed ? Elements(name, unpacked).next() : element;
    if (inner.kind != kMatrix) continue;
    NamedValue matrix = matrix_of(name, inner.data, 0);
    values[matrix.name] = std::move(matrix.value);
  }
  return values;
}

}  // namespace glint

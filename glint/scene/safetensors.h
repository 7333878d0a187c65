// SPDX-License-Identifier: MIT
// Named arrays in one file, as the safetensors format lays them out: the length of the header (8
// bytes, little-endian), a JSON header with type, shape and byte range of each array, the arrays
// without gaps. Nothing of a header is believed before it was compared with the file.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

enum class TensorType { kU8, kU16, kI32, kU32, kU64, kF32, kF64 };
std::size_t bytes_of(TensorType type);
const char* name_of(TensorType type);  // as in the header: "U8", "F32", ...

template <class T>
inline constexpr TensorType kTensorTypeOf = TensorType::kU8;
template <>
inline constexpr TensorType kTensorTypeOf<std::uint16_t> = TensorType::kU16;
template <>
inline constexpr TensorType kTensorTypeOf<std::int32_t> = TensorType::kI32;
template <>
inline constexpr TensorType kTensorTypeOf<std::uint32_t> = TensorType::kU32;
template <>
inline constexpr TensorType kTensorTypeOf<std::uint64_t> = TensorType::kU64;
template <>
inline constexpr TensorType kTensorTypeOf<float> = TensorType::kF32;
template <>
inline constexpr TensorType kTensorTypeOf<double> = TensorType::kF64;

struct TensorInfo {
  TensorType type = TensorType::kF32;
  std::vector<std::size_t> shape;  // row-major, last index fastest

  std::size_t num_values() const;
  std::size_t num_bytes() const { return num_values() * bytes_of(type); }
};
std::string shape_text(const std::vector<std::size_t>& shape);  // "(3, 4)"

struct TensorToWrite {
  std::string name;
  TensorInfo info;
  std::function<void(std::byte*)> fill;  // writes info.num_bytes() bytes
};

// Atomically; one tensor at a time is in memory besides. Wider types come first, so that every
// array is aligned; the order is kept otherwise. Errors (kEnvironment): as write_file.
void write_safetensors(
    const fs::path& path,
    const std::map<std::string, std::string>& metadata,
    const std::vector<TensorToWrite>& tensors
);

class SafetensorsFile {
 public:
  // Reads and checks the header. Errors (kBadReference): missing, cut off, not such a file, a type
  // that is not among ours, a shape that is not its byte range, ranges that overlap, leave gaps or
  // pass the end.
  explicit SafetensorsFile(const fs::path& path);

  const fs::path& path() const { return path_; }
  const std::map<std::string, std::string>& metadata() const { return metadata_; }
  const TensorInfo* find(const std::string& name) const;  // null: none of that name
  std::vector<std::string> names() const;

  // All values of the tensor, whose type must be T. Errors (kBadReference): no such tensor, another
  // type or shape, reading fails.
  template <class T>
  std::vector<T> read(const std::string& name, const std::vector<std::size_t>& shape) {
    check(name, kTensorTypeOf<T>, shape);
    std::vector<T> values(find(name)->num_values());
    read_bytes(name, std::as_writable_bytes(std::span<T>(values)));
    return values;
  }
  // The bytes of a tensor that find() knows, as many as it has. Errors (kBadReference): reading
  // fails.
  void read_bytes(const std::string& name, std::span<std::byte> to);

 private:
  struct Entry {
    TensorInfo info;
    std::size_t begin = 0, end = 0;  // bytes behind the header
  };
  static Entry parse_entry(
      const fs::path& path, const std::string& name, const nlohmann::json& json
  );
  void read_header(std::size_t file_bytes);
  void check_ranges() const;
  void check(const std::string& name, TensorType type, const std::vector<std::size_t>& shape) const;

  fs::path path_;
  std::ifstream in_;
  std::size_t data_begin_ = 0, data_bytes_ = 0;
  std::map<std::string, std::string> metadata_;
  std::map<std::string, Entry> entries_;
};

}  // namespace glint

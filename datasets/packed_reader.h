// SPDX-License-Identifier: MIT
// The file of a packed scene, and what its tensors of maps and points hold, of either version.
#pragma once

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "datasets/packed_scene_format.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/scene/safetensors.h"

namespace glint::packed {

using Shape = std::vector<std::size_t>;

// The file, and which of its tensors were asked for.
class Reader {
 public:
  explicit Reader(const fs::path& path) : file_(path) {}

  std::string where() const { return file_.path().string(); }

  const std::string& field(const std::string& key) const {
    const auto it = file_.metadata().find(key);
    GLINT_CHECK(
        it != file_.metadata().end(),
        kBadReference,
        "{}: __metadata__ has no {}; expected a file that `glint-bench dataset pack` wrote",
        where(),
        key
    );
    return it->second;
  }
  bool has_field(const std::string& key) const { return file_.metadata().contains(key); }
  std::vector<std::string> list(const std::string& key) const {
    const Json json = parse_json(field(key));
    const bool good = json.is_array() && std::all_of(json.begin(), json.end(), [](const auto& v) {
                        return v.is_string();
                      });
    GLINT_CHECK(
        good, kBadReference, "{}: __metadata__: {} is no list of texts; pack it again", where(), key
    );
    return json.get<std::vector<std::string>>();
  }

  bool has(const std::string& name) const { return file_.find(name) != nullptr; }
  // The first extent of a tensor; 0 where there is none.
  std::size_t count(const std::string& name) const {
    const TensorInfo* info = file_.find(name);
    return info == nullptr || info->shape.empty() ? 0 : info->shape[0];
  }
  template <class T>
  std::vector<T> read(const std::string& name, const Shape& shape) {
    used_.insert(name);
    return file_.read<T>(name, shape);
  }
  // A tensor of bytes. Errors: as read().
  std::string read_text(const std::string& name) {
    const std::vector<std::uint8_t> bytes = read<std::uint8_t>(name, {count(name)});
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  bool is_first_version() const { return field("version") == kFirstVersion; }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw Error(
        ExitCode::kBadReference,
        fmt::format("{}: tensor {}: {}; copy or pack it again", where(), name, what)
    );
  }
  // Of version 1: floats, or integers over their maximum.
  std::vector<float> read_floats(const std::string& name, const Shape& shape) {
    const TensorInfo* info = file_.find(name);
    std::vector<float> values;
    if (info != nullptr && info->type == TensorType::kU8)
      values = steps<std::uint8_t>(name, shape);
    else if (info != nullptr && info->type == TensorType::kU16)
      values = steps<std::uint16_t>(name, shape);
    else
      values = read<float>(name, shape);
    return values;
  }
  void check_all_used() const {
    for (const std::string& name : file_.names())
      GLINT_CHECK(
          used_.contains(name),
          kBadReference,
          "{}: tensor {} has no place in a scene of version {}; pack it again",
          where(),
          name,
          field("version")
      );
  }

 private:
  template <class T>
  std::vector<float> steps(const std::string& name, const Shape& shape) {
    constexpr auto kMax = static_cast<float>(std::numeric_limits<T>::max());
    std::vector<float> values;
    for (const T step : read<T>(name, shape)) values.push_back(static_cast<float>(step) / kMax);
    return values;
  }

  SafetensorsFile file_;
  std::set<std::string> used_;
};

Shape shape_of(ImageSize size, int channels);

// The maps of views whose cameras are known, as far as the file has them. Errors (kBadReference):
// tensors of another type or shape, bytes that are not theirs.
void read_maps(Reader& reader, const std::string& split, std::vector<View>& views);

// Vectors [count][3] that stand as numbers, as in version 1.
std::vector<Vec3f> read_vectors(Reader& reader, const std::string& name, std::size_t count);
PointCloud read_points(Reader& reader);

}  // namespace glint::packed

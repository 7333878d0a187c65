// SPDX-License-Identifier: MIT
#include "glint/scene/safetensors.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kLengthBytes = 8;
constexpr std::size_t kMaxHeader = 100'000'000;  // the format's own limit
constexpr std::size_t kAlignment = 8;            // of the first array
constexpr std::size_t kMaxRank = 8;

struct TypeRow {
  TensorType type;
  const char* name;
  std::size_t bytes;
};
constexpr TypeRow kTypes[] = {
    {TensorType::kU8, "U8", 1},
    {TensorType::kU16, "U16", 2},
    {TensorType::kI32, "I32", 4},
    {TensorType::kU32, "U32", 4},
    {TensorType::kU64, "U64", 8},
    {TensorType::kF32, "F32", 4},
    {TensorType::kF64, "F64", 8}};

const TypeRow& row_of(TensorType type) {
  return *std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeRow& row) {
    return row.type == type;
  });
}

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(
      ExitCode::kBadReference,
      fmt::format(
          "{}: {}; the file is cut off, damaged or no safetensors file: copy or pack it again",
          path.string(),
          what
      )
  );
}

TensorType parse_type(const fs::path& path, const std::string& name, const nlohmann::json& json) {
  const std::string found = json.is_string() ? json.get<std::string>() : json.dump();
  for (const TypeRow& row : kTypes)
    if (found == row.name) return row.type;
  fail(
      path,
      fmt::format("tensor {}: dtype {}, expected U8, U16, I32, U32, U64, F32 or F64", name, found)
  );
}

std::vector<std::size_t> parse_integers(
    const fs::path& path, const std::string& name, const char* field, const nlohmann::json& json
) {
  std::vector<std::size_t> integers;
  const bool good = json.is_array() && json.size() <= kMaxRank &&
                    std::all_of(json.begin(), json.end(), [](const nlohmann::json& extent) {
                      return extent.is_number_unsigned();
                    });
  if (!good)
    fail(path, fmt::format("tensor {}: {} is no list of up to {} counts", name, field, kMaxRank));
  for (const nlohmann::json& extent : json) integers.push_back(extent.get<std::size_t>());
  return integers;
}

// Bytes that the shape takes; saturates.
std::size_t bytes_of_shape(const TensorInfo& info) {
  std::size_t bytes = bytes_of(info.type);
  for (const std::size_t extent : info.shape)
    if (__builtin_mul_overflow(bytes, extent, &bytes))
      return std::numeric_limits<std::size_t>::max();
  return bytes;
}

std::string header_text(
    const std::map<std::string, std::string>& metadata,
    const std::vector<const TensorToWrite*>& tensors
) {
  Json header = {{"__metadata__", metadata}};
  std::size_t begin = 0;
  for (const TensorToWrite* tensor : tensors) {
    const std::size_t end = begin + tensor->info.num_bytes();
    header[tensor->name] = {
        {"dtype", name_of(tensor->info.type)},
        {"shape", tensor->info.shape},
        {"data_offsets", {begin, end}}};
    begin = end;
  }
  std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  return text;
}

void write_tensors(
    std::ostream& out, const std::string& header, const std::vector<const TensorToWrite*>& tensors
) {
  const std::uint64_t length = header.size();
  out.write(reinterpret_cast<const char*>(&length), sizeof length);
  out.write(header.data(), static_cast<std::streamsize>(header.size()));
  std::vector<std::byte> bytes;
  for (const TensorToWrite* tensor : tensors) {
    bytes.resize(tensor->info.num_bytes());
    tensor->fill(bytes.data());
    out.write(
        reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())
    );
  }
}

}  // namespace

std::size_t bytes_of(TensorType type) { return row_of(type).bytes; }
const char* name_of(TensorType type) { return row_of(type).name; }

std::string shape_text(const std::vector<std::size_t>& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

std::size_t TensorInfo::num_values() const {
  std::size_t count = 1;
  for (const std::size_t extent : shape) count *= extent;
  return count;
}

void write_safetensors(
    const fs::path& path,
    const std::map<std::string, std::string>& metadata,
    const std::vector<TensorToWrite>& tensors
) {
  std::vector<const TensorToWrite*> ordered;
  for (const TensorToWrite& tensor : tensors) ordered.push_back(&tensor);
  std::stable_sort(
      ordered.begin(),
      ordered.end(),
      [](const TensorToWrite* a, const TensorToWrite* b) {
        return bytes_of(a->info.type) > bytes_of(b->info.type);
      }
  );
  write_atomically(path, [&](const fs::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    write_tensors(out, header_text(metadata, ordered), ordered);
    out.close();
    GLINT_CHECK(
        out.good(),
        kEnvironment,
        "{}: writing failed ({}); free some disk space or choose another file",
        path.string(),
        std::strerror(errno)
    );
  });
}

SafetensorsFile::Entry SafetensorsFile::parse_entry(
    const fs::path& path, const std::string& name, const nlohmann::json& json
) {
  for (const char* field : {"dtype", "shape", "data_offsets"})
    if (!json.contains(field)) fail(path, fmt::format("tensor {}: no {}", name, field));
  const auto range = parse_integers(path, name, "data_offsets", json["data_offsets"]);
  if (range.size() != 2) fail(path, fmt::format("tensor {}: data_offsets are no pair", name));
  return {
      {parse_type(path, name, json["dtype"]), parse_integers(path, name, "shape", json["shape"])},
      range[0],
      range[1]};
}

SafetensorsFile::SafetensorsFile(const fs::path& path) : path_(path), in_(open_file(path)) {
  read_header(fs::file_size(path));
  check_ranges();
}

void SafetensorsFile::read_header(std::size_t file_bytes) {
  std::uint64_t length = 0;
  if (!in_.read(reinterpret_cast<char*>(&length), sizeof length))
    fail(path_, fmt::format("{} bytes, too few for a header", file_bytes));
  if (length > kMaxHeader || length > file_bytes - kLengthBytes)
    fail(path_, fmt::format("a header of {} bytes in a file of {}", length, file_bytes));
  std::string text(length, '\0');
  if (!in_.read(text.data(), static_cast<std::streamsize>(length)))
    fail(path_, "the header cannot be read");
  // Sorted keys: looking one up among many that a damaged file may claim stays fast.
  if (is_nested_too_deeply(text)) fail(path_, "the header is nested too deeply");
  const auto header = nlohmann::json::parse(text, nullptr, false);
  if (!header.is_object()) fail(path_, "the header is no JSON object");
  data_begin_ = kLengthBytes + length;
  data_bytes_ = file_bytes - data_begin_;
  for (const auto& [name, value] : header.items()) {
    if (!value.is_object()) fail(path_, fmt::format("header: {} is no object", name));
    if (name == "__metadata__") {
      for (const auto& [key, text_value] : value.items())
        if (text_value.is_string()) metadata_[key] = text_value.get<std::string>();
      continue;
    }
    entries_[name] = parse_entry(path_, name, value);
  }
}

// Every byte behind the header belongs to one tensor, and each tensor to its shape.
void SafetensorsFile::check_ranges() const {
  std::vector<std::pair<const std::string*, const Entry*>> order;
  for (const auto& [name, entry] : entries_) {
    if (entry.begin > entry.end || entry.end > data_bytes_)
      fail(
          path_,
          fmt::format("tensor {}: bytes {} to {} of {}", name, entry.begin, entry.end, data_bytes_)
      );
    if (bytes_of_shape(entry.info) != entry.end - entry.begin)
      fail(
          path_,
          fmt::format(
              "tensor {}: shape {} of {} does not fill {} bytes",
              name,
              shape_text(entry.info.shape),
              name_of(entry.info.type),
              entry.end - entry.begin
          )
      );
    order.emplace_back(&name, &entry);
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return std::pair(a.second->begin, a.second->end) < std::pair(b.second->begin, b.second->end);
  });
  std::size_t at = 0;
  for (const auto& [name, entry] : order) {
    if (entry->begin < at)
      fail(path_, fmt::format("tensor {}: its bytes overlap another tensor's", *name));
    if (entry->begin > at)
      fail(
          path_,
          fmt::format("{} bytes in front of tensor {} are no tensor's", entry->begin - at, *name)
      );
    at = entry->end;
  }
  if (at != data_bytes_)
    fail(path_, fmt::format("the last {} bytes are no tensor's", data_bytes_ - at));
}

const TensorInfo* SafetensorsFile::find(const std::string& name) const {
  const auto it = entries_.find(name);
  return it == entries_.end() ? nullptr : &it->second.info;
}

std::vector<std::string> SafetensorsFile::names() const {
  std::vector<std::string> names;
  for (const auto& entry : entries_) names.push_back(entry.first);
  return names;
}

void SafetensorsFile::check(
    const std::string& name, TensorType type, const std::vector<std::size_t>& shape
) const {
  const TensorInfo* info = find(name);
  GLINT_CHECK(
      info != nullptr, kBadReference, "{}: no tensor {}; pack it again", path_.string(), name
  );
  GLINT_CHECK(
      info->type == type && info->shape == shape,
      kBadReference,
      "{}: tensor {} is {} {}, expected {} {}; pack it again",
      path_.string(),
      name,
      name_of(info->type),
      shape_text(info->shape),
      name_of(type),
      shape_text(shape)
  );
}

void SafetensorsFile::read_bytes(const std::string& name, std::span<std::byte> to) {
  const Entry& entry = entries_.at(name);
  in_.seekg(static_cast<std::streamoff>(data_begin_ + entry.begin));
  in_.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
  GLINT_CHECK(in_.good(), kBadReference, "{}: reading tensor {} failed", path_.string(), name);
}

}  // namespace glint

// SPDX-License-Identifier: MIT
#include "glint/scene/ply_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "glint/core/error.h"

namespace glint::detail {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},
    {"int8", PlyType::kInt8},
    {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},
    {"short", PlyType::kInt16},
    {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},
    {"uint16", PlyType::kUint16},
    {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},
    {"uint", PlyType::kUint32},
    {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},
    {"float32", PlyType::kFloat32},
    {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64}};

std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kFloat64:
      return 8;
    default:
      return 4;
  }
}

[[noreturn]] void fail(const std::string& path, const std::string& message) {
  throw Error(ExitCode::kBadReference, fmt::format("{}: {}", path, message));
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

PlyType parse_type(const std::string& path, std::string_view name) {
  for (const TypeName& known : kTypeNames)
    if (known.name == name) return known.type;
  fail(path, fmt::format("PLY header: unknown type '{}'", name));
}

enum class Format { kText, kLittleEndian, kBigEndian };

struct Header {
  Format format = Format::kText;
  std::vector<PlyElement> elements;
  std::size_t rows_at = 0;  // bytes
};

PlyElement parse_element(const std::string& path, const std::vector<std::string_view>& words) {
  PlyElement element;
  if (words.size() != 3) fail(path, "PLY header: expected 'element NAME COUNT'");
  element.name = words[1];
  const auto end =
      std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count);
  if (end.ec != std::errc{} || end.ptr != words[2].data() + words[2].size())
    fail(path, fmt::format("PLY header: element {}: '{}' is not a count", words[1], words[2]));
  return element;
}

void parse_property(
    const std::string& path,
    const std::vector<std::string_view>& words,
    std::vector<PlyElement>& elements
) {
  if (elements.empty()) fail(path, "PLY header: a property before the first element");
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3)
    fail(path, fmt::format("PLY header: cannot read '{}'", fmt::join(words, " ")));
  PlyElement& element = elements.back();
  PlyProperty property{
      std::string(words.back()), parse_type(path, words[words.size() - 2]), is_list};
  if (is_list) property.count_type = parse_type(path, words[2]);
  if (!is_list) ++element.num_scalars;
  element.properties.push_back(std::move(property));
}

Format parse_format(const std::string& path, const std::vector<std::string_view>& words) {
  const std::string_view format = words.size() > 1 ? words[1] : "";
  if (format == "ascii") return Format::kText;
  if (format == "binary_little_endian") return Format::kLittleEndian;
  if (format == "binary_big_endian") return Format::kBigEndian;
  fail(path, fmt::format("PLY format '{}'; expected ascii or binary_little_endian", format));
}

// For viewers' own formats of Gaussians.
std::string_view export_of(std::string_view path) {
  for (const std::string_view viewer : {".splat", ".ksplat", ".spz", ".sog"})
    if (path.ends_with(viewer))
      return "; a viewer's format, with less in it than was trained: take the trainer's PLY, or "
             "export one (SuperSplat)";
  return "";
}

Header parse_header(const std::string& path, std::string_view file) {
  Header header;
  bool has_format = false;
  if (!file.starts_with("ply\n") && !file.starts_with("ply\r\n"))
    fail(path, fmt::format("not a PLY file (the first line is not 'ply'){}", export_of(path)));
  for (std::size_t at = 0;;) {
    const std::size_t end = file.find('\n', at);
    if (end == std::string_view::npos)
      fail(path, "the PLY header has no end_header; write it again");
    const std::vector<std::string_view> words = split_words(file.substr(at, end - at));
    at = end + 1;
    const std::string_view keyword = words.empty() ? "comment" : words[0];
    if (keyword == "format") {
      header.format = parse_format(path, words);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(parse_element(path, words));
    } else if (keyword == "property") {
      parse_property(path, words, header.elements);
    } else if (keyword == "end_header") {
      if (!has_format) fail(path, "the PLY header has no format line");
      header.rows_at = at;
      return header;
    } else if (keyword != "comment" && keyword != "obj_info" && keyword != "ply") {
      fail(path, fmt::format("PLY header: unknown keyword '{}'", keyword));
    }
  }
}

// Reads values of either format from the front of the rows.
class RowSource {
 public:
  RowSource(std::string_view rows, Format format)
      : rows_(rows), binary_(format != Format::kText), big_endian_(format == Format::kBigEndian) {}

  std::size_t remaining() const { return rows_.size() - at_; }
  // Bytes that are no value's. Text ends with any space, binary rows with one line break at most.
  std::size_t left_over() const {
    const std::string_view rest = rows_.substr(at_);
    const bool blank = rest.find_first_not_of(" \t\r\n") == std::string_view::npos;
    return blank && (!binary_ || rest.size() <= 2) ? 0 : rest.size();
  }
  // The fewest bytes that one value can take: ASCII needs a digit and a separator.
  std::size_t least_bytes(PlyType type) const { return binary_ ? byte_size(type) : 2; }
  // False when the rows end or hold no number.
  bool next(PlyType type, double& value) {
    return binary_ ? next_binary(type, value) : next_text(value);
  }

 private:
  template <class T>
  double take() {
    T value;
    std::memcpy(&value, rows_.data() + at_, sizeof value);
    if (big_endian_) {
      auto* bytes = reinterpret_cast<std::byte*>(&value);
      std::reverse(bytes, bytes + sizeof value);
    }
    at_ += sizeof value;
    return static_cast<double>(value);
  }

  bool next_binary(PlyType type, double& value) {
    if (remaining() < byte_size(type)) return false;
    switch (type) {
      case PlyType::kInt8:
        value = take<std::int8_t>();
        break;
      case PlyType::kUint8:
        value = take<std::uint8_t>();
        break;
      case PlyType::kInt16:
        value = take<std::int16_t>();
        break;
      case PlyType::kUint16:
        value = take<std::uint16_t>();
        break;
      case PlyType::kInt32:
        value = take<std::int32_t>();
        break;
      case PlyType::kUint32:
        value = take<std::uint32_t>();
        break;
      case PlyType::kFloat32:
        value = take<float>();
        break;
      case PlyType::kFloat64:
        value = take<double>();
        break;
    }
    return true;
  }

  bool next_text(double& value) {
    at_ = std::min(rows_.find_first_not_of(" \t\r\n", at_), rows_.size());
    const auto end = std::from_chars(rows_.data() + at_, rows_.data() + rows_.size(), value);
    if (end.ec != std::errc{}) return false;
    at_ = static_cast<std::size_t>(end.ptr - rows_.data());
    return true;
  }

  std::string_view rows_;
  bool binary_, big_endian_;
  std::size_t at_ = 0;
};

[[noreturn]] void fail_row(const std::string& path, const PlyElement& element, std::size_t row) {
  fail(
      path,
      fmt::format(
          "element {}: row {} of {} cannot be read; the file is cut off or damaged, write it again",
          element.name,
          row,
          element.count
      )
  );
}

// A count is believed once the rest of the file could hold that many of the smallest rows.
void check_count(const std::string& path, const PlyElement& element, const RowSource& source) {
  std::size_t row_bytes = 0;
  for (const PlyProperty& property : element.properties)
    row_bytes += source.least_bytes(property.is_list ? property.count_type : property.type);
  if (element.count == 0) return;
  if (row_bytes == 0) fail(path, fmt::format("element {} has no properties", element.name));
  const std::size_t most =
      (source.remaining() + 1) / row_bytes;  // the last separator may be missing
  if (element.count > most)
    fail(
        path,
        fmt::format(
            "element {}: the header gives {} rows, the file holds at most {}; it is cut off or "
            "damaged, "
            "write it again",
            element.name,
            element.count,
            most
        )
    );
}

// Appends one list, or passes over it; false when it cannot be read or its length exceeds what the
// file can hold.
bool read_list(RowSource& source, const PlyProperty& property, bool is_kept, PlyElement& element) {
  double length = 0;
  if (!source.next(property.count_type, length)) return false;
  const auto most =
      static_cast<double>((source.remaining() + 1) / source.least_bytes(property.type));
  if (!(length >= 0 && length <= most)) return false;
  for (double i = 0; i < length; ++i) {
    double item = 0;
    if (!source.next(property.type, item) || !(std::abs(item) < 1e15)) return false;
    if (is_kept) element.list_items.push_back(static_cast<std::int64_t>(item));
  }
  if (is_kept) element.list_ends.push_back(element.list_items.size());
  return true;
}

// Of several lists that of vertices, else the first: MeshLab and Open3D write coordinates of
// textures beside.
const PlyProperty* kept_list(const PlyElement& element) {
  const PlyProperty* kept = nullptr;
  for (const PlyProperty& property : element.properties)
    if (property.is_list && (kept == nullptr || property.name.starts_with("vertex_ind")))
      kept = &property;
  return kept;
}

void read_rows(const std::string& path, RowSource& source, PlyElement& element) {
  check_count(path, element, source);
  const PlyProperty* kept = kept_list(element);
  element.scalars.reserve(element.count * element.num_scalars);
  for (std::size_t row = 0; row < element.count; ++row)
    for (const PlyProperty& property : element.properties) {
      double value = 0;
      const bool good = property.is_list ? read_list(source, property, &property == kept, element)
                                         : source.next(property.type, value);
      if (!good) fail_row(path, element, row);
      if (!property.is_list) element.scalars.push_back(static_cast<float>(value));
    }
}

// "100 vertex, 196 face".
std::string counts_text(const std::vector<PlyElement>& elements) {
  std::string text;
  for (const PlyElement& element : elements)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", element.count, element.name);
  return text;
}

}  // namespace

int PlyElement::find_scalar(std::string_view property) const {
  int column = 0;
  for (const PlyProperty& candidate : properties) {
    if (candidate.is_list) continue;
    if (candidate.name == property) return column;
    ++column;
  }
  return -1;
}

const PlyElement& PlyFile::element(std::string_view name) const {
  std::string found;
  for (const PlyElement& candidate : elements) {
    if (candidate.name == name) return candidate;
    found += (found.empty() ? "" : ", ") + candidate.name;
  }
  fail(path, fmt::format("no element '{}'; found: {}", name, found.empty() ? "none" : found));
}

namespace {
PlyFile read_ply_file(const fs::path& path) {
  const std::string file = read_file(path);
  Header header = parse_header(path.string(), file);
  RowSource source(std::string_view(file).substr(header.rows_at), header.format);
  for (PlyElement& element : header.elements) read_rows(path.string(), source, element);
  if (source.left_over() > 0)
    fail(
        path.string(),
        fmt::format(
            "{} bytes are left behind the rows that the header counts ({}); a count or the file is "
            "damaged, write it again",
            source.left_over(),
            counts_text(header.elements)
        )
    );
  return {path.string(), std::move(header.elements)};
}

}  // namespace

PlyFile read_ply(const fs::path& path) {
  return read_within_memory(path, [&] { return read_ply_file(path); });
}

std::vector<std::string> read_ply_element_names(const fs::path& path) {
  std::vector<std::string> names;
  for (const PlyElement& element : parse_header(path.string(), read_file(path)).elements)
    names.push_back(element.name);
  return names;
}

}  // namespace glint::detail

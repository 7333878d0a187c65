// SPDX-License-Identifier: MIT
#include "glint/core/npy.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include "glint/core/error.h"

namespace glint {
namespace {

// The text behind 'key': in the dictionary.
std::string_view value_of(
    std::string_view dictionary, std::string_view key, std::string_view where
) {
  const std::size_t at = dictionary.find(fmt::format("'{}':", key));
  GLINT_CHECK(
      at != std::string_view::npos, kBadReference, "{}: the NPY header lacks '{}'", where, key
  );
  std::string_view value = dictionary.substr(at + key.size() + 3);
  value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
  return value;
}

// "'<f4', ..." to the text between the quotes.
std::string quoted(std::string_view text) {
  text.remove_prefix(std::min<std::size_t>(1, text.size()));
  return std::string(text.substr(0, text.find_first_of("'\"")));
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

// "(540, 960, 3)" or "(7,)" to numbers; nothing: it is no such tuple.
std::optional<std::vector<std::int64_t>> parse_shape(std::string_view text) {
  const std::size_t end = text.find(')');
  if (!text.starts_with('(') || end == std::string_view::npos) return std::nullopt;
  text = trimmed(text.substr(1, end - 1));
  std::vector<std::int64_t> shape;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view word = trimmed(text.substr(0, comma));
    std::int64_t extent = 0;
    const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), extent);
    if (word.empty() || word[0] == '-' || last != word.data() + word.size()) return std::nullopt;
    shape.push_back(error == std::errc{} ? extent : std::numeric_limits<std::int64_t>::max());
    text = trimmed(text.substr(std::min(comma + 1, text.size())));
  }
  return shape;
}

// "True" or "False", and nothing behind it but the next entry.
std::optional<bool> parse_bool(std::string_view text) {
  const std::string_view word = trimmed(text.substr(0, text.find_first_of(",}")));
  if (word == "True") return true;
  return word == "False" ? std::optional(false) : std::nullopt;
}

// Of an entry, for people: to its end, not to that of the header.
std::string entry(std::string_view text) {
  return std::string(trimmed(text.substr(0, std::min<std::size_t>(40, text.find("}")))));
}

}  // namespace

NpyHeader parse_npy_header(std::string_view file, std::string_view where) {
  const auto check_complete = [&](bool complete, const char* detail) {
    GLINT_CHECK(
        complete,
        kBadReference,
        "{}: not a complete NPY file ({}); copy or write it again",
        where,
        detail
    );
  };
  check_complete(file.starts_with(kNpyMagic) && file.size() >= 12, "the signature is missing");
  const std::size_t length_bytes = file[6] == 1 ? 2 : 4;
  std::size_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i)
    length |= std::size_t{static_cast<unsigned char>(file[8 + i])} << (8 * i);
  check_complete(file.size() - 8 - length_bytes >= length, "it ends inside the header");
  const std::string_view dictionary = file.substr(8 + length_bytes, length);
  const std::string_view shape_text = value_of(dictionary, "shape", where);
  const auto shape = parse_shape(shape_text);
  GLINT_CHECK(
      shape,
      kBadReference,
      "{}: the NPY header's 'shape' is {}; expected whole numbers, such as (540, 960, 3)",
      where,
      entry(shape_text)
  );
  const std::string_view order_text = value_of(dictionary, "fortran_order", where);
  const auto fortran_order = parse_bool(order_text);
  GLINT_CHECK(
      fortran_order,
      kBadReference,
      "{}: the NPY header's 'fortran_order' is {}; expected True or False",
      where,
      entry(order_text)
  );
  return {
      quoted(value_of(dictionary, "descr", where)),
      *shape,
      *fortran_order,
      8 + length_bytes + length};
}

}  // namespace glint

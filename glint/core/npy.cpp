// SPDX-License-Identifier: MIT
#include "glint/core/npy.h"

#include <algorithm>
#include <charconv>
#include <limits>

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

// "(540, 960, 3)" to numbers.
std::vector<std::int64_t> parse_shape(std::string_view text) {
  std::vector<std::int64_t> shape;
  text = text.substr(0, text.find(')'));
  while (true) {
    const std::size_t digit = text.find_first_of("0123456789");
    if (digit == std::string_view::npos) return shape;
    std::int64_t extent = 0;
    const auto end = std::from_chars(text.data() + digit, text.data() + text.size(), extent);
    shape.push_back(end.ec == std::errc{} ? extent : std::numeric_limits<std::int64_t>::max());
    text.remove_prefix(static_cast<std::size_t>(end.ptr - text.data()));
  }
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
  return {
      quoted(value_of(dictionary, "descr", where)),
      parse_shape(value_of(dictionary, "shape", where)),
      value_of(dictionary, "fortran_order", where).starts_with("True"),
      8 + length_bytes + length};
}

}  // namespace glint

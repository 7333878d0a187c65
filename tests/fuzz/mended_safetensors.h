// SPDX-License-Identifier: MIT
// Damage behind a safetensors file's checks: what the header says is made to fit the bytes.
#pragma once

#include <cstring>
#include <string>
#include <string_view>

#include "glint/core/config.h"

namespace glint::fuzz {

inline constexpr std::size_t kLengthBytes = 8, kMostTensorBytes = 4096;

// Where the object that the text begins with ends; 0: nowhere.
inline std::size_t end_of_object(std::string_view text) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_text && text[i] == '\\')
      ++i;
    else if (text[i] == '"')
      in_text = !in_text;
    else if (!in_text && text[i] == '{')
      ++depth;
    else if (!in_text && text[i] == '}' && --depth <= 0)
      return i + 1;
  }
  return 0;
}

inline std::size_t claimed_bytes(const Json& tensor) {
  const Json dtype = tensor.value("dtype", Json());
  const std::string type = dtype.is_string() ? dtype.get<std::string>() : "U8";
  std::size_t bytes = type.ends_with("64") ? 8 : type.ends_with("32") ? 4 : type == "U16" ? 2 : 1;
  for (const Json& extent : tensor["shape"])
    if (__builtin_mul_overflow(
            bytes, extent.is_number_unsigned() ? extent.get<std::size_t>() : 1, &bytes
        ))
      return 0;
  return bytes <= kMostTensorBytes ? bytes : 0;
}

// The same header with the length and the byte ranges that it should have, and as many bytes
// behind it. Where there is no header, the bytes as they are.
inline std::string mended_safetensors(std::string_view bytes) {
  const std::string_view body = bytes.substr(std::min(bytes.size(), kLengthBytes));
  const std::size_t end = end_of_object(body);
  Json header = parse_json(body.substr(0, end));
  if (!header.is_object()) return std::string(bytes);
  std::size_t at = 0;
  for (auto& [name, tensor] : header.items())
    if (name != "__metadata__" && tensor.is_object() && tensor["shape"].is_array()) {
      const std::size_t size = claimed_bytes(tensor);
      tensor["data_offsets"] = {at, at + size};
      at += size;
    }
  const std::string text = header.dump();
  std::string mended(kLengthBytes, '\0');
  const std::uint64_t length = text.size();
  std::memcpy(mended.data(), &length, sizeof length);
  std::string values(body.substr(end));
  values.resize(at);
  return mended + text + values;
}

}  // namespace glint::fuzz

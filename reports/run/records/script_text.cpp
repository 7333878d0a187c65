// SPDX-License-Identifier: MIT
#include "reports/run/records/script_text.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace glint {

namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

std::string script_json(const Json& json) {
  std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  return text;
}

std::string part_script(const std::string& name, const Json& json) {
  return fmt::format(
      "(window.GLINT_PARTS=window.GLINT_PARTS||{{}})[{}]={};\n",
      script_json(Json(name)),
      script_json(json)
  );
}

std::string inline_text(std::string_view text) {
  std::string safe(text);
  replace_all(safe, "</script", "<\\/script");
  replace_all(safe, "</style", "<\\/style");
  replace_all(safe, "<!--", "<\\!--");
  return safe;
}

std::string html_text(std::string_view text) {
  std::string safe(text);
  replace_all(safe, "&", "&amp;");
  replace_all(safe, "<", "&lt;");
  replace_all(safe, ">", "&gt;");
  replace_all(safe, "\"", "&quot;");
  return safe;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<std::uint8_t>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63u];
  }
  return text;
}

std::string packed(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string stream(size, '\0');
  const int status = compress2(
      reinterpret_cast<Bytef*>(stream.data()),
      &size,
      bytes.data(),
      static_cast<uLong>(bytes.size()),
      Z_DEFAULT_COMPRESSION
  );
  GLINT_CHECK(
      status == Z_OK, kEnvironment, "compressing {} bytes failed ({})", bytes.size(), status
  );
  stream.resize(size);
  return base64(stream);
}

Json short_number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.6g}", value));
}

std::string shell_word(const std::string& text) {
  constexpr std::string_view kHarmless = "_-./=:,@%+";
  const bool harmless = !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || kHarmless.find(c) != kHarmless.npos;
  });
  if (harmless) return text;
  std::string quoted = text;
  replace_all(quoted, "'", "'\\''");
  return fmt::format("'{}'", quoted);
}

}  // namespace glint

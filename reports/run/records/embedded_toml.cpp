// SPDX-License-Identifier: MIT
#include <toml++/toml.h>

#include <filesystem>
#include <sstream>

#include "reports/run/records/embedded.h"

namespace glint {

std::vector<std::string> embedded_names(std::string_view folder) {
  std::vector<std::string> names;
  for (const auto& [path, content] : embedded_files()) {
    const std::filesystem::path file(path);
    if (file.parent_path() == folder) names.push_back(file.stem().string());
  }
  return names;
}

namespace {

// The parser limits the nesting of values, but not of keys: a.a.a.a...
bool has_long_key(std::string_view text) {
  constexpr int kMostDots = 100;
  int dots = 0;
  for (const char c : text) {
    if (std::string_view("=,[]{}#\n").find(c) != std::string_view::npos) dots = 0;
    if (c == '.' && ++dots > kMostDots) return true;
  }
  return false;
}

}  // namespace

Json json_from_toml(std::string_view text, std::string_view where) {
  // A key is looked for among those before it, which takes the square of their number.
  constexpr std::size_t kMostBytes = 1 << 19;
  GLINT_CHECK(
      text.size() <= kMostBytes,
      kUsage,
      "{}: {} bytes, expected at most {}; it is no file of settings",
      where,
      text.size(),
      kMostBytes
  );
  GLINT_CHECK(!has_long_key(text), kUsage, "{}: a key of more than 100 parts", where);
  try {
    std::ostringstream json;
    json << toml::json_formatter(toml::parse(text));
    return Json::parse(json.str());
  } catch (const toml::parse_error& error) {
    throw Error(
        ExitCode::kUsage,
        fmt::format("{}:{}: {}", where, error.source().begin.line, error.description())
    );
  }
}

}  // namespace glint

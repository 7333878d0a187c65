// SPDX-License-Identifier: MIT
#include "glint/core/config.h"

#include "glint/core/files.h"

namespace glint {

bool is_nested_too_deeply(std::string_view json_text) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json_text.size(); ++i) {
    const char c = json_text[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '[' || c == '{')) {
      if (++depth > kDeepestJson) return true;
    } else if (!in_text && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return false;
}

void check_json_depth(std::string_view json_text, const std::filesystem::path& file) {
  GLINT_CHECK(
      !is_nested_too_deeply(json_text),
      kBadReference,
      "{}: lists and objects nested more than {} deep; it is damaged, write it again",
      file.string(),
      kDeepestJson
  );
}

Json parse_json(std::string_view text) {
  if (is_nested_too_deeply(text)) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

Json read_json_object(const std::filesystem::path& path, ExitCode code) {
  return with_exit_code(code, [&] {
    Json json = parse_json(read_file(path));
    GLINT_CHECK(
        json.is_object(),
        kBadReference,
        "{}: {}; expected a JSON object",
        path.string(),
        json.is_discarded() ? fmt::format("no JSON, or nested more than {} deep", kDeepestJson)
                            : fmt::format("holds {}", json.type_name())
    );
    return json;
  });
}

double number_or(const Json& object, std::string_view key, double otherwise) {
  const auto found = object.find(key);  // end() of what is no object
  return found != object.end() && found->is_number() ? found->get<double>() : otherwise;
}

std::string ConfigField::type() const {
  if (value.is_string()) return "text";
  if (value.is_boolean()) return "true or false";
  if (value.is_number_integer()) return "integer";
  if (value.is_number()) return "number";
  return value.is_array() ? "list" : "table";
}

}  // namespace glint

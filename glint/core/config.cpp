// SPDX-License-Identifier: MIT
#include "glint/core/config.h"

#include "glint/core/files.h"
#include "glint/core/machine.h"

namespace glint {

namespace {

// What parsing a text would make, told from its brackets, colons and commas alone.
struct JsonSize {
  int depth = 0;                // of lists and objects inside each other
  std::size_t most_fields = 0;  // of an object
  std::size_t values = 0;
};

JsonSize size_of_json(std::string_view text) {
  JsonSize size;
  std::vector<std::size_t> fields;  // of what is open
  bool in_text = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (in_text) {
      continue;
    } else if (c == '[' || c == '{') {
      ++size.values;
      fields.push_back(0);
      size.depth = std::max(size.depth, static_cast<int>(fields.size()));
      if (size.depth > kDeepestJson) return size;
    } else if (c == ',') {
      ++size.values;
    } else if (c == ':' && !fields.empty()) {
      size.most_fields = std::max(size.most_fields, ++fields.back());
    } else if ((c == ']' || c == '}') && !fields.empty()) {
      fields.pop_back();
    }
  }
  return size;
}

// What stands against parsing it; empty: nothing.
std::string json_problem(std::string_view text) {
  // A field is looked for among those before it, which takes the square of their number.
  constexpr std::size_t kMostFields = 65536;
  constexpr double kBytesPerValue = 110;   // ample: a value, its name, its place in a list
  constexpr std::size_t kSmall = 1 << 20;  // bytes of text that need not be asked about
  const JsonSize size = size_of_json(text);
  if (size.depth > kDeepestJson)
    return fmt::format("lists and objects nested more than {} deep", kDeepestJson);
  if (size.most_fields > kMostFields)
    return fmt::format(
        "an object of {} fields, expected at most {}", size.most_fields, kMostFields
    );
  if (text.size() < kSmall) return {};
  const double needed = kBytesPerValue * static_cast<double>(size.values);
  const auto available = static_cast<double>(available_memory_bytes());
  if (needed < available) return {};
  return fmt::format(
      "{} values, which take {:.0f} MB of memory, {:.0f} MB are free",
      size.values,
      needed / 1e6,
      available / 1e6
  );
}

}  // namespace

bool is_nested_too_deeply(std::string_view json_text) {
  return size_of_json(json_text).depth > kDeepestJson;
}

void check_json_text(std::string_view json_text, const std::filesystem::path& file) {
  const std::string problem = json_problem(json_text);
  GLINT_CHECK(
      problem.empty(),
      kBadReference,
      "{}: {}; it is damaged, or not what it is taken for",
      file.string(),
      problem
  );
}

Json parse_json(std::string_view text) {
  if (!json_problem(text).empty()) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

Json read_json_object(const std::filesystem::path& path, ExitCode code) {
  return with_exit_code(code, [&] {
    const std::string text = read_text(path);
    check_json_text(text, path);
    Json json = Json::parse(text, nullptr, false);
    GLINT_CHECK(
        json.is_object(),
        kBadReference,
        "{}: {}; expected a JSON object",
        path.string(),
        json.is_discarded() ? "no JSON" : fmt::format("holds {}", json.type_name())
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

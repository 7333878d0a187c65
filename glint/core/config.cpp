// SPDX-License-Identifier: MIT
#include "glint/core/config.h"

#include "glint/core/files.h"

namespace glint {

Json read_json_object(const std::filesystem::path& path, ExitCode code) {
  return with_exit_code(code, [&] {
    Json json = Json::parse(read_file(path), nullptr, false);
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

std::string ConfigField::type() const {
  if (value.is_string()) return "text";
  if (value.is_boolean()) return "true or false";
  if (value.is_number_integer()) return "integer";
  if (value.is_number()) return "number";
  return value.is_array() ? "list" : "table";
}

}  // namespace glint

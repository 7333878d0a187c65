// SPDX-License-Identifier: MIT
// Configuration structs. A component lists its fields once:
//
//   struct Config {
//     float rate = 0.05f;
//     template <class V> void visit(V&& v) { v("rate", rate, "learning rate of opacity"); }
//   };
//
// and gets JSON, overrides and documentation from it.
#pragma once

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/nearest.h"

namespace glint {

using Json = nlohmann::ordered_json;

// Lists and objects inside each other: deeper ones, which nobody writes, would fill the stack when
// they are copied or printed.
inline constexpr int kDeepestJson = 100;
bool is_nested_too_deeply(std::string_view json_text);
// Before it is parsed, which takes many times its size. Errors (kBadReference): the file's text is
// nested too deeply, has an object of more fields than anything here has, or needs more memory than
// there is.
void check_json_text(std::string_view json_text, const std::filesystem::path& file);
// Discarded (is_discarded()) where it is no JSON, or check_json_text() would not take it.
Json parse_json(std::string_view text);

// The file, which must hold a JSON object. Errors (`code`): read_file()'s, anything else in it.
Json read_json_object(const std::filesystem::path& path, ExitCode code = ExitCode::kBadReference);

// The number that an object has there; `otherwise` where it has none, or is no object.
double number_or(const Json& object, std::string_view key, double otherwise);

// The fields as a JSON object, in the order of visit().
template <class Config>
Json config_to_json(const Config& config) {
  Json json = Json::object();
  Config copy = config;
  copy.visit([&](const char* name, auto& field, const char*) { json[name] = field; });
  return json;
}

// A field as people read it.
struct ConfigField {
  std::string name;
  Json value;           // the default, or what a config has there
  std::string meaning;  // one line

  // "text", "true or false", "integer", "number", "list", "table"
  std::string type() const;
};

// The fields in the order of visit().
template <class Config>
std::vector<ConfigField> config_fields(const Config& config) {
  std::vector<ConfigField> fields;
  Config copy = config;
  copy.visit([&](const char* name, auto& field, const char* meaning) {
    fields.push_back({name, field, meaning});
  });
  return fields;
}

namespace detail {
// Whether a field that is an integer, or a list of them, gets such ones, which fit. get() converts
// whatever number it is, and what a double holds beyond the integer's range is undefined.
template <class T>
bool holds_integers(const Json& value, const T&) {
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    if (value.is_number_unsigned()) return std::in_range<T>(value.get<std::uint64_t>());
    if (value.is_number_integer()) return std::in_range<T>(value.get<std::int64_t>());
    if (!value.is_number()) return false;
    constexpr double kExact = 9007199254740992;  // doubles count so far
    const double number = value.get<double>();
    return std::abs(number) <= kExact && std::floor(number) == number &&
           std::in_range<T>(static_cast<std::int64_t>(number));
  }
  return true;
}
template <class T>
bool holds_integers(const Json& value, const std::vector<T>&) {
  return std::all_of(value.begin(), value.end(), [](const Json& item) {
    return holds_integers(item, T{});
  });
}

// False, and the field as it was, where the value is of another type, no number the field can hold
// (get() would cut off an integer's fraction and wrap what is too large), or no word of an
// enumeration (get() would take its first).
template <class Field>
bool set_field(Field& field, const Json& value) {
  try {
    if (!holds_integers(value, field)) return false;
    const Field read = value.get<Field>();
    if constexpr (std::is_enum_v<Field>)
      if (Json(read) != value) return false;
    field = read;
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}
}  // namespace detail

// A field as get_to() reads it; numbers that are no such integer have another type, too. Throws
// nlohmann::json::exception.
template <class Field>
void read_field(const Json& value, Field& field) {
  if (!detail::set_field(field, value))
    throw nlohmann::json::type_error::create(302, "not " + value.dump(), &value);
}

// Sets every field named in `json`. Errors (kUsage): unknown name (the nearest is named, the known
// ones are listed), wrong type, a word that an enumeration does not have (the field's meaning names
// those it has). `where` opens the message.
template <class Config>
void config_from_json(Config& config, const Json& json, std::string_view where) {
  for (const auto& entry : json.items()) {
    const std::string& key = entry.key();
    const Json& value = entry.value();
    bool found = false;
    std::vector<std::string> known;
    config.visit([&](const char* name, auto& field, const char* meaning) {
      known.emplace_back(name);
      if (key != name) return;
      found = true;
      if (detail::set_field(field, value)) return;
      const bool is_word = std::is_enum_v<std::remove_reference_t<decltype(field)>>;
      throw Error(
          ExitCode::kUsage,
          fmt::format(
              "{}: {} cannot be {}; expected {}",
              where,
              key,
              value.dump(),
              is_word ? meaning : ConfigField{key, field, ""}.type()
          )
      );
    });
    GLINT_CHECK(
        found,
        kUsage,
        "{}: no field '{}'; {}known fields: {}",
        where,
        key,
        did_you_mean(key, known),
        comma_list(known)
    );
  }
}

}  // namespace glint

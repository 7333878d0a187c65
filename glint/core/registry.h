// SPDX-License-Identifier: MIT
// Everything of one kind, found without a list: methods, loaders, families of metrics, verbs,
// timings. A file says
//
//   GLINT_REGISTER(MethodSpec, {"2dgs", ...})
//
// and is part of a library with REGISTERS (cmake/glint_targets.cmake), of which programs link every
// file. The kind is a struct with an `id` (or registry_id()); with a `source` it learns which file
// that was.
#pragma once

#include <map>
#include <string>
#include <utility>

#include "glint/core/error.h"

namespace glint {

// "../../baselines/2dgs.cpp", as a compiler cache calls it, from the root of the sources.
inline std::string from_root(std::string file) {
  while (file.starts_with("../")) file.erase(0, 3);
  return file;
}

// What an item goes by; a kind that calls it otherwise overloads this.
template <class T>
const std::string& registry_id(const T& item) {
  return item.id;
}

template <class T>
class Registry {
 public:
  // By id. Errors (kEnvironment): an id was registered twice; the message names both files.
  static const std::map<std::string, T>& all() {
    const Registry& registry = instance();
    GLINT_CHECK(registry.twice_.empty(), kEnvironment, "{}", registry.twice_);
    return registry.items_;
  }

  // `compiled_file`: __FILE__. All programs start with every item, so a second one of an
  // id is an error of all(), where there is someone to read it.
  static bool add(T item, const std::string& compiled_file) {
    const std::string file = from_root(compiled_file);
    Registry& registry = instance();
    if constexpr (requires { item.source; }) item.source = file;
    const std::string id = registry_id(item);
    const auto [first, is_new] = registry.files_.emplace(id, file);
    if (is_new)
      registry.items_.emplace(id, std::move(item));
    else
      registry.twice_ +=
          fmt::format("'{}' is registered twice: in {} and {}\n", id, first->second, file);
    return is_new;
  }

 private:
  static Registry& instance() {
    static Registry registry;
    return registry;
  }

  std::map<std::string, T> items_;
  std::map<std::string, std::string> files_;  // by id
  std::string twice_;
};

}  // namespace glint

// The compiler is told to write paths from the root of the sources (-fmacro-prefix-map).
#define GLINT_REGISTER_CONCAT2(a, b) a##b
#define GLINT_REGISTER_CONCAT(a, b) GLINT_REGISTER_CONCAT2(a, b)
#define GLINT_REGISTER(Kind, ...)                                               \
  namespace {                                                                   \
  [[maybe_unused]] const bool GLINT_REGISTER_CONCAT(registered_, __COUNTER__) = \
      ::glint::Registry<Kind>::add(__VA_ARGS__, __FILE__);                      \
  }

// SPDX-License-Identifier: MIT
#include "datasets/glassroom/replace_scene.h"

#include <set>
#include <string>

#include "glint/core/config.h"
#include "glint/core/left_behind.h"
#include "glint/core/replace_folder.h"

namespace glint {
namespace {

constexpr const char* kDescription = "scene.json";

// Of a scene whose description is damaged: all that lies where scenes have their files.
bool is_in_layout(const std::string& name) {
  for (const char* folder : {"images/", "diffrens/", "gt/", "sparse/"})
    if (name.starts_with(folder)) return true;
  return false;
}

// The files of the older scene. Its description lists them; names that lead out of it are not its.
std::set<std::string> own_files(const fs::path& folder) {
  const std::set<std::string> there = leaves_below(folder);
  std::set<std::string> own;
  const Json description =
      there.contains(kDescription) ? parse_json(read_file(folder / kDescription)) : Json();
  const Json listed = description.is_object() ? description.value("files", Json()) : Json();
  for (const std::string& name : there)
    if (listed.is_object() ? listed.contains(name) : is_in_layout(name)) own.insert(name);
  own.insert({kDescription, "keys/data.json"});  // the key says that the older scene is whole
  return own;
}

// What the new scene writes, too, is of scenes.
std::set<std::string> own_names(const fs::path& old, const fs::path& fresh) {
  std::set<std::string> names = own_files(old);
  names.merge(leaves_below(fresh));
  return names;
}

}  // namespace

void replace_scene(const fs::path& made, const fs::path& folder) {
  replace_folder(made, absolute_folder(folder), own_names);
}

void recover_scene(const fs::path& folder) { recover_folder(absolute_folder(folder), own_names); }

}  // namespace glint

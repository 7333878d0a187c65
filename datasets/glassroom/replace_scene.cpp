// SPDX-License-Identifier: MIT
#include "datasets/glassroom/replace_scene.h"

#include <set>
#include <string>

#include "datasets/glassroom/write_scene.h"
#include "glint/core/config.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"

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
  const std::set<std::string> there = files_below(folder);
  std::set<std::string> own;
  const Json description =
      there.contains(kDescription) ? parse_json(read_file(folder / kDescription)) : Json();
  const Json listed = description.is_object() ? description.value("files", Json()) : Json();
  for (const std::string& name : there)
    if (listed.is_object() ? listed.contains(name) : is_in_layout(name)) own.insert(name);
  own.insert("keys/data.json");  // says that the older scene is whole
  return own;
}

void check(const std::error_code& code, const fs::path& path) {
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", path.string(), code.message());
}

// With the folders that are empty then, up to `folder`.
void remove_file(const fs::path& folder, const std::string& name) {
  std::error_code code;
  fs::remove(folder / name, code);
  check(code, folder / name);
  fs::path parent = fs::path(name).parent_path();
  while (!parent.empty() && fs::remove(folder / parent, code) && !code)
    parent = parent.parent_path();
}

void move_file(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::create_directories(to.parent_path(), code);
  if (!code) fs::rename(from, to, code);
  check(code, to);
}

}  // namespace

void replace_scene(const fs::path& made, const fs::path& folder) {
  std::error_code code;
  if (!is_there(folder) || fs::is_empty(folder, code)) {
    fs::remove(folder, code);
    fs::rename(made, folder, code);
    return check(code, folder);
  }
  std::set<std::string> fresh = files_below(made);
  for (const std::string& name : own_files(folder))
    if (!fresh.contains(name)) remove_file(folder, name);
  fresh.erase(kDescription);
  for (const std::string& name : fresh) move_file(made / name, folder / name);
  move_file(made / kDescription, folder / kDescription);
}

}  // namespace glint

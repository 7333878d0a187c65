// SPDX-License-Identifier: MIT
#include "glint/core/replace_folder.h"

#include <fcntl.h>
#include <stdio.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

void check(const std::error_code& code, const fs::path& path) {
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", path.string(), code.message());
}

bool holds_nothing(const fs::path& folder) {
  return !is_taken(folder) || (is_folder(folder) && list_entries(folder).empty());
}

// Two names change places in one step; false: this file system cannot.
bool exchange(const fs::path& a, const fs::path& b) {
  if (::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return true;
  const int why = errno;
  const bool cannot = why == EINVAL || why == ENOSYS || why == ENOTSUP;
  GLINT_CHECK(cannot, kEnvironment, "{}: cannot be replaced ({})", b.string(), std::strerror(why));
  return false;
}

void rename_to(const fs::path& from, const fs::path& to) {
  std::error_code code;
  fs::rename(from, to, code);
  check(code, to);
}

// `made` under `folder`, what stood there under `aside`.
void swap_in(const fs::path& made, const fs::path& folder, const fs::path& aside) {
  rename_to(made, aside);  // not under a name that counts as unfinished: it will hold the old one
  if (exchange(aside, folder)) return;
  rename_to(aside, made);
  rename_to(folder, aside);
  rename_to(made, folder);
}

// Not those empty folders that the new one has, too: files of ours stood in them.
std::vector<std::string> foreign_names(
    const fs::path& old, const fs::path& fresh, const OwnNames& own
) {
  const std::set<std::string> ours = own(old, fresh);
  std::vector<std::string> names;
  for (const std::string& name : leaves_below(old))
    if (!ours.contains(name) && !(is_real_folder(old / name) && is_real_folder(fresh / name)))
      names.push_back(name);
  return names;
}

// What has a name that is taken stays where it is.
void move_over(const fs::path& from, const fs::path& to, const std::vector<std::string>& names) {
  std::error_code code;
  for (const std::string& name : names) {
    if (is_taken(to / name)) continue;
    fs::create_directories((to / name).parent_path(), code);
    check(code, to / name);
    rename_to(from / name, to / name);
  }
}

// A kill while the old one is removed may take its list of what is ours first, so it is removed
// under a name that nobody reads again and remove_left_behind() clears.
void remove_old(const fs::path& aside) {
  const fs::path old = unfinished_path(aside);
  rename_to(aside, old);
  std::error_code code;
  fs::remove_all(old, code);
}

// What is not ours moves over and the rest goes; where something cannot move, nothing goes.
void finish(const fs::path& aside, const fs::path& folder, const OwnNames& own) {
  const std::vector<std::string> foreign = foreign_names(aside, folder, own);
  move_over(aside, folder, foreign);
  const auto is_left = [&](const std::string& name) { return is_taken(aside / name); };
  if (std::none_of(foreign.begin(), foreign.end(), is_left)) remove_old(aside);
}

// A file of ours that was there may be written anew; one of others may not.
void check_names(
    const fs::path& made, const fs::path& folder, const std::vector<std::string>& foreign
) {
  for (const std::string& name : foreign)
    GLINT_CHECK(
        !is_taken(made / name),
        kUsage,
        "{}: was put there by somebody else, and a new file needs its name; move it away",
        (folder / name).string()
    );
}

void add_leaves(const fs::path& path, const fs::path& folder, std::set<std::string>& names) {
  const bool enters = path == folder || is_real_folder(path);
  const auto entries = enters ? list_entries(path) : std::vector<fs::path>();
  for (const fs::path& entry : entries) add_leaves(entry, folder, names);
  if (entries.empty() && path != folder)
    names.insert(path.lexically_relative(folder).generic_string());
}

}  // namespace

std::set<std::string> leaves_below(const fs::path& folder) {
  std::set<std::string> names;
  add_leaves(folder, folder, names);
  return names;
}

std::vector<std::string> replace_folder(
    const fs::path& made, const fs::path& folder, const OwnNames& own
) {
  recover_folder(folder, own);
  if (holds_nothing(folder)) {
    rename_to(made, folder);
    return {};
  }
  const std::vector<std::string> foreign = foreign_names(folder, made, own);
  check_names(made, folder, foreign);
  const fs::path aside = aside_path(folder);
  swap_in(made, folder, aside);
  finish(aside, folder, own);
  return foreign;
}

void recover_folder(const fs::path& folder, const OwnNames& own) {
  for (const fs::path& aside : list_aside(folder)) {
    if (holds_nothing(folder))
      rename_to(aside, folder);
    else
      finish(aside, folder, own);
  }
}

}  // namespace glint

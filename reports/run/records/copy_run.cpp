// SPDX-License-Identifier: MIT
#include "reports/run/records/copy_run.h"

#include <algorithm>
#include <vector>

#include "glint/core/left_behind.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

// `inside`: the folders around it, as they are called without links.
void add_files(const fs::path& folder, std::vector<fs::path> inside, std::vector<fs::path>& files) {
  const fs::path plain = fs::canonical(folder);
  GLINT_CHECK(
      std::find(inside.begin(), inside.end(), plain) == inside.end(),
      kBadPrediction,
      "{}: is a link that leads back to a folder around it; remove it",
      folder.string()
  );
  inside.push_back(plain);
  for (const fs::path& path : list_entries(folder))
    if (is_file(path))
      files.push_back(path);
    else
      add_files(path, inside, files);
}

void check_copied(const std::error_code& code, const fs::path& from, const fs::path& to) {
  GLINT_CHECK(
      !code,
      kEnvironment,
      "{}: cannot be copied to {} ({})",
      from.string(),
      to.string(),
      code.message()
  );
}

}  // namespace

void copy_run(const fs::path& from, const fs::path& to, bool write) {
  std::vector<fs::path> files;
  const bool is_kept = with_exit_code(ExitCode::kBadPrediction, [&] {
    const bool there = is_there(from);
    if (there) add_files(from, {}, files);
    return there;
  });
  if (!is_kept || !write) return;
  const UnfinishedFolder fresh(to);
  std::error_code code;
  for (const fs::path& file : files) {
    const fs::path target = fresh.path() / file.lexically_relative(from);
    fs::create_directories(target.parent_path(), code);
    check_copied(code, file, target);
    fs::copy_file(file, target, code);
    check_copied(code, file, target);
  }
  fs::remove_all(to, code);  // of a cell that failed there
  fs::rename(fresh.path(), to, code);
  check_copied(code, from, to);
}

}  // namespace glint

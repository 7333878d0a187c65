// SPDX-License-Identifier: MIT
#include "reports/run/records/copy_run.h"

#include <vector>

#include "glint/core/left_behind.h"
#include "glint/core/presence.h"

namespace glint {
namespace {

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
    if (there) files = list_files_below(from, {}, FolderLinks::kFollowed);
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

// SPDX-License-Identifier: MIT
#include "reports/run/records/linked_files.h"

#include <algorithm>

#include "glint/core/presence.h"

namespace glint {
namespace {

// `inside`: the folders around it, as they are called without links.
void add_files(
    const fs::path& folder,
    const std::function<bool(const fs::path&)>& leaves_out,
    std::vector<fs::path> inside,
    std::vector<fs::path>& files
) {
  const fs::path plain = fs::canonical(folder);
  GLINT_CHECK(
      std::find(inside.begin(), inside.end(), plain) == inside.end(),
      kBadReference,
      "{}: is a link that leads back to a folder around it; remove it",
      folder.string()
  );
  inside.push_back(plain);
  for (const fs::path& path : list_entries(folder)) {
    if (leaves_out(path)) continue;
    if (is_file(path))
      files.push_back(path);
    else
      add_files(path, leaves_out, inside, files);
  }
}

}  // namespace

std::vector<fs::path> list_linked_files(
    const fs::path& folder, const std::function<bool(const fs::path& path)>& leaves_out
) {
  std::vector<fs::path> files;
  if (is_there(folder)) add_files(folder, leaves_out, {}, files);
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace glint

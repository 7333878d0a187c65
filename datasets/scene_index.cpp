// SPDX-License-Identifier: MIT
// What loaders list views with; for the lean build, too: it has the import of photos.
#include "datasets/scene_index.h"

#include <algorithm>
#include <map>

#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/rng.h"
#include "glint/core/similar_names.h"
#include "glint/core/utf8.h"

namespace glint {

bool file_contains(const fs::path& file, std::string_view part) {
  if (!is_file(file)) return false;
  try {
    return read_file(file).find(part) != std::string::npos;
  } catch (const Error&) {
    return false;
  }
}

std::string with_slashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

fs::path picture_or_copy(const fs::path& path) {
  if (is_file(path)) return path;
  for (const char* smaller : {"_2", "_4", "_8"}) {
    const fs::path copy = fs::path(path.parent_path().string() + smaller) / path.filename();
    if (is_file(copy)) return copy;
  }
  return path;
}

fs::path picture_called_alike(const fs::path& path) {
  if (is_file(path) || !is_folder(path.parent_path())) return path;
  const std::string key = name_key(path.filename().string());
  fs::path found;
  for (const fs::path& file : list_entries(path.parent_path())) {
    if (name_key(file.filename().string()) != key || !is_file(file)) continue;
    if (!found.empty()) return path;
    found = file;
  }
  return found.empty() ? path : found;
}

std::string folder_name(const fs::path& folder) {
  return fs::absolute(folder / ".").lexically_normal().parent_path().filename().string();
}

std::string split_every(std::vector<ViewSource>& views, int test_every) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].is_test = test_every > 0 && i % static_cast<std::size_t>(test_every) == 0;
    views[i].is_train = !views[i].is_test;
  }
  if (test_every <= 0) return "no test views";
  return fmt::format("view 0, {0}, {1}, ... in the order of names", test_every, 2 * test_every);
}

std::string hold_out(std::set<std::string> names, std::vector<ViewSource>& views) {
  for (ViewSource& view : views) {
    view.is_test = names.erase(view.name) > 0;
    view.is_train = !view.is_test;
  }
  return names.empty() ? "" : *names.begin();
}

void sort_naturally(std::vector<ViewSource>& views) {
  std::sort(views.begin(), views.end(), [](const ViewSource& a, const ViewSource& b) {
    return natural_less(a.name, b.name);
  });
}

void sort_by_bytes(std::vector<ViewSource>& views) {
  std::sort(views.begin(), views.end(), [](const ViewSource& a, const ViewSource& b) {
    return a.name < b.name;
  });
}

void shorten_names(std::vector<ViewSource>& views) {
  std::map<std::string, int> count;
  for (const ViewSource& view : views) ++count[fs::path(view.name).stem().string()];
  for (ViewSource& view : views) {
    const fs::path path(view.name);
    const std::string stem = path.stem().string();
    view.name = flat_view_name(count[stem] > 1 ? (path.parent_path() / stem).string() : stem);
  }
}

std::string hash_of_files(const std::string& camera_text, const std::vector<ViewSource>& views) {
  std::string text = camera_text;
  for (const ViewSource& view : views) {
    std::error_code code;
    text += fmt::format(" {}:{}", view.name, fs::file_size(view.image, code));
    if (!view.counted.empty()) text += fmt::format("/{}", fs::file_size(view.counted, code));
  }
  return fmt::format("{:016x}", hash_name(text));
}

std::string scene_name_problem(const SceneIndex& index) {
  const std::string path = index.folder.empty() ? "" : fs::absolute(index.folder).string();
  if (is_utf8(index.name) && is_utf8(path)) return {};
  return fmt::format(
      "its path '{}' is not UTF-8, which records need; rename the folder", as_utf8(path)
  );
}

std::string no_train_views(const SceneIndex& index) {
  if (index.views.empty()) return "no train views; expected at least one image";
  return fmt::format(
      "no train views: by the split ({}) {} a test view; name the test views in {} as "
      "\"test_views\": [...], which replaces the split (none: []), or add pictures",
      index.split_rule,
      index.views.size() == 1 ? "the only view is"
                              : fmt::format("each of {} views is", index.views.size()),
      (index.folder / "scene.json").string()
  );
}

}  // namespace glint

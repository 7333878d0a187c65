// SPDX-License-Identifier: MIT
// Names of views, for the lean build, too: it has the import of photos.
#include <map>

#include "datasets/scene_index.h"

namespace glint {

void shorten_names(std::vector<ViewSource>& views) {
  std::map<std::string, int> count;
  for (const ViewSource& view : views) ++count[fs::path(view.name).stem().string()];
  for (ViewSource& view : views) {
    const fs::path path(view.name);
    const std::string stem = path.stem().string();
    view.name = flat_view_name(count[stem] > 1 ? (path.parent_path() / stem).string() : stem);
  }
}

}  // namespace glint

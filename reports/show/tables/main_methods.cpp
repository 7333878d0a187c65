// SPDX-License-Identifier: MIT
#include "reports/show/tables/main_methods.h"

#include <algorithm>

namespace glint {

const std::vector<std::string>& main_methods() {
  static const std::vector<std::string> ids{"2dgs", "envgs", "tsgs", "glint", "glint/plus"};
  return ids;
}

bool is_main_method(const std::string& id) {
  const auto& ids = main_methods();
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// How the settings of a family of methods are listed for people.
#pragma once

#include <string>
#include <vector>

#include "glint/method.h"

namespace glint {

// Registered by families with many settings.
struct SettingGuide {
  // The settings from this one on, in their order, until the next group.
  struct Group {
    std::string from, title;
  };
  // Whose default values they have.
  struct Source {
    std::string name, settings;  // with blanks between
  };

  std::string id;                  // of the family's first method
  std::vector<std::string> first;  // what people change first
  std::vector<Group> groups;
  std::vector<Source> sources;  // what is in none of them is ours
};

struct ListedSetting {
  ConfigField field;
  std::string range;              // of a number; empty: any
  std::string group, value_from;  // empty without a guide
  bool is_first = false;          // of those that people change first
};

// With the defaults of the family's first method. What people change first comes first, the rest in
// groups.
std::vector<ListedSetting> listed_settings(const std::string& family);

}  // namespace glint

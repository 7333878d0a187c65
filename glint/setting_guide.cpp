// SPDX-License-Identifier: MIT
#include "glint/setting_guide.h"

#include <algorithm>

#include "glint/setting_ranges.h"

namespace glint {

namespace {

std::string range_of(const std::string& setting) {
  for (const SettingRange& ranged : setting_ranges())
    if (setting == ranged.name) return ranged.range.text();
  return "";
}

std::string source_of(const SettingGuide& guide, const std::string& setting) {
  for (const SettingGuide::Source& source : guide.sources)
    if ((" " + source.settings + " ").find(" " + setting + " ") != std::string::npos)
      return source.name;
  return "ours";
}

void apply(const SettingGuide& guide, std::vector<ListedSetting>& settings) {
  std::string group;
  const auto place = [&](const ListedSetting& setting) {
    return std::find(guide.first.begin(), guide.first.end(), setting.field.name);
  };
  for (ListedSetting& setting : settings) {
    for (const SettingGuide::Group& next : guide.groups)
      if (next.from == setting.field.name) group = next.title;
    setting.group = group;
    setting.value_from = source_of(guide, setting.field.name);
    setting.is_first = place(setting) != guide.first.end();
  }
  const auto sooner = [&](const auto& a, const auto& b) { return place(a) < place(b); };
  std::stable_sort(settings.begin(), settings.end(), sooner);
}

}  // namespace

std::vector<ListedSetting> listed_settings(const std::string& family) {
  std::vector<ListedSetting> settings;
  for (const ConfigField& field : create_method(family)->fields())
    settings.push_back({field, range_of(field.name), "", ""});
  const auto& guides = Registry<SettingGuide>::all();
  if (const auto guide = guides.find(family); guide != guides.end()) apply(guide->second, settings);
  return settings;
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// What `glint-bench methods ID` says of settings beside their meaning.
#include "glint/setting_guide.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace glint;

TEST_CASE("Guides name settings that there are, each with one source, and every one has a group") {
  for (const auto& [id, guide] : Registry<SettingGuide>::all()) {
    const Json config = create_method(id)->config();
    std::vector<std::string> named = guide.first, sources;
    for (const SettingGuide::Group& group : guide.groups) named.push_back(group.from);
    for (const SettingGuide::Source& source : guide.sources) {
      std::istringstream words(source.settings);
      for (std::string word; words >> word;) sources.push_back(word);
    }
    named.insert(named.end(), sources.begin(), sources.end());
    for (const std::string& name : named) {
      INFO(id << " " << name);
      CHECK(config.contains(name));
    }
    std::sort(sources.begin(), sources.end());
    CHECK(std::adjacent_find(sources.begin(), sources.end()) == sources.end());
    for (const ListedSetting& setting : listed_settings(id)) CHECK_FALSE(setting.group.empty());
  }
}

TEST_CASE("GLINT has at most 70 settings, and shows first the ten that people change first") {
  const std::vector<ListedSetting> settings = listed_settings("glint");
  CHECK(settings.size() <= 70);
  const SettingGuide& guide = Registry<SettingGuide>::all().at("glint");
  REQUIRE(guide.first.size() == 10);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    CHECK(settings[i].is_first == (i < 10));
    if (i < 10) CHECK(settings[i].field.name == guide.first[i]);
  }
}

TEST_CASE("Without a guide settings stand in their order, with their ranges") {
  const std::vector<ListedSetting> settings = listed_settings("2dgs");
  CHECK(settings.front().field.name == "lambda_ssim");
  CHECK(settings.front().range == "at least 0 and at most 1");
  CHECK(settings.front().group.empty());
}

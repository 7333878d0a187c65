// SPDX-License-Identifier: MIT
// Whatever a setting is set to within its range, a training ends well or says what is wrong with
// it: no crash, no error without a word of ours.
#include <catch2/catch.hpp>

#include "glint/method.h"
#include "glint/setting_ranges.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

const ValueRange* range_of(const std::string& name) {
  for (const SettingRange& setting : setting_ranges())
    if (setting.name == name) return &setting.range;
  return nullptr;
}

// Memory is estimated from the settings before a training begins (cell_needs.h), which is not the
// methods' business: their largest values are not tried here.
bool takes_memory(const std::string& name) {
  for (const char* one : {"random_points", "map_height", "map_channels", "hidden"})
    if (name == one) return true;
  return false;
}

std::vector<Json> values_of(const ConfigField& field) {
  const ValueRange* range = range_of(field.name);
  if (field.type() == "integer") {
    std::vector<Json> ends{static_cast<int>(range->least)};
    if (!takes_memory(field.name)) ends.emplace_back(static_cast<int>(range->most));
    return ends;
  }
  if (field.type() == "number") return {0, -1, 1e-30, 1e30};
  if (field.type() == "true or false") return {!field.value.get<bool>()};
  return {};
}

// Empty: it trained, or said so in an Error.
std::string outcome(const std::string& id, const std::string& name, const Json& value) {
  try {
    const auto method = create_method(id, {{name, value}});
    RunOptions options;
    options.iterations = 3;
    method->initialize(small_room(), options);
    for (int i = 0; i < options.iterations; ++i) method->step(i);
    method->check_finite();
  } catch (const Error&) {
  } catch (const std::exception& error) {
    return fmt::format("{} --set {}={}: {}", id, name, value.dump(), error.what());
  }
  return "";
}

}  // namespace

TEST_CASE("every whole-numbered setting of every method has both ends") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all())
    for (const ConfigField& field : create_method(id)->fields()) {
      if (field.type() != "integer") continue;
      INFO(id << " " << field.name);
      const ValueRange* range = range_of(field.name);
      REQUIRE(range != nullptr);
      CHECK(range->least >= -1);
      CHECK(range->most <= 1e9);
    }
}

TEST_CASE("every setting of every family trains, or says why not, at the ends of what it may be") {
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    if (id.find('/') != std::string::npos || !spec.rival) continue;
    for (const ConfigField& field : create_method(id)->fields())
      for (const Json& value : values_of(field)) CHECK(outcome(id, field.name, value) == "");
  }
}

// SPDX-License-Identifier: MIT
// The docs name what there is: fields of profiles, verbs that print JSON.
#include <catch2/catch.hpp>

#include <set>
#include <sstream>

#include "reports/run/records/failure_kinds.h"
#include "reports/run/records/profile.h"
#include "reports/verbs/verb.h"

using namespace glint;

namespace {

std::string doc(const char* name) {
  return read_file(fs::path("docs") / name);  // tests run there
}

// The names in `...` of a text.
void add_quoted(const std::string& text, std::set<std::string>& names) {
  std::istringstream parts(text);
  bool quoted = false;
  for (std::string part; std::getline(parts, part, '`'); quoted = !quoted)
    if (quoted) names.insert(part);
}

// Those of the first cells of table rows.
std::set<std::string> first_cells(const std::string& text) {
  std::set<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("| `")) add_quoted(line.substr(1, line.find('|', 1) - 1), names);
  return names;
}

// The names that items of a list begin with: "- `dataset info`: ...".
std::set<std::string> items(const std::string& text) {
  std::set<std::string> names;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("- `")) add_quoted(line.substr(0, line.find('`', 3) + 1), names);
  return names;
}

std::string section(const std::string& text, const std::string& heading) {
  const std::size_t begin = text.find(heading);
  REQUIRE(begin != std::string::npos);
  return text.substr(begin, text.find("\n## ", begin + 1) - begin);
}

template <class Config>
std::set<std::string> field_names(const Config& config) {
  std::set<std::string> names;
  for (const ConfigField& field : config_fields(config)) names.insert(field.name);
  return names;
}

// Those that help shows.
std::vector<const CLI::App*> shown_verbs(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

// "dataset make" of the program's verbs; those alone that show the option.
void add_verbs_with(
    const CLI::App& app,
    const std::string& option,
    const std::string& prefix,
    std::set<std::string>& names
) {
  for (const CLI::App* verb : shown_verbs(app)) {
    const std::string name = prefix + verb->get_name();
    const CLI::Option* found = verb->get_option_no_throw(option);
    if (found != nullptr && !found->get_group().empty()) names.insert(name);
    add_verbs_with(*verb, option, name + " ", names);
  }
}

}  // namespace

TEST_CASE("docs/reference/profiles.md has every field of a profile, and no other") {
  const std::string text = doc("reference/profiles.md");
  CHECK(first_cells(section(text, "# Profiles")) == field_names(Profile{}));
  CHECK(first_cells(section(text, "## Scenes")) == field_names(SceneSource{}));
  CHECK(first_cells(section(text, "## `[mesh]`")) == field_names(TsdfOptions{}));
  CHECK(first_cells(section(text, "## `[mesh_metrics]`")) == field_names(MeshProtocol{}));
}

TEST_CASE("docs/reference/verbs.md has every verb, and no other") {
  std::set<std::string> verbs;
  const CommandLine line;
  for (const CLI::App* verb : shown_verbs(line.app)) verbs.insert(verb->get_name());
  std::set<std::string> named;
  std::istringstream lines(section(doc("reference/verbs.md"), "## Verbs"));
  for (std::string row; std::getline(lines, row);)
    if (row.starts_with("| `")) named.insert(row.substr(3, row.find('`', 3) - 3));
  CHECK(named == verbs);
}

TEST_CASE("docs/reference/verbs.md has every verb that prints JSON, and no other") {
  const CommandLine line;
  std::set<std::string> verbs;
  add_verbs_with(line.app, "--json", "", verbs);
  CHECK(verbs.contains("status"));
  CHECK(verbs.contains("dataset info"));
  std::set<std::string> named = items(section(doc("reference/verbs.md"), "## JSON"));
  for (const char* way : {"perf --run", "perf --scaling"}) CHECK(named.erase(way) == 1);
  CHECK(named == verbs);
}

TEST_CASE("docs/guide/many_cells.md has every kind of failure with its tries, and no other") {
  const std::string failures = section(doc("guide/many_cells.md"), "## Failures");
  std::set<std::string> kinds;
  for (const FailureKind& kind : failure_kinds()) {
    kinds.insert(std::string(kind.id));
    std::istringstream lines(failures);
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with(fmt::format("| `{}`", kind.id)))
        CHECK_THAT(line, Catch::Contains(fmt::format("| {}", kind.retries)));
  }
  CHECK(first_cells(failures) == kinds);
}

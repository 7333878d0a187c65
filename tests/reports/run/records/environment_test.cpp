// SPDX-License-Identifier: MIT
// What records say of machine and build: enough to do it again, and nothing of where files lie.
#include <catch2/catch.hpp>

#include <cctype>

#include "reports/run/records/build_info.h"
#include "reports/run/records/environment.h"
#include "reports/run/records/records.h"

using namespace glint;

TEST_CASE("the environment names machine, build and libraries") {
  const Json environment = environment_json();
  for (const char* field :
       {"device", "machine", "os", "kernel", "cpu", "compiler", "build_type", "flags"})
    CHECK_FALSE(environment.at(field).get<std::string>().empty());
  CHECK(environment["flags"].get<std::string>().find("-ffp-contract=off") != std::string::npos);
  CHECK(environment["libraries"].size() > 10);
  for (const auto& [name, version] : environment["libraries"].items()) {
    INFO(name << " " << version);
    CHECK(std::isdigit(static_cast<unsigned char>(version.get<std::string>().at(0))) != 0);
  }
  CHECK(environment["cells_on_card"] == 0);  // on the CPU
  CHECK(environment["libraries"].contains("libpng"));
  CHECK(environment["libraries"].contains("OpenEXR"));
}

TEST_CASE("flags name no folder") {
  CHECK(build_info().flags.find('/') == std::string::npos);
  CHECK(build_info().flags.find("$<") == std::string::npos);
}

TEST_CASE("docs/reference/records.md has every field of the environment") {
  const std::string text = read_file("docs/reference/records.md");  // tests run there
  const std::size_t begin = text.find("## Environment");
  REQUIRE(begin != std::string::npos);
  const std::string section = text.substr(begin, text.find("\n## ", begin + 1) - begin);
  const Json environment = environment_json();
  for (const auto& entry : environment.items()) {
    INFO(entry.key());
    CHECK(section.find("`" + entry.key() + "`") != std::string::npos);
  }
}

TEST_CASE("records of earlier versions have fewer fields and are read") {
  const Record old = record_from_json(
      Json::parse(R"({"scene": "a", "method": "b", "environment": {"device": "cpu"}})"), "here"
  );
  CHECK(old.environment.size() == 1);
  Record now = old;
  now.environment = environment_json();
  CHECK(record_from_json(record_to_json(now), "here").environment == now.environment);
}

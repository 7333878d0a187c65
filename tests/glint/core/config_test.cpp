// SPDX-License-Identifier: MIT
#include "glint/core/config.h"

#include <catch2/catch.hpp>

#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

enum class Shade { kLight, kDark };
NLOHMANN_JSON_SERIALIZE_ENUM(Shade, {{Shade::kLight, "light"}, {Shade::kDark, "dark"}})

struct ExampleConfig {
  float rate = 0.05f;
  int steps = 100;
  bool verbose = false;
  std::string name = "plain";
  Shade shade = Shade::kDark;
  template <class V>
  void visit(V&& v) {
    v("rate", rate, "learning rate");
    v("steps", steps, "iterations");
    v("verbose", verbose, "more output");
    v("name", name, "title");
    v("shade", shade, "light or dark");
  }
};

// The message of the Error that f throws; its code must be kUsage.
template <class F>
std::string usage_error(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    return error.what();
  }
  FAIL("no error");
  return {};
}

}  // namespace

TEST_CASE("A configuration survives the way to JSON and back") {
  ExampleConfig config;
  config.rate = 0.25f;
  config.name = "changed";
  ExampleConfig copy;
  config_from_json(copy, config_to_json(config), "test");
  CHECK(config_to_json(copy) == config_to_json(config));
  CHECK(copy.rate == 0.25f);
  CHECK(config_to_json(config).begin().key() == "rate");  // the order of visit()
}

TEST_CASE("Fields that JSON does not name keep their values") {
  ExampleConfig config;
  config_from_json(config, Json{{"steps", 7}}, "test");
  CHECK(config.steps == 7);
  CHECK(config.rate == 0.05f);
}

TEST_CASE("JSON sets numbers, flags and text") {
  ExampleConfig config;
  config_from_json(config, {{"rate", 1e-3}, {"verbose", true}, {"name", "a=b c"}}, "test");
  CHECK(config.rate == 1e-3f);
  CHECK(config.verbose);
  CHECK(config.name == "a=b c");
}

TEST_CASE("An unknown field is an error that lists the known ones") {
  ExampleConfig config;
  const std::string message = usage_error([&] {
    config_from_json(config, {{"ratio", 1}}, "profile ci.toml");
  });
  for (const char* part : {"profile ci.toml", "'ratio'", "rate, steps, verbose, name"})
    CHECK_THAT(message, Catch::Contains(part));
}

TEST_CASE("A value of the wrong type is an error") {
  ExampleConfig config;
  CHECK_THAT(
      usage_error([&] {
        config_from_json(config, {{"rate", "fast"}}, "options");
      }),
      Catch::Contains("rate") && Catch::Contains("fast")
  );
  CHECK(config.rate == 0.05f);
}

TEST_CASE("A word that an enumeration does not have is an error that names those it has") {
  ExampleConfig config;
  for (const Json& word : {Json("drak"), Json(1), Json()})
    CHECK_THAT(
        usage_error([&] {
          config_from_json(config, Json{{"shade", word}}, "test");
        }),
        Catch::Contains("test: shade cannot be " + word.dump()) && Catch::Contains("light or dark")
    );
  CHECK(config.shade == Shade::kDark);
  config_from_json(config, Json{{"shade", "light"}}, "test");
  CHECK(config.shade == Shade::kLight);
}

TEST_CASE("A number that does not fit an integer field is an error") {
  ExampleConfig config;
  usage_error([&] { config_from_json(config, {{"steps", 0.5}}, "options"); });
  usage_error([&] { config_from_json(config, {{"steps", 9999999999}}, "options"); });
  CHECK(config.steps == 100);
}

TEST_CASE("A number beyond an integer's range is no integer, in lists neither") {
  std::uint64_t seed = 7;
  std::vector<std::int32_t> steps{1};
  CHECK_THROWS_AS(read_field(Json(1.8446749377040552e19), seed), nlohmann::json::exception);
  CHECK_THROWS_AS(read_field(Json(-1), seed), nlohmann::json::exception);
  CHECK_THROWS_AS(read_field(Json(true), seed), nlohmann::json::exception);
  CHECK(seed == 7);
  read_field(Json(18446744073709551615u), seed);
  CHECK(seed == 18446744073709551615u);
  CHECK_THROWS_AS(read_field(Json({1, 1e300}), steps), nlohmann::json::exception);
  read_field(Json({2.0, -3}), steps);
  CHECK(steps == std::vector<std::int32_t>{2, -3});
}

TEST_CASE("A file that must hold a JSON object says what it holds instead") {
  const test::TempFolder folder;
  const auto message = [&](const char* content) {
    write_file(folder / "a.json", content);
    return test::error_of(ExitCode::kBadPrediction, [&] {
      read_json_object(folder / "a.json", ExitCode::kBadPrediction);
    });
  };
  CHECK_THAT(message("[1]"), Catch::Contains("a.json: holds array; expected a JSON object"));
  CHECK_THAT(message("{\"a\": "), Catch::Contains("no JSON"));
  CHECK_THAT(message(""), Catch::Contains("no JSON"));
  write_file(folder / "a.json", R"({"a": 1})");
  CHECK(read_json_object(folder / "a.json") == Json{{"a", 1}});
  test::bad_reference([&] { read_json_object(folder / "absent.json"); });
}

TEST_CASE("JSON that is nested too deeply is none") {
  const auto nested = [](int depth) {
    return std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']');
  };
  CHECK(parse_json(nested(kDeepestJson)).is_array());
  CHECK(parse_json(nested(kDeepestJson + 1)).is_discarded());
  CHECK(parse_json(nested(10'000'000)).is_discarded());
  CHECK(parse_json("{\"a\": \"" + nested(1000) + "\\\"[\"}").is_object());  // in a text
  CHECK_THROWS_WITH(
      check_json_text(nested(101), "x.json"), Catch::Contains("x.json: lists and objects nested")
  );
}

TEST_CASE("JSON of more fields in an object than anything has is refused before it is parsed") {
  const auto object = [](int fields) {
    std::string text = "[{";
    for (int i = 0; i < fields; ++i) text += fmt::format("{}\"{}\":0", i > 0 ? "," : "", i);
    return text + "}]";
  };
  CHECK(parse_json(object(60000)).is_array());
  CHECK(parse_json(object(70000)).is_discarded());
  CHECK_THROWS_WITH(
      check_json_text(object(70000), "x.json"), Catch::Contains("x.json: an object of 70000 fields")
  );
}

// SPDX-License-Identifier: MIT
#include "datasets/camera_yaml.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/support/temp_folder.h"

using namespace glint;
using Catch::Contains;
using nlohmann::json;

namespace {

json parse(const std::string& text) { return parse_camera_yaml(text, "x.yml"); }

std::string error_of(const std::string& text) {
  return test::bad_reference([&] { parse(text); });
}

}  // namespace

TEST_CASE("files as OpenCV writes them are read") {
  const json file = parse(
      "%YAML:1.0\n---\nnames:\n   - \"00\"\n   - \"a \\\"b\\\"\"\n"
      "K_00: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 1., -2.5e+01, .5,\n"
      "       .Nan ]\nH_00: 36 \nccm:\n   [ 1, 2 ]\nempty:\nlast: 'x: y' # a remark\n"
  );
  CHECK(file["names"] == json({"00", "a \"b\""}));
  CHECK(file["K_00"]["rows"] == 3);
  CHECK(file["K_00"]["data"][1] == -25);
  CHECK(file["K_00"]["data"][2] == 0.5);
  CHECK(std::isnan(file["K_00"]["data"][3].get<double>()));
  CHECK(file["H_00"] == 36);
  CHECK(file["ccm"] == json({1.0, 2.0}));
  CHECK(file["empty"].is_null());
  CHECK(file["last"] == "x: y");
}

TEST_CASE("lists and fields in brackets, lists beside their field's name and line ends of Windows"
) {
  const json file =
      parse("# remark\r\nnames:\r\n- a b\r\n- 007\r\nsize: { w: 4, h: [ 2, ] }\r\n...\r\n");
  CHECK(file["names"] == json({"a b", 7.0}));
  CHECK(file["size"] == json({{"w", 4.0}, {"h", {2.0}}}));
  CHECK(parse("a: 1\na: 2\n")["a"] == 1);
  CHECK(parse("a: [ [ 1, 2 ], [ 3 ] ]\n")["a"] == json({{1.0, 2.0}, json::array({3.0})}));
  CHECK(parse("").is_null());
  CHECK(parse("%YAML:1.0\n---\n").is_null());
  CHECK(parse("- 1\n- 2\n") == json({1.0, 2.0}));
}

TEST_CASE("what is no such file is an error of its line") {
  for (const auto& [text, line] : std::vector<std::pair<std::string, int>>{
           {"a: 1\n: 2\n", 2},
           {"a: [ 1, 2\nb: 3\n", 2},
           {"a: [ 1 2", 1},
           {"a: \"text\nb: 1\n", 1},
           {"a: b: 1\n", 1},
           {"  a: 1\nb: 2\n", 2},
           {"a: [1] 2\n", 1},
           {"a: 1\n? [ b ]\n: 2\n", 2},
           {"a: &x 1\nb: *x\n", 2},
           {"a: 1\n---\nb: 1\n", 2},
           {"a: " + std::string(100, '['), 1},
           {"a: " + std::string(100000, '['), 1}}) {
    INFO(text.substr(0, 50));
    CHECK_THAT(error_of(text), Contains(fmt::format("x.yml: line {}: ", line)));
  }
  CHECK_THAT(
      error_of("a: " + std::string(100, '[') + std::string(100, ']')),
      Contains("nested more than 50 deep")
  );
}

TEST_CASE("a zero byte, behind which no message would go on, is refused with its line") {
  for (std::string text : {"names:\n   - a?b\n", "names:\n   - \"?\"\n"}) {
    text[text.find('?')] = '\0';
    CHECK_THAT(error_of(text), Contains("x.yml: line 2: a control character"));
  }
}

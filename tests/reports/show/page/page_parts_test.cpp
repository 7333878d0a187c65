// SPDX-License-Identifier: MIT
// Pieces of the page: script texts, packed values, meshes, curves.
#include <zlib.h>

#include <catch2/catch.hpp>
#include <limits>

#include "reports/run/records/script_text.h"
#include "reports/show/page/mesh_part.h"
#include "reports/show/page/probe_values.h"
#include "reports/show/pictures/training_curve.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8) & 255u));
  }
  return bytes;
}

std::vector<std::uint8_t> unpacked(const Json& text, std::size_t size) {
  const auto stream = from_base64(text.get<std::string>());
  std::vector<std::uint8_t> bytes(size);
  uLongf length = static_cast<uLongf>(size);
  const int status =
      uncompress(bytes.data(), &length, stream.data(), static_cast<uLong>(stream.size()));
  REQUIRE(status == Z_OK);
  REQUIRE(length == size);
  return bytes;
}

std::uint32_t code16(const std::vector<std::uint8_t>& bytes, std::size_t i) {
  return bytes[i] | static_cast<std::uint32_t>(bytes[bytes.size() / 2 + i]) << 8;
}

// n x n squares of two triangles each, 1 m wide.
TriangleMesh sheet(int n) {
  TriangleMesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.vertices.push_back(
          {static_cast<float>(x) / static_cast<float>(n),
           static_cast<float>(y) / static_cast<float>(n),
           0.5f}
      );
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x;
      mesh.faces.push_back({a, a + 1, a + n + 1});
      mesh.faces.push_back({a + 1, a + n + 2, a + n + 1});
    }
  return mesh;
}

}  // namespace

TEST_CASE("base64 has the digits and padding of RFC 4648") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo") == "Zm9v");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64("\xff\xfe") == "//4=");
}

TEST_CASE("words of shell commands are quoted where they must be") {
  CHECK(shell_word("room_1/glint/no-trans/0") == "room_1/glint/no-trans/0");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("a b;$(rm)") == "'a b;$(rm)'");
  CHECK(shell_word("it's") == "'it'\\''s'");
}

TEST_CASE("JSON in a script cannot close its element") {
  const Json json = {{"text", "</script> \xe2\x80\xa8 \xc3\xa4 <!--"}};
  const std::string text = script_json(json);
  CHECK(text.find('<') == std::string::npos);
  CHECK(Json::parse(text) == json);
}

TEST_CASE("the probe keeps depths in 16 bits and none apart from near") {
  Image depth(2, 2, 1);
  depth.at(0, 0) = 4.0f;
  depth.at(1, 0) = 1e-6f;
  depth.at(0, 1) = 0.0f;
  depth.at(1, 1) = std::numeric_limits<float>::infinity();
  const Json json = probe_values({{"depth", depth}}, 1);
  const auto bytes = unpacked(json["depth"]["data"], 8);
  CHECK(json["depth"]["high"] == 4.0);
  CHECK(code16(bytes, 0) == 65535);
  CHECK(code16(bytes, 1) == 1);
  CHECK(code16(bytes, 2) == 0);
  CHECK(code16(bytes, 3) == 0);
}

TEST_CASE("an angle of zero degrees is a value, a missing one is none") {
  Image angle(2, 1, 1);
  angle.at(1, 0) = std::numeric_limits<float>::quiet_NaN();
  const auto bytes = unpacked(probe_values({{"angle", angle}}, 1)["angle"]["data"], 4);
  CHECK(code16(bytes, 0) == 1);
  CHECK(code16(bytes, 1) == 0);
}

TEST_CASE("the probe clamps colours to what is scored") {
  Image rgb(1, 1, 3);
  rgb.at(0, 0, 0) = -0.5f;
  rgb.at(0, 0, 1) = 0.5f;
  rgb.at(0, 0, 2) = 7.0f;
  const auto bytes = unpacked(probe_values({{"rgb", rgb}}, 1)["rgb"]["data"], 3);
  CHECK(bytes == std::vector<std::uint8_t>{0, 128, 255});
}

TEST_CASE("large views keep every nth pixel") {
  CHECK(probe_step({500, 500}) == 1);
  CHECK(probe_step({960, 540}) == 2);
  Image t(3, 3, 1);
  for (int i = 0; i < 9; ++i) t.values()[static_cast<std::size_t>(i)] = static_cast<float>(i) / 8;
  const auto bytes = unpacked(probe_values({{"transparency", t}}, 2)["transparency"]["data"], 4);
  CHECK(bytes == std::vector<std::uint8_t>{0, 64, 191, 255});
}

TEST_CASE("merging the vertices of a flat sheet keeps it flat and inside its bounds") {
  const TriangleMesh coarse = merge_vertices(sheet(16), 0.25f);
  CHECK(coarse.vertices.size() == 25);
  CHECK(!coarse.faces.empty());
  CHECK(coarse.faces.size() < sheet(16).faces.size());
  for (const Vec3f& vertex : coarse.vertices) {
    CHECK(vertex.z == 0.5f);
    CHECK((vertex.x >= 0 && vertex.x <= 1 && vertex.y >= 0 && vertex.y <= 1));
  }
  for (const auto& face : coarse.faces) CHECK((face[0] != face[1] && face[1] != face[2]));
}

TEST_CASE("meshes get few faces only where they have many") {
  CHECK(with_few_faces(sheet(4), 32).faces == sheet(4).faces);
  const std::size_t faces = with_few_faces(sheet(40), 1000).faces.size();
  CHECK(faces <= 1000);
  CHECK(faces > 200);
}

TEST_CASE("a mesh is packed as steps between its bounds") {
  TriangleMesh mesh;
  mesh.vertices = {{-1, 0, 2}, {3, 0, 2}, {1, 5, 2}};
  mesh.faces = {{0, 1, 2}};
  mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Json json = mesh_json(mesh);
  CHECK(json["low"] == Json({-1.0, 0.0, 2.0}));
  CHECK(json["high"] == Json({3.0, 5.0, 2.0}));
  const auto positions = unpacked(json["position"], 18);
  CHECK(code16(positions, 3) == 65535);  // x of the second
  CHECK(code16(positions, 6) == 32768);  // x of the third, half way
  CHECK(unpacked(json["index"], 12)[4] == 1);
  CHECK(unpacked(json["color"], 9) == std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 255});
  CHECK(mesh_json(TriangleMesh{})["faces"] == 0);
}

TEST_CASE("a curve averages neighbours and keeps the last step") {
  const test::TempFolder folder;
  for (int i = 0; i < 10; ++i)
    append_line(
        folder / "log.jsonl", fmt::format(R"({{"iteration":{},"loss":{},"seconds":{}}})", i, i, i)
    );
  const Json curve = training_curve(folder / "log.jsonl", 5);
  CHECK(curve["iteration"] == Json({1.0, 3.0, 5.0, 7.0, 9.0}));
  CHECK(curve["loss"] == Json({0.5, 2.5, 4.5, 6.5, 8.5}));
  CHECK(curve["psnr"][0].is_null());
  CHECK(training_curve(folder / "none.jsonl").is_null());
  write_file(folder / "torn.jsonl", R"({"iterat)");
  CHECK(training_curve(folder / "torn.jsonl").is_null());
}

TEST_CASE("a curve has the events of the log where they happened") {
  const test::TempFolder folder;
  append_line(folder / "log.jsonl", R"({"iteration": 0, "seconds": 0})");
  append_line(
      folder / "log.jsonl",
      R"({"iteration": 10, "seconds": 2, "events": [{"iteration": 7, "text": "opacities reset"}, 3]})"
  );
  const Json events = training_curve(folder / "log.jsonl")["events"];
  REQUIRE(events.size() == 1);
  CHECK(events[0] == Json({{"iteration", 7}, {"seconds", 2}, {"text", "opacities reset"}}));
}

TEST_CASE("a curve says where loss terms and changes of the surfels begin and end") {
  const test::TempFolder folder;
  for (int i = 0; i < 100; ++i) {
    Json step = {{"iteration", 10 * i}, {"seconds", i}, {"num_surfels", i < 30 ? 5 : 7}};
    step["terms"]["photometric"] = 1;
    if (i >= 40 && i % 2 == 0) step["terms"]["normal"] = 1;  // not in the last step, but lasting
    if (i < 20) step["terms"]["warm-up"] = 1;
    append_line(folder / "log.jsonl", step.dump());
  }
  const Json events = training_curve(folder / "log.jsonl")["events"];
  REQUIRE(events.size() == 4);
  CHECK(events[0] == Json({{"iteration", 400}, {"seconds", 40}, {"text", "normal loss begins"}}));
  CHECK(events[1]["text"] == "warm-up loss ends");
  CHECK(events[1]["iteration"] == 190.0);
  CHECK(events[2]["text"] == "first change of the number of surfels");
  CHECK(events[3]["iteration"] == 300.0);
}

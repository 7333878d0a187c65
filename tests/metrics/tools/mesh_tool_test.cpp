// SPDX-License-Identifier: MIT
// glint-mesh, called as main() calls it.
#include <catch2/catch.hpp>
#include <sstream>

#include "glint/core/config.h"
#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "metrics/mesh/mesh_scores.h"
#include "metrics/tools/mesh.h"
#include "tests/metrics/mesh/shapes.h"
#include "tests/support/box_room.h"
#include "tests/support/captured.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Result {
  int code = 0;
  std::string out, err;
  Json json() const { return Json::parse(out); }
};

Result mesh_tool(std::vector<std::string> args) {
  if (!args.empty()) args.insert(args.end(), {"--quiet", "--samples", "5000"});
  std::ostringstream out, err;
  const int code = run_mesh_tool(args, out, err);
  return {code, out.str(), err.str()};
}

// pred.ply and ref.ply: squares 3 cm apart.
struct Pair : TempFolder {
  std::string pred = *this / "pred.ply", ref = *this / "ref.ply";
  Pair() {
    write_mesh_ply(pred, unit_square(0.03f));
    write_mesh_ply(ref, unit_square(0));
  }
  Result run(std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {pred, ref});
    return mesh_tool(options);
  }
  // With another prediction.
  Result run_file(const std::string& name, const std::string& content) const {
    write_file(*this / name, content);
    return mesh_tool({*this / name, ref});
  }
};

std::string ascii_mesh(int faces, const std::string& rows) {
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n{}",
      faces,
      rows
  );
}

// The box room of the nerfstudio folder, with a cupboard's inside that nobody sees.
TriangleMesh room_mesh() {
  TriangleMesh mesh = parallelogram({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, 20, 20);
  append(mesh, parallelogram({0, 0, -0.5f}, {4, 0, 0}, {0, 3, 0}, 20, 20));
  return mesh;
}

}  // namespace

TEST_CASE("glint-mesh prints what the functions give, with protocol and unrounded numbers") {
  const Pair pair;
  const Result result = pair.run({"--json"});
  REQUIRE(result.code == 0);
  const Json json = result.json();
  MeshProtocol protocol;
  protocol.num_samples = 5000;
  protocol.cull = MeshCulling::kNone;
  const auto values =
      mesh_values(mesh_scores(unit_square(0.03f), unit_square(0), protocol), protocol);
  REQUIRE(json["metrics"].size() == values.size());
  for (const auto& [id, value] : values) CHECK(json["metrics"][id] == value);
  CHECK(json["protocol"] == config_to_json(protocol));
  CHECK(json["metrics"]["mesh-f1@5cm"] == 1.0);
  CHECK(json["metrics"]["mesh-f1@2cm"] == 0.0);
  CHECK(json["curve"].size() == 100);
  CHECK(json["surfaces"]["prediction"]["cleaning"]["faces_after"] == 2);
}

TEST_CASE("glint-mesh prints a line per value, or one CSV row") {
  const Pair pair;
  const Result text = pair.run();
  CHECK(text.code == 0);
  CHECK_THAT(text.out, Contains("mesh-cd 0.030000 m\n") && Contains("mesh-f1@5cm 1.00000\n"));
  CHECK_THAT(text.out, Contains("protocol {\"num_samples\":5000"));
  const Result csv = pair.run({"--csv", "--thresholds", "0.04", "--distance", "point-to-point"});
  CHECK_THAT(csv.out, Catch::StartsWith("name,mesh-cd-p2p,mesh-accuracy-p2p"));
  CHECK_THAT(csv.out, Contains("mesh-f1@4cm-p2p") && Contains(pair.pred));
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 2);
}

TEST_CASE("glint-mesh takes a run folder's and a dataset folder's meshes and culls by its cameras"
) {
  const TempFolder folder;
  write_nerfstudio(folder / "data", box_room_views(10, {32, 24}));
  TriangleMesh floor = room_mesh();
  write_mesh_ply(folder / "data/gt/mesh.ply", floor);
  for (Vec3f& v : floor.vertices) v.z += 0.02f;
  write_mesh_ply(folder / "run/mesh.ply", floor);
  const Result result = mesh_tool({folder / "run", folder / "data", "--json"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Json json = result.json();
  CHECK(json["prediction"] == (folder / "run/mesh.ply").string());
  CHECK(json["protocol"]["cull"] == "cameras");
  const Json& recipe = json["surfaces"]["reference"]["culling"];
  CHECK(recipe["num_cameras"] == 8);
  CHECK(recipe["faces_before"] == 1600);
  CHECK(recipe["area_after_m2"].get<double>() > 1);
  CHECK(recipe["area_after_m2"].get<double>() < 12.001);  // the upper floor at most
  CHECK(json["metrics"]["mesh-accuracy"].get<double>() < 0.05);
  const Result plain = mesh_tool({folder / "run", folder / "data", "--cull", "none", "--json"});
  CHECK_FALSE(plain.json()["surfaces"]["reference"].contains("culling"));
  CHECK(plain.json()["protocol"]["cull"] == "none");
  const Result by_option = mesh_tool(
      {folder / "run/mesh.ply", folder / "data/gt/mesh.ply", "--dataset", folder / "data", "--json"}
  );
  CHECK(by_option.json()["metrics"] == json["metrics"]);
}

TEST_CASE("glint-mesh measures a scored run by the protocol of its scores, options go before it") {
  const Pair pair;
  fs::create_directories(pair / "run");
  fs::copy_file(pair.pred, pair / "run/mesh.ply");
  const Json fields = {{"seed", 7}, {"thresholds_m", {0.04}}, {"distance", "point-to-point"}};
  write_file(pair / "run/metrics.json", Json{{"meshes", {{"protocol", fields}}}}.dump());
  const Json scored = mesh_tool({pair / "run", pair.ref, "--json"}).json();
  CHECK(scored["protocol"]["seed"] == 7);
  CHECK(scored["protocol"]["distance"] == "point-to-triangle");
  CHECK(scored["metrics"].contains("mesh-f1@4cm"));
  const Json asked = mesh_tool({pair / "run", pair.ref, "--json", "--seed", "9"}).json();
  CHECK(asked["protocol"]["seed"] == 9);
  CHECK(asked["metrics"].contains("mesh-f1@4cm"));
  for (const char* text : {"[]", "{\"meshes\": 3}", "{}"}) {
    write_file(pair / "run/metrics.json", text);
    const Result result = mesh_tool({pair / "run", pair.ref, "--json"});
    INFO(text << result.err);
    CHECK(result.code == (std::string(text) == "[]" ? 2 : 0));
  }
}

TEST_CASE("glint-mesh writes coloured surfaces and the curve") {
  const Pair pair;
  const Result result = pair.run(
      {"--colored",
       pair / "c.ply",
       "--colored-reference",
       pair / "r.ply",
       "--curve",
       pair / "curve.png"}
  );
  REQUIRE(result.code == 0);
  CHECK_THAT(result.out, Contains("colours: 0 m yellow to 0.1 m violet"));
  const TriangleMesh colored = read_mesh_ply(pair / "c.ply");
  REQUIRE(colored.colors.size() == 4);
  CHECK(length(colored.colors[0] - colored.colors[3]) == 0);  // all 3 cm away
  CHECK(read_mesh_ply(pair / "r.ply").colors.size() == 4);
  const Image curve = read_image(pair / "curve.png", 3);
  CHECK(curve.width() > curve.height());
  CHECK(curve.at(0, 0, 0) == 1);
  CHECK(read_file(pair / "curve.pdf").starts_with("%PDF-"));
}

TEST_CASE("glint-mesh measures point clouds, and does not cull them") {
  const Pair pair;
  write_point_ply(
      pair / "points.ply",
      {{{0.5f, 0.5f, 0.1f}, {0.25f, 0.5f, 0.1f}}, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, 2}, {0, 0, 2}}}
  );
  const Result result =
      mesh_tool({pair / "points.ply", pair.ref, "--json", "--colored", pair / "c.ply"});
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.json()["metrics"]["mesh-accuracy"].get<double>() == Approx(0.1));
  CHECK(result.json()["metrics"]["mesh-normal"].get<double>() == Approx(1));
  CHECK(result.json()["surfaces"]["prediction"]["kind"] == "points");
  const std::size_t count = result.json()["surfaces"]["prediction"]["num_points"];
  CHECK(result.json()["surfaces"]["prediction"]["num_samples"] == count);
  CHECK_THAT(
      mesh_tool({pair / "points.ply", pair.ref}).out,
      Contains(fmt::format("prediction: {} points, all of them measured", count))
  );
  CHECK(read_point_ply(pair / "c.ply").positions.size() == 2);
  write_nerfstudio(pair / "data", box_room_views(10, {32, 24}));
  write_mesh_ply(pair / "data/gt/mesh.ply", room_mesh());
  const Result culled = mesh_tool({pair / "points.ply", pair / "data"});
  CHECK(culled.code == 2);
  CHECK_THAT(culled.err, Contains("cannot be culled") && Contains("--cull none"));
}

TEST_CASE("glint-mesh gives the same bytes with one and two threads") {
  const Pair pair;
  write_mesh_ply(pair.pred, sphere(0.7, 30));
  const std::string one = pair.run({"--json", "--threads", "1"}).out;
  const std::string two = pair.run({"--json", "--threads", "2"}).out;
  set_num_threads(0);
  CHECK(one == two);
}

TEST_CASE("a mesh without faces is an error that says what to do") {
  const Pair pair;
  const Result result = pair.run_file("x.ply", ascii_mesh(0, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"));
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Contains("x.ply") && Contains("4 vertices without faces"));
}

TEST_CASE("vertices that are not finite cost their faces and are reported") {
  const Pair pair;
  const Result result =
      pair.run_file("x.ply", ascii_mesh(2, "0 0 0\n1 0 0\n1 1 0\nnan 1 0\n3 0 1 2\n3 0 2 3\n"));
  CHECK(result.code == 0);
  CHECK_THAT(result.out, Contains("prediction: of 2 faces dropped 1 not finite"));
  const Result none =
      pair.run_file("x.ply", ascii_mesh(1, "0 0 0\n1 0 0\n1 1 0\nnan 1 0\n3 0 2 3\n"));
  CHECK(none.code == 2);
  CHECK_THAT(none.err, Contains("none of 1 faces can be used: 1 are not finite"));
}

TEST_CASE("repeated faces and non-manifold edges are reported") {
  const Pair pair;
  const Result result = pair.run_file(
      "x.ply", ascii_mesh(4, "0 0 0\n1 0 0\n1 1 0\n0 0 1\n3 0 1 2\n3 2 1 0\n3 0 1 3\n3 1 0 2\n")
  );
  CHECK(result.code == 0);
  CHECK_THAT(result.out, Contains("2 repeated"));
  const Result fins = pair.run_file(
      "x.ply", ascii_mesh(3, "0 0 0\n1 0 0\n1 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n")
  );
  CHECK(fins.code == 0);
  CHECK_THAT(fins.out, !Contains("non-manifold"));
}

TEST_CASE("an empty file is an error with the side's exit code") {
  const Pair pair;
  const Result prediction = pair.run_file("x.ply", "");
  CHECK(prediction.code == 2);
  CHECK_THAT(prediction.err, Contains("x.ply: not a PLY file"));
  CHECK(mesh_tool({pair.pred, pair / "x.ply"}).code == 3);
}

TEST_CASE("another format is an error that names the one that is read") {
  const Pair pair;
  const Result result = pair.run_file("x.fbx", "");
  CHECK(result.code == 2);
  CHECK_THAT(
      result.err, Contains("x.fbx: '.fbx' files are not read; expected") && Contains(".ply")
  );
}

TEST_CASE("missing files, and folders without a mesh, are errors with the side's exit code") {
  const Pair pair;
  CHECK(mesh_tool({pair / "none.ply", pair.ref}).code == 2);
  CHECK(mesh_tool({pair.pred, pair / "none.ply"}).code == 3);
  fs::create_directories(pair / "run");
  const Result result = mesh_tool({pair / "run", pair.ref});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Contains("run/mesh.ply: no such file"));
}

TEST_CASE("a mesh that no camera sees is an error that asks for the frame") {
  const TempFolder folder;
  write_nerfstudio(folder / "data", box_room_views(10, {32, 24}));
  write_mesh_ply(folder / "data/gt/mesh.ply", room_mesh());
  write_mesh_ply(folder / "away.ply", parallelogram({0, 0, 90}, {1, 0, 0}, {0, 1, 0}));
  const Result result = mesh_tool({folder / "away.ply", folder / "data"});
  CHECK(result.code == 2);
  CHECK_THAT(result.err, Contains("none of 2 faces is seen by any of 8 cameras"));
}

TEST_CASE("impossible options are usage errors, and help has an example") {
  const Pair pair;
  CHECK(mesh_tool({}).code == 1);
  CHECK(pair.run({"--thresholds", "-0.01"}).code == 1);
  CHECK(pair.run({"--distance", "nearest"}).code == 1);
  CHECK(pair.run({"--colored", "out.obj"}).code == 1);
  CHECK(pair.run({"--json", "--csv"}).code == 1);
  const Result cull = pair.run({"--cull", "cameras"});
  CHECK(cull.code == 1);
  CHECK_THAT(cull.err, Contains("--dataset"));
  std::ostringstream out, err;
  CHECK(run_mesh_tool({pair.pred, pair.ref, "--samples", "0"}, out, err) == 1);
  const Result help = mesh_tool({"--help"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out, Contains("glint-mesh out/ci/runs/room_1/2dgs/0 data/glassroom/room_1-*"));
}

TEST_CASE("glint-mesh refuses thresholds beyond the largest distance, repeated ones, odd seeds") {
  const Pair pair;
  const Result beyond = pair.run({"--max-distance", "0.04"});
  CHECK(beyond.code == 1);
  CHECK_THAT(beyond.err, Contains("--max-distance") && Contains("--thresholds"));
  CHECK(pair.run({"--max-distance", "0.1"}).code == 0);
  CHECK(pair.run({"--thresholds", "0.05", "0.05"}).code == 1);
  for (const char* seed : {"-1", "99999999999999999999"})
    CHECK_THAT(pair.run({"--seed", seed}).err, Contains("--seed is"));
  CHECK_THAT(
      pair.run({"--max-distance", "0"}).err, Contains("--max-distance: '0' must be above 0\n")
  );
}

TEST_CASE("glint-mesh writes over nothing that it reads, and asks for no more than there is") {
  const Pair pair;
  const std::string before = read_file(pair.pred);
  for (const std::string option : {"--colored", "--colored-reference"})
    for (const std::string& input : {pair.pred, pair.ref}) {
      const Result result = pair.run({option, input});
      CHECK(result.code == 1);
      CHECK_THAT(result.err, Contains("is read, and would be written over"));
    }
  CHECK(read_file(pair.pred) == before);
  CHECK_THAT(pair.run({"--seed", ""}).err, Contains("--seed is empty"));
  std::ostringstream out, err;
  CHECK(run_mesh_tool({pair.pred, pair.ref, "--quiet", "--samples", "1000000000"}, out, err) == 6);
  CHECK_THAT(err.str(), Contains("--samples 1000000000 needs about 600.0 GB"));
  CHECK(run_mesh_tool({pair.pred, pair.ref, "--samples", "18446744073709551615"}, out, err) == 1);
}

TEST_CASE("faces with a corner that is not finite are dropped with a count") {
  const Pair pair;
  const std::string rows =
      "0 0 0\n1 0 0\n1 1 0\nnan 1 0\n"
      "3 0 1 2\n3 0 2 3\n3 1 2 3\n";
  Json surfaces;
  const std::string told = captured(2, [&] {
    write_file(pair / "nan.ply", ascii_mesh(3, rows));
    surfaces = mesh_tool({pair / "nan.ply", pair.ref, "--json"}).json()["surfaces"];
  });
  CHECK_THAT(told, Contains("nan.ply: 2 of 3 faces have a corner that is not finite"));
  CHECK(surfaces["prediction"]["cleaning"]["not_finite"] == 2);
}

namespace {

// A mesh as glTF with its buffer inside, the node scaled.
std::string gltf_of(const TriangleMesh& mesh, double scale) {
  std::string bytes;
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const auto& face : mesh.faces)
    for (const std::int32_t corner : face) add(corner);
  const std::size_t positions_at = bytes.size();
  for (const Vec3f& v : mesh.vertices) add(v);
  Json accessors = {
      {{"bufferView", 0}, {"componentType", 5125}, {"count", 3 * mesh.faces.size()}},
      {{"bufferView", 1}, {"componentType", 5126}, {"count", mesh.vertices.size()}}};
  accessors[0]["type"] = "SCALAR";
  accessors[1]["type"] = "VEC3";
  const Json json = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}, {"scale", {scale, scale, scale}}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 1}}}, {"indices", 0}}}}}}},
      {"buffers", {{{"byteLength", bytes.size()}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions_at}},
        {{"buffer", 0},
         {"byteOffset", positions_at},
         {"byteLength", bytes.size() - positions_at}}}},
      {"accessors", accessors}};
  const auto padded = [](std::string text, char with) {
    text.resize((text.size() + 3) / 4 * 4, with);
    return text;
  };
  const std::string text = padded(json.dump(), ' '), buffer = padded(bytes, '\0');
  std::string file = "glTF";
  const auto add_number = [&](std::uint32_t n) { file.append(reinterpret_cast<char*>(&n), 4); };
  add_number(2);
  add_number(static_cast<std::uint32_t>(28 + text.size() + buffer.size()));
  add_number(static_cast<std::uint32_t>(text.size()));
  file += "JSON" + text;
  add_number(static_cast<std::uint32_t>(buffer.size()));
  return file + std::string("BIN\0", 4) + buffer;
}

// Two sides of a box whose axes differ in length.
TriangleMesh corner_of_box() {
  TriangleMesh mesh = parallelogram({0, 0, 0}, {1, 0, 0}, {0, 2, 0});
  const TriangleMesh side = parallelogram({0, 0, 0}, {0, 2, 0}, {0, 0, 4});
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), side.vertices.begin(), side.vertices.end());
  for (const auto& face : side.faces)
    mesh.faces.push_back({first + face[0], first + face[1], first + face[2]});
  return mesh;
}

}  // namespace

TEST_CASE("the same mesh as PLY of either order, OBJ, STL and glTF scores as the same") {
  const Pair pair;
  const auto check = [&](const std::string& name, const std::string& content) {
    const Result result = pair.run_file(name, content);
    INFO(name << ": " << result.err);
    REQUIRE(result.code == 0);
    CHECK_THAT(result.out, Contains("mesh-cd 0.030000 m"));
  };
  // A square of two triangles, 3 cm in front.
  const std::string corners = "v 0 0 0.03\nv 1 0 0.03\nv 1 1 0.03\nv 0 1 0.03\n";
  check("plain.obj", corners + "f 1 2 3 4\n");
  check("texture.obj", corners + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1\n");
  check("negative.obj", corners + "f -4 -3 -2\nf -4 -2 -1\n");
  check(
      "x.stl",
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.03\nvertex 1 0 0.03\nvertex 1 1 "
      "0.03\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.03\nvertex 1 1 "
      "0.03\nvertex 0 1 0.03\nendloop\nendfacet\nendsolid x\n"
  );
  TriangleMesh tenfold = unit_square(0.03f);
  for (Vec3f& vertex : tenfold.vertices) vertex = 10.0f * vertex;
  check("x.glb", gltf_of(tenfold, 0.1));
  std::string big = ascii_mesh(2, "");
  big.replace(big.find("ascii"), 5, "binary_big_endian");
  big.insert(big.find("property list"), "property list uchar float texcoord\n");
  const auto add = [&](auto value) {
    std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
    big.append(bytes.rbegin(), bytes.rend());
  };
  for (const Vec3f& v : {Vec3f{0, 0, 0.03f}, {1, 0, 0.03f}, {1, 1, 0.03f}, {0, 1, 0.03f}})
    for (int c = 0; c < 3; ++c) add(v[c]);
  for (const auto& face : {std::array{0, 1, 2}, {0, 2, 3}}) {
    add(std::uint8_t{2}), add(0.5f), add(0.25f), add(std::uint8_t{3});
    for (const std::int32_t corner : face) add(corner);
  }
  check("big.ply", big);
}

TEST_CASE("a glTF that was turned from z up is told of, and turned back on request") {
  const Pair pair;
  const TriangleMesh box = corner_of_box();
  write_mesh_ply(pair.ref, box);
  TriangleMesh turned = box;
  for (Vec3f& v : turned.vertices) v = {v.x, v.z, -v.y};
  write_file(pair / "x.glb", gltf_of(turned, 1));
  write_file(pair / "same.glb", gltf_of(box, 1));
  const auto run = [&](const char* file, std::vector<std::string> options) {
    options.insert(options.begin(), {pair / file, pair.ref, "--json"});
    return mesh_tool(options).json();
  };
  CHECK_THAT(run("x.glb", {})["warnings"].dump(), Contains("give --gltf-up z"));
  const Json mended = run("x.glb", {"--gltf-up", "z"});
  CHECK_FALSE(mended.contains("warnings"));
  CHECK(mended["gltf_up"] == "z");
  CHECK(mended["metrics"]["mesh-cd"].get<double>() < 1e-6);
  CHECK_FALSE(run("same.glb", {}).contains("warnings"));
}

TEST_CASE("a mesh in another unit is scored as metres, with the ratio and the likely unit") {
  const Pair pair;
  const auto warnings = [&](float scale) {
    TriangleMesh mesh = unit_square(0.03f);
    for (Vec3f& vertex : mesh.vertices) vertex = scale * vertex;
    write_mesh_ply(pair.pred, mesh);
    return pair.run({"--json"}).json().value("warnings", Json::array());
  };
  CHECK(warnings(1).empty());
  CHECK(warnings(3).empty());
  for (const auto& [scale, unit] :
       {std::pair(1000.0f, "millimetres"), {100.0f, "centimetres"}, {10.0f, "decimetres"}}) {
    const Json found = warnings(scale);
    REQUIRE(found.size() == 1);
    CHECK_THAT(
        found[0].get<std::string>(),
        Contains(fmt::format("is {:.3g} times as large", scale)) && Contains(unit)
    );
  }
}

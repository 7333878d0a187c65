// SPDX-License-Identifier: MIT
// glint-tsdf as a program, on true depth of a small room.
#include "metrics/tools/tsdf.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;

namespace {

struct Outcome {
  int code;
  std::string out, err;
};

Outcome run(std::vector<std::string> args) {
  args.insert(args.end(), {"--voxel", "0.1", "--quiet"});
  std::ostringstream out, err;
  const int code = run_tsdf_program(args, out, err);
  return {code, out.str(), err.str()};
}

// Depth maps of some test views as maps/<name>_z.exr, beside masks of their left half.
class Maps {
 public:
  Maps() {
    for (const View& view : small_room().test) {
      write_exr(folder_ / "maps" / (view.name + "_z.exr"), view.truth["depth"]);
      Image mask(view.truth["depth"].width(), view.truth["depth"].height(), 1);
      for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width() / 2; ++x) mask.at(x, y) = 1;
      write_png(folder_ / "masks" / (view.name + ".png"), mask);
    }
  }

  // Of the maps' left part.
  static std::size_t num_depths(double part) {
    std::size_t count = 0;
    for (const View& view : small_room().test)
      for (int y = 0; y < view.truth["depth"].height(); ++y)
        for (int x = 0; x < part * view.truth["depth"].width(); ++x)
          count += view.truth["depth"].at(x, y) > 0;
    return count;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string room() const { return small_room_folder().string(); }
  Json fused(std::vector<std::string> more) const {
    std::vector<std::string> args = {path("maps/*_z.exr"), room(), "-o", path("m.ply"), "--json"};
    args.insert(args.end(), more.begin(), more.end());
    const Outcome outcome = run(args);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return Json::parse(outcome.out);
  }

 private:
  TempFolder folder_;
};

}  // namespace

TEST_CASE("glint-tsdf fuses a glob of maps by the names of the views") {
  const Maps maps;
  const Json json = maps.fused({});
  CHECK(json["report"]["num_views"] == small_room().test.size());
  CHECK(json["options"]["voxel"] == 0.1);
  CHECK(json["mesh"] == maps.path("m.ply"));
  const TriangleMesh mesh = read_mesh_ply(maps.path("m.ply"));
  CHECK(mesh.faces.size() == json["report"]["triangles"]);
  REQUIRE(mesh.faces.size() > 100);
}

TEST_CASE("glint-tsdf reads depth as integers by the length of a step, and asks for it") {
  const Maps maps;
  for (const View& view : small_room().test) {
    Image shares = view.truth["depth"];
    for (float& z : shares.values()) z *= 1000.0f / 65535;
    write_png16(maps.path("steps/" + view.name + ".png"), shares);
  }
  const Outcome without = run({maps.path("steps"), maps.room(), "-o", maps.path("m.ply")});
  CHECK(without.code == static_cast<int>(ExitCode::kBadPrediction));
  CHECK(without.err.find("integers hold no metres") != std::string::npos);
  const Outcome with = run(
      {maps.path("steps"),
       maps.room(),
       "-o",
       maps.path("m.ply"),
       "--json",
       "--depth-scale",
       "0.001"}
  );
  REQUIRE(with.code == 0);
  const Json json = Json::parse(with.out), of_floats = maps.fused({});
  CHECK(json["steps"]["metres"] == 0.001);
  const auto triangles = [](const Json& of) { return of["report"]["triangles"].get<double>(); };
  CHECK(triangles(json) == Approx(triangles(of_floats)).epsilon(0.05));  // rounded to a millimetre
}

TEST_CASE("glint-tsdf leaves out depths outside of masks") {
  const Maps maps;
  CHECK(maps.fused({})["report"]["num_depths"] == maps.num_depths(1));
  CHECK(maps.fused({"--mask", maps.path("masks")})["report"]["num_depths"] == maps.num_depths(0.5));
}

TEST_CASE("glint-tsdf prints a row of CSV or a line of text, and help without arguments") {
  const Maps maps;
  const Outcome csv =
      run({maps.path("maps/*_z.exr"), maps.room(), "-o", maps.path("a,b.ply"), "--csv"});
  REQUIRE(csv.code == 0);
  CHECK(csv.out.rfind("mesh,", 0) == 0);
  CHECK(csv.out.find("\n\"" + maps.path("a,b.ply") + "\",") != std::string::npos);
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 2);
  const Outcome text = run({maps.path("maps/*_z.exr"), maps.room(), "-o", maps.path("m.ply")});
  CHECK(text.out.find("voxel 0.1 m") != std::string::npos);
  std::ostringstream out, err;
  CHECK(run_tsdf_program({}, out, err) == static_cast<int>(ExitCode::kUsage));
  CHECK(err.str().find("Example") != std::string::npos);
}

TEST_CASE("glint-tsdf says what is wrong with its inputs, and writes no mesh") {
  const Maps maps;
  const auto fails = [&](std::vector<std::string> args, ExitCode code, const char* message) {
    args.insert(args.end(), {"-o", maps.path("none.ply")});
    const Outcome outcome = run(args);
    INFO(outcome.err);
    CHECK(outcome.code == static_cast<int>(code));
    CHECK(outcome.err.find(message) != std::string::npos);
    CHECK_FALSE(fs::exists(maps.path("none.ply")));
  };
  const std::string good = maps.path("maps/*_z.exr");
  fails({maps.path("nothing"), maps.room()}, ExitCode::kBadPrediction, "nothing");
  fails({maps.path("maps/*.npy"), maps.room()}, ExitCode::kBadPrediction, "matches no image");
  fails({maps.path("maps"), maps.room()}, ExitCode::kBadPrediction, "has no view");
  fails({good, maps.path("nowhere")}, ExitCode::kBadReference, "nowhere");
  fails({good, maps.room(), "--mask", maps.path("no_masks")}, ExitCode::kBadReference, "no_masks");
  fails({good, maps.room(), "--max-memory", "0.001"}, ExitCode::kUsage, "MB");
  fails({good, maps.room(), "--json", "--csv"}, ExitCode::kUsage, "--csv");
  write_png(maps.path("small.png"), Image(5, 5, 1, 1.0f));
  fails(
      {good, maps.room(), "--mask", maps.path("small.png")},
      ExitCode::kBadReference,
      "mask of 5 x 5"
  );
}

TEST_CASE("glint-tsdf writes over nothing that it reads and no file of the dataset") {
  const Maps maps;
  const auto written_to = [&](const std::string& out) {
    const Outcome outcome = run({maps.path("maps/*_z.exr"), maps.room(), "-o", out});
    CHECK(outcome.code == 1);
    return outcome.err;
  };
  CHECK_THAT(written_to(maps.room() + "/scene.json"), Catch::Contains("a mesh is written as .ply"));
  CHECK_THAT(written_to(maps.room() + "/gt/mesh.ply"), Catch::Contains("is a file of the dataset"));
}

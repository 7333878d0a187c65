// SPDX-License-Identifier: MIT
#include "reports/run/perf/perf.h"

#include <catch2/catch.hpp>

#include <algorithm>

#include "glint/core/progress.h"
#include "glint/method.h"
#include "glint/scene/ply.h"
#include "reports/run/perf/perf_scene.h"
#include "tests/support/temp_folder.h"

using namespace glint;

static PerfOptions small_options() {
  PerfOptions options;
  options.width = 32;
  options.height = 18;
  options.surfels = 200;
  return options;
}

TEST_CASE("every op and a training step of every method can be timed") {
  set_quiet(true);
  PerfOptions options = small_options();
  options.runs = 1;
  const std::vector<PerfRow> rows = run_perf(options);
  for (const PerfRow& row : rows) {
    INFO(row.name);
    CHECK(row.ms > 0);
  }
  for (const auto& [id, spec] : Registry<MethodSpec>::all()) {
    if (!spec.overrides.empty()) continue;
    INFO(id);
    CHECK(std::any_of(rows.begin(), rows.end(), [&, &name = id](const PerfRow& row) {
      return row.name == name + " training step";
    }));
  }
}

TEST_CASE("only what is asked for is made and timed") {
  set_quiet(true);
  PerfOptions options = small_options();
  const auto names = [&](const char* only) {
    options.only = only;
    std::vector<std::string> found;
    for (const PerfCase& c : make_perf_cases(options)) found.push_back(c.name);
    return found;
  };
  using Names = std::vector<std::string>;
  CHECK(names("Adam*|rasterize forward") == Names{"rasterize forward", "Adam, 58 values a surfel"});
  CHECK(names("2dgs training step") == Names{"2dgs training step"});
  CHECK(names("trace fog*").size() == 2);
}

TEST_CASE("a pattern that fits no op is an error") {
  PerfOptions options;
  options.only = "rasterise";
  CHECK_THROWS_WITH(make_perf_cases(options), Catch::Contains("--op rasterise: fits no op"));
}

TEST_CASE("the kernels of an op are timed one by one, with their launches") {
  set_quiet(true);
  PerfOptions options = small_options();
  options.runs = 2;
  options.only = "Adam*";
  const std::vector<KernelRow> rows = run_kernel_times(options);
  REQUIRE_FALSE(rows.empty());
  for (const KernelRow& row : rows) {
    INFO(row.kernel);
    CHECK(row.op == "Adam, 58 values a surfel");
    CHECK(row.ms > 0);
    CHECK(row.launches >= 1);
    CHECK_THAT(row.kernel, !Catch::Contains("glint::"));
  }
  CHECK(std::any_of(rows.begin(), rows.end(), [](const KernelRow& row) {
    return row.kernel.find("Adam") != std::string::npos;
  }));
  const std::string text = kernels_to_text(options, rows);
  CHECK_THAT(text, Catch::Contains(rows[0].kernel) && Catch::Contains("ms in kernels"));
  CHECK(kernels_to_json(options, rows)["rows"].size() == rows.size());
}

TEST_CASE("the timed scene can be written for other programs to be timed on") {
  const test::TempFolder folder;
  PerfOptions options;
  options.surfels = 50;
  write_perf_scene(options, folder.path());
  const SurfelCloud cloud = perf_cloud(options);
  CHECK(read_surfel_ply(folder / "surfels.ply").means == cloud.means);
  const Json json = Json::parse(read_file(folder / "camera.json"));
  CHECK(json["width"] == options.width);
  const Camera camera = perf_scene(options).train.front().camera;
  const Vec3d point = camera.to_cam({1, 2, 3});
  for (int i = 0; i < 3; ++i) {
    const Json& row = json["cam_from_world"][i];
    const double dot = row[0].get<double>() + 2 * row[1].get<double>() + 3 * row[2].get<double>();
    CHECK(dot + row[3].get<double>() == Approx(point[i]));
  }
}

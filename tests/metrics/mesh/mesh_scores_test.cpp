// SPDX-License-Identifier: MIT
#include "metrics/mesh/mesh_scores.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "glint/core/parallel.h"
#include "glint/scene/ply.h"
#include "metrics/mesh/clean.h"
#include "tests/metrics/mesh/shapes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// Samples are rounded to float: within this of their surface at coordinates of about 1.
constexpr double kRounding = 2e-7;

MeshProtocol protocol_of(std::uint64_t num_samples = 20'000) {
  MeshProtocol protocol;
  protocol.num_samples = num_samples;
  protocol.cull = MeshCulling::kNone;
  return protocol;
}

// Five standard errors of the mean of `count` values with this standard deviation.
double sampling_margin(double deviation, std::uint64_t count) {
  return 5 * deviation / std::sqrt(static_cast<double>(count));
}

}  // namespace

TEST_CASE("parallel squares are as far apart as their planes") {
  const MeshScores scores = mesh_scores(unit_square(0.03f), unit_square(0), protocol_of());
  CHECK(scores.accuracy.mean_m == Approx(0.03).margin(kRounding));
  CHECK(scores.completeness.mean_m == Approx(0.03).margin(kRounding));
  CHECK(scores.accuracy.max_m == Approx(0.03).margin(kRounding));
  CHECK(scores.accuracy.rms_m == Approx(0.03).margin(kRounding));
  CHECK(scores.chamfer_m == Approx(0.03).margin(kRounding));
  CHECK(*scores.normal_consistency == Approx(1).margin(1e-6));
  REQUIRE(scores.thresholds.size() == 4);
  for (const ThresholdScores& at : scores.thresholds)
    CHECK(at.f1 == (at.threshold_m > 0.03 ? 1 : 0));
}

TEST_CASE("concentric spheres are as far apart as their radii differ") {
  constexpr int kRings = 200;
  constexpr double kInner = 1, kOuter = 1.04;
  // Chords of two angular steps run inside the sphere by less than this.
  const double sagitta = kOuter * (1 - std::cos(2 * std::numbers::pi / kRings));
  MeshProtocol protocol = protocol_of();
  protocol.thresholds_m = {kOuter - kInner - sagitta, kOuter - kInner + sagitta};
  const MeshScores scores = mesh_scores(sphere(kOuter, kRings), sphere(kInner, kRings), protocol);
  CHECK(scores.accuracy.mean_m == Approx(kOuter - kInner).margin(sagitta));
  CHECK(scores.completeness.mean_m == Approx(kOuter - kInner).margin(sagitta));
  CHECK(scores.thresholds[0].f1 == 0);
  CHECK(scores.thresholds[1].f1 == 1);
  // Normals of facing triangles differ by at most a few steps.
  CHECK(*scores.normal_consistency > std::cos(3 * std::numbers::pi / kRings));
}

TEST_CASE("a tilted plane is sin(angle) / 2 away on average") {
  const float sine = 0.28f, cosine = 0.96f;
  const TriangleMesh tilted = parallelogram({0, 0, 0}, {cosine, 0, sine}, {0, 1, 0});
  MeshProtocol protocol = protocol_of(100'000);
  protocol.thresholds_m = {0.07};  // a quarter of sin(angle)
  // At x in [0, 1] the plane through the common edge is x sin(angle) away, foot at x cos(angle):
  // inside. So it is from the tilted square to the other.
  const MeshScores scores = mesh_scores(unit_square(0), tilted, protocol);
  const double margin = sampling_margin(0.28 / std::sqrt(12.0), protocol.num_samples);
  CHECK(scores.accuracy.mean_m == Approx(0.14).margin(margin));
  CHECK(scores.completeness.mean_m == Approx(0.14).margin(margin));
  CHECK(scores.accuracy.max_m == Approx(0.28).margin(1e-4));
  CHECK(*scores.normal_consistency == Approx(0.96).margin(1e-6));
  const double share_margin = sampling_margin(std::sqrt(0.25 * 0.75), protocol.num_samples);
  CHECK(scores.thresholds[0].precision == Approx(0.25).margin(share_margin));
  CHECK(scores.thresholds[0].recall == Approx(0.25).margin(share_margin));
}

TEST_CASE("a mesh against itself has no distance and F1 1") {
  const TriangleMesh mesh = sphere(1, 40);
  const MeshScores scores = mesh_scores(mesh, mesh, protocol_of());
  CHECK(scores.chamfer_m < kRounding);
  CHECK(scores.thresholds[0].f1 == 1);
  CHECK(*scores.normal_consistency == Approx(1).margin(1e-3));  // samples on edges take either face
}

TEST_CASE("point to point has a floor that exact distances have not") {
  const TriangleMesh mesh = unit_square(0);
  MeshProtocol protocol = protocol_of(10'000);
  protocol.distance = SurfaceDistance::kPointToPoint;
  const double floor = mesh_scores(mesh, mesh, protocol).chamfer_m;
  // Two independent samplings of one square metre: 0.5 / sqrt(density) = 5 mm.
  CHECK(floor == Approx(0.005).epsilon(0.05));
}

TEST_CASE("values do not depend on how finely a surface is cut") {
  const TriangleMesh reference = parallelogram({0, 0, 0}, {0.96f, 0, 0.28f}, {0, 1, 0});
  TriangleMesh uneven = parallelogram({0, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}, 60, 60);
  append(uneven, parallelogram({0.5f, 0, 0}, {0.5f, 0, 0}, {0, 1, 0}));
  const MeshProtocol protocol = protocol_of(100'000);
  const MeshScores coarse = mesh_scores(unit_square(0), reference, protocol);
  const MeshScores fine = mesh_scores(uneven, reference, protocol);
  const double margin = 2 * sampling_margin(0.28 / std::sqrt(12.0), protocol.num_samples);
  CHECK(fine.accuracy.mean_m == Approx(coarse.accuracy.mean_m).margin(margin));
  CHECK(fine.completeness.mean_m == Approx(coarse.completeness.mean_m).margin(1e-9));
  for (std::size_t i = 0; i < coarse.thresholds.size(); ++i)
    CHECK(
        fine.thresholds[i].f1 ==
        Approx(coarse.thresholds[i].f1).margin(2 * sampling_margin(0.5, protocol.num_samples))
    );
}

TEST_CASE("a part that is missing costs recall, a part too much precision") {
  TriangleMesh both = unit_square(0);
  append(both, parallelogram({5, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const MeshProtocol protocol = protocol_of();
  const MeshScores missing = mesh_scores(unit_square(0), both, protocol);
  CHECK(missing.thresholds[0].precision == 1);
  CHECK(missing.thresholds[0].recall == Approx(0.5).margin(1e-4));  // stratified: to within one
  CHECK(missing.thresholds[0].f1 == Approx(2.0 / 3).margin(1e-4));
  const MeshScores too_much = mesh_scores(both, unit_square(0), protocol);
  CHECK(too_much.thresholds[0].precision == Approx(0.5).margin(1e-4));
  CHECK(too_much.thresholds[0].recall == 1);
}

TEST_CASE("distances beyond the largest are set to it and counted") {
  TriangleMesh both = unit_square(0);
  append(both, parallelogram({0, 0, 9}, {1, 0, 0}, {0, 1, 0}));
  MeshProtocol protocol = protocol_of();
  protocol.max_distance_m = 0.5;
  const MeshScores scores = mesh_scores(both, unit_square(0), protocol);
  CHECK(scores.accuracy.clipped == Approx(0.5).margin(1e-4));
  CHECK(scores.accuracy.mean_m == Approx(0.25).margin(1e-4));
  CHECK(scores.accuracy.max_m == 0.5);
  CHECK(scores.completeness.clipped == 0);
  CHECK(*scores.normal_consistency == Approx(1).margin(1e-6));  // of those that found a face
}

TEST_CASE("a point cloud is measured by its points") {
  SurfacePoints cloud;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 50; ++j)
      cloud.positions.push_back(
          {0.01f + 0.02f * static_cast<float>(i), 0.01f + 0.02f * static_cast<float>(j), 0.25f}
      );
  const MeshScores scores = mesh_scores(cloud, unit_square(0), protocol_of());
  CHECK(scores.accuracy.num_samples == 2500);
  CHECK(scores.accuracy.mean_m == Approx(0.25).margin(kRounding));
  // Half a cell's diagonal aside at most.
  CHECK(scores.completeness.max_m <= std::hypot(0.25, 0.01 * std::sqrt(2.0)) + kRounding);
  CHECK(scores.completeness.mean_m > 0.25);
  CHECK_FALSE(scores.normal_consistency.has_value());
}

TEST_CASE("F1 is 0 where precision and recall are, and a curve never falls") {
  const SurfaceDistances distances{{{0.5, 0.1, 0.3}, {}}, {{0.2, 0.2}, {}}};
  const std::vector<double> thresholds{0.05, 0.1, 0.2001, 0.4, 0.6};
  const std::vector<ThresholdScores> curve = f1_curve(distances, thresholds);
  CHECK(curve[0].f1 == 0);
  CHECK(curve[1].precision == 0);  // strictly nearer
  CHECK(curve[2].precision == Approx(1.0 / 3));
  CHECK(curve[2].recall == 1);
  CHECK(curve[2].f1 == Approx(0.5));
  CHECK(curve[4].f1 == 1);
  for (std::size_t i = 1; i < curve.size(); ++i) CHECK(curve[i].f1 >= curve[i - 1].f1);
}

TEST_CASE("one and two threads give the same bytes") {
  const TriangleMesh prediction = sphere(1, 50), reference = cube({0.1f, 0, 0}, 0.8f, 7);
  for (const SurfaceDistance kind :
       {SurfaceDistance::kPointToTriangle, SurfaceDistance::kPointToPoint}) {
    MeshProtocol protocol = protocol_of(60'000);
    protocol.distance = kind;
    const auto measure = [&](int threads) {
      set_num_threads(threads);
      const SurfaceDistances distances = surface_distances(prediction, reference, protocol);
      set_num_threads(0);
      return distances;
    };
    const SurfaceDistances one = measure(1), two = measure(2);
    CHECK(one.accuracy.distances == two.accuracy.distances);
    CHECK(one.accuracy.normal_cosines == two.accuracy.normal_cosines);
    CHECK(one.completeness.distances == two.completeness.distances);
    CHECK(one.completeness.normal_cosines == two.completeness.normal_cosines);
    CHECK(
        mesh_values(mesh_scores(one, protocol), protocol) ==
        mesh_values(mesh_scores(two, protocol), protocol)
    );
  }
}

TEST_CASE("nothing to sample, no samples and impossible thresholds are errors of their own") {
  const TriangleMesh empty;
  const MeshProtocol protocol = protocol_of();
  error_of(ExitCode::kBadPrediction, [&] { mesh_scores(empty, unit_square(0), protocol); });
  error_of(ExitCode::kBadReference, [&] { mesh_scores(unit_square(0), empty, protocol); });
  error_of(ExitCode::kBadPrediction, [&] {
    mesh_scores(SurfacePoints{}, unit_square(0), protocol);
  });
  error_of(ExitCode::kUsage, [&] { mesh_scores(unit_square(0), unit_square(0), protocol_of(0)); });
  MeshProtocol negative = protocol;
  negative.thresholds_m = {0.01, -0.02};
  error_of(ExitCode::kUsage, [&] { mesh_scores(unit_square(0), unit_square(0), negative); });
  MeshProtocol clipped = protocol;
  clipped.max_distance_m = std::nan("");
  error_of(ExitCode::kUsage, [&] { mesh_scores(unit_square(0), unit_square(0), clipped); });
}

TEST_CASE("a threshold stands there once, and none is above the largest distance") {
  const auto error = [](MeshProtocol protocol) {
    return error_of(ExitCode::kUsage, [&] { check_mesh_protocol(protocol); });
  };
  MeshProtocol protocol;
  protocol.max_distance_m = 0.07;
  CHECK_THAT(error(protocol), Catch::Contains("max_distance_m") && Catch::Contains("below 0.1 of"));
  protocol.max_distance_m = 0.1;  // what is cut off there is not strictly nearer
  check_mesh_protocol(protocol);
  protocol.thresholds_m = {0.01, 0.05, 0.01};
  CHECK_THAT(error(protocol), Catch::Contains("0.01 stands there twice (1cm)"));
}

TEST_CASE("values carry the ids that tables name, and the registry knows them") {
  MeshProtocol protocol = protocol_of(100);
  for (const auto& [id, value] :
       mesh_values(mesh_scores(unit_square(0), unit_square(0.1f), protocol), protocol)) {
    INFO(id << " " << value);
    REQUIRE(find_metric(id) != nullptr);
    CHECK(find_metric(id)->id == id);
  }
  CHECK(find_metric("mesh-f1@5cm")->direction == Direction::kHigherIsBetter);
  CHECK(find_metric("mesh-cd")->unit == "m");
  CHECK(find_metric("mesh-f1@10cm-p2p")->protocol["distance"] == "point-to-point");
  CHECK(find_metric("mesh-f1@7cm") == nullptr);
  protocol.thresholds_m = {0.005, 0.07};
  protocol.distance = SurfaceDistance::kPointToPoint;
  const auto values =
      mesh_values(mesh_scores(unit_square(0), unit_square(0.1f), protocol), protocol);
  CHECK(values[3].first == "mesh-f1@0.5cm-p2p");
  CHECK(values[6].first == "mesh-f1@7cm-p2p");
}

TEST_CASE("the protocol survives JSON") {
  MeshProtocol protocol;
  config_from_json(
      protocol, Json::parse(R"({"thresholds_m": [0.03], "distance": "point-to-point"})"), "test"
  );
  CHECK(protocol.thresholds_m == std::vector<double>{0.03});
  CHECK(protocol.distance == SurfaceDistance::kPointToPoint);
  CHECK(config_to_json(protocol)["cull"] == "cameras");
}

TEST_CASE("clouds of real surfaces agree with independent code") {
  const fs::path folder = "../shared/data/metric_pairs/mesh";
  if (!fs::exists(folder / "expected.json")) {
    WARN("skipped: " << folder << " is absent");
    return;
  }
  const Json expected = Json::parse(read_file(folder / "expected.json"));
  const auto cloud = [&](const char* name) {
    return SurfacePoints{read_point_ply(folder / name).positions, {}};
  };
  MeshProtocol protocol = protocol_of();
  protocol.thresholds_m = {0.005, 0.01, 0.02, 0.05};
  const MeshScores scores = mesh_scores(cloud("pred_points.ply"), cloud("gt_points.ply"), protocol);
  const auto value = [&](const char* key) { return Approx(expected[key].get<double>()); };
  CHECK(scores.accuracy.mean_m == value("accuracy_mean").epsilon(1e-9));
  CHECK(scores.completeness.mean_m == value("completeness_mean").epsilon(1e-9));
  CHECK(scores.chamfer_m == value("chamfer_mean_of_two").epsilon(1e-9));
  CHECK(scores.accuracy.rms_m == value("accuracy_rmse").epsilon(1e-9));
  CHECK(scores.accuracy.max_m == value("max_pred_to_gt").epsilon(1e-9));
  CHECK(scores.completeness.max_m == value("hausdorff").epsilon(1e-9));
  for (const ThresholdScores& at : scores.thresholds) {
    const Json& row = expected["f"][fmt::format("{:g}", at.threshold_m)];
    CHECK(at.precision == Approx(row["precision"].get<double>()).epsilon(1e-12));
    CHECK(at.recall == Approx(row["recall"].get<double>()).epsilon(1e-12));
    CHECK(at.f1 == Approx(row["f1"].get<double>()).epsilon(1e-12));
  }
  for (const auto& [name, area] : {std::pair{"gt.ply", "gt_area"}, {"pred.ply", "pred_area"}})
    CHECK(surface_area(read_mesh_ply(folder / name)) == value(area).epsilon(1e-6));
}

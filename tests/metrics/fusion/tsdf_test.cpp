// SPDX-License-Identifier: MIT
// Depth maps of spheres, whose surface is known.
#include "metrics/fusion/tsdf.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "metrics/fusion/tsdf_volume.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

struct Sphere {
  Vec3d center;
  double radius;
};

double depth_along(const Camera& camera, int x, int y, const std::vector<Sphere>& spheres) {
  const Vec3d ray = camera.ray_in_world(x + 0.5, y + 0.5), eye = camera.center();
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sphere& sphere : spheres) {
    const Vec3d offset = eye - sphere.center;
    const double a = dot(ray, ray), b = dot(ray, offset);
    const double discriminant = b * b - a * (dot(offset, offset) - sphere.radius * sphere.radius);
    if (discriminant > 0) nearest = std::min(nearest, (-b - std::sqrt(discriminant)) / a);
  }
  return std::isfinite(nearest) ? nearest : 0;
}

FusionView view_of(const std::vector<Sphere>& spheres, std::size_t index) {
  constexpr double kGoldenAngle = 2.399963229728653;
  const double up = 1 - (2 * static_cast<double>(index) + 1) / 12.0;
  const double angle = kGoldenAngle * static_cast<double>(index), out = std::sqrt(1 - up * up);
  const Vec3d eye = 2.5 * Vec3d{out * std::cos(angle), out * std::sin(angle), up};
  const Camera camera = look_at(eye, {0, 0, 0}, {0, 0.1, 1}, {96, 96}, 60);
  FusionView view{Image(96, 96, 1), Image(96, 96, 3), camera};
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      view.depth.at(x, y) = static_cast<float>(depth_along(camera, x, y, spheres));
      view.rgb.at(x, y, 0) = 1;
    }
  return view;
}

constexpr std::size_t kViews = 12;

FusionSource source_of(std::vector<Sphere> spheres) {
  return [spheres = std::move(spheres)](std::size_t index) { return view_of(spheres, index); };
}

TsdfOptions coarse() {
  TsdfOptions options;
  options.voxel = 0.04;
  return options;
}

Vec3d as_double(Vec3f v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

template <class F>
ExitCode code_of(F&& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.code();
  }
  return ExitCode::kSuccess;
}

const bool quiet = (set_quiet(true), true);

#define SKIP_WITHOUT_OPEN3D()                              \
  if (!has_tsdf_volume()) {                                \
    WARN("skipped: built without Open3D (libopen3d-dev)"); \
    return;                                                \
  }

}  // namespace

TEST_CASE("A fused sphere lies within half a voxel of itself, looks outwards and has its colour") {
  SKIP_WITHOUT_OPEN3D();
  TsdfReport report;
  const TriangleMesh mesh = fuse_depth(source_of({{{0, 0, 0}, 0.5}}), kViews, coarse(), &report);
  REQUIRE(mesh.faces.size() > 1000);
  double mean_error = 0;
  for (const Vec3f& vertex : mesh.vertices) {
    const double error = std::abs(length(as_double(vertex)) - 0.5);
    CHECK(error < 0.04);
    mean_error += error / static_cast<double>(mesh.vertices.size());
  }
  CHECK(mean_error < 0.01);
  std::size_t outwards = 0;
  for (const auto& [a, b, c] : mesh.faces) {
    const Vec3d p = as_double(mesh.vertices[static_cast<std::size_t>(a)]);
    const Vec3d q = as_double(mesh.vertices[static_cast<std::size_t>(b)]);
    const Vec3d r = as_double(mesh.vertices[static_cast<std::size_t>(c)]);
    outwards += dot(cross(q - p, r - p), p) > 0;
  }
  CHECK(static_cast<double>(outwards) > 0.99 * static_cast<double>(mesh.faces.size()));
  CHECK(mesh.colors.at(0).x == Approx(1).margin(0.01));
  CHECK(mesh.colors.at(0).y == Approx(0).margin(0.01));
  CHECK(report.num_views == kViews);
  CHECK(report.triangles == mesh.faces.size());
  CHECK(report.memory_mb > 1);
}

TEST_CASE("The same mesh comes out for any number of threads") {
  SKIP_WITHOUT_OPEN3D();
  const auto fuse = [](int threads) {
    set_num_threads(threads);
    return fuse_depth(source_of({{{0, 0, 0}, 0.5}}), kViews, coarse());
  };
  const TriangleMesh one = fuse(1), two = fuse(2);
  REQUIRE(one.faces == two.faces);
  for (std::size_t i = 0; i < one.vertices.size(); ++i)
    REQUIRE(length(as_double(one.vertices[i] - two.vertices[i])) == 0);
}

TEST_CASE("Pieces with few triangles are dropped and counted") {
  SKIP_WITHOUT_OPEN3D();
  TsdfOptions options = coarse();
  options.min_cluster = 1000;  // the large sphere has thousands, the small one hundreds
  TsdfReport report;
  const TriangleMesh mesh =
      fuse_depth(source_of({{{0, 0, 0}, 0.5}, {{0, 0, 1}, 0.08}}), kViews, options, &report);
  CHECK(report.dropped_clusters >= 1);
  CHECK(report.triangles < report.fused_triangles);
  for (const Vec3f& vertex : mesh.vertices) CHECK(vertex.z < 0.6f);
}

TEST_CASE("Depths outside the bounds or beyond the limit are left out") {
  SKIP_WITHOUT_OPEN3D();
  TsdfOptions upper = coarse();
  upper.bounds_min = {-1, -1, 0};
  upper.bounds_max = {1, 1, 1};
  // A voxel's cell may reach below the bounds as far as its depths are cut off.
  for (const Vec3f& v : fuse_depth(source_of({{{0, 0, 0}, 0.5}}), kViews, upper).vertices)
    CHECK(v.z > -0.17f);
  TsdfOptions near = coarse();
  near.max_depth = 1.9;
  CHECK(code_of([&] {
          fuse_depth(source_of({{{0, 0, 0}, 0.5}}), kViews, near);
        }) == ExitCode::kBadPrediction);
}

TEST_CASE("Fusion refuses what cannot be fused, before it takes memory") {
  SKIP_WITHOUT_OPEN3D();
  const FusionSource sphere = source_of({{{0, 0, 0}, 0.5}});
  TsdfOptions fine = coarse();
  fine.voxel = 0.0005;
  fine.max_memory_mb = 500;
  CHECK_THROWS_WITH(
      fuse_depth(sphere, kViews, fine), Catch::Contains("MB") && Catch::Contains("a voxel of")
  );
  TsdfOptions negative = coarse();
  negative.voxel = -1;
  CHECK(code_of([&] { fuse_depth(sphere, kViews, negative); }) == ExitCode::kUsage);
  CHECK(code_of([&] { fuse_depth(source_of({}), kViews, coarse()); }) == ExitCode::kBadPrediction);
  CHECK(code_of([&] { fuse_depth(sphere, 0, coarse()); }) == ExitCode::kBadPrediction);
  const FusionSource not_finite = [&](std::size_t index) {
    FusionView view = sphere(index);
    for (std::size_t i = 0; i < view.depth.num_pixels(); ++i)
      view.depth.data()[i] = std::numeric_limits<float>::quiet_NaN();
    return view;
  };
  CHECK(code_of([&] { fuse_depth(not_finite, kViews, coarse()); }) == ExitCode::kBadPrediction);
  const FusionSource cropped = [&](std::size_t index) {
    FusionView view = sphere(index);
    view.depth = Image(95, 96, 1);
    return view;
  };
  CHECK(code_of([&] { fuse_depth(cropped, kViews, coarse()); }) == ExitCode::kBadPrediction);
}

TEST_CASE("Each view is asked for twice, and opens the blocks it needs whichever comes first") {
  SKIP_WITHOUT_OPEN3D();
  // From either side, one with pixels four times as wide, of which more have to open blocks.
  const auto view_from = [](double x, int width) {
    FusionView view{
        Image(width, width, 1), {}, look_at({x, 0, 0}, {0, 0, 0}, {0, 0, 1}, {width, width}, 60)};
    for (int j = 0; j < width; ++j)
      for (int i = 0; i < width; ++i)
        view.depth.at(i, j) =
            static_cast<float>(depth_along(view.camera, i, j, {{{0, 0, 0}, 0.5}}));
    return view;
  };
  TsdfOptions options = coarse();
  options.voxel = 0.01;
  const auto megabytes = [&](std::size_t first) {
    std::array<int, 2> asked{};
    const FusionSource source = [&](std::size_t index) {
      ++asked[index];
      return index == first ? view_from(2.5, 96) : view_from(-2.5, 24);
    };
    TsdfReport report;
    fuse_depth(source, 2, options, &report);
    CHECK(asked == std::array<int, 2>{2, 2});
    return report.memory_mb;
  };
  CHECK(megabytes(0) == megabytes(1));
}

TEST_CASE("Pieces are found in meshes that are not manifold") {
  TriangleMesh mesh;
  mesh.vertices = {
      {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}};
  // Three faces on one edge, one of them twice, a face without area, and a lone one.
  mesh.faces = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {2, 1, 0}, {0, 0, 1}, {5, 6, 7}};
  ClusterCount count;
  const TriangleMesh all = keep_large_clusters(mesh, 1, &count);
  CHECK(all.faces.size() == 4);
  CHECK(count.dropped == 0);
  CHECK(keep_large_clusters(mesh, 5).faces.empty());
}

TEST_CASE("Options that would take all memory are refused at once") {
  const auto nothing = [](std::size_t) { return FusionView{}; };
  const auto error_with = [&](auto&& change) {
    TsdfOptions options;
    change(options);
    return test::error_of(ExitCode::kUsage, [&] { fuse_depth(nothing, 1, options); });
  };
  CHECK_THAT(
      error_with([](TsdfOptions& o) { o.truncation_voxels = 1e9; }),
      Catch::Contains("truncation_voxels is 1000000000") && Catch::Contains("1 to 100")
  );
  CHECK_THAT(
      error_with([](TsdfOptions& o) { o.max_memory_mb = std::nan(""); }),
      Catch::Contains("max_memory_mb is nan")
  );
}

TEST_CASE("Fusion takes the memory that it announces, within a fifth") {
  SKIP_WITHOUT_OPEN3D();
  const FusionSource source = source_of({{{0, 0, 0}, 0.5}});
  fuse_depth(source, kViews, coarse());  // the module is loaded, and its memory counted
  TsdfOptions options;
  options.voxel = 0.004;
  options.min_cluster = 0;
  reset_peak_memory();
  const double before = peak_memory_mb();
  TsdfReport report;
  fuse_depth(source, kViews, options, &report);
  const double taken = peak_memory_mb() - before;
  INFO(report.memory_mb << " MB announced, " << taken << " MB taken");
  CHECK(report.memory_mb > 200);
  if (!test::kMemoryIsOurs) return;
  CHECK(taken < 1.2 * report.memory_mb);
  CHECK(taken > 0.8 * report.memory_mb);
}

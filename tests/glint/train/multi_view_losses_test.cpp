// SPDX-License-Identifier: MIT
// Against the same formulas written with cameras and matrices, in double, and their differences.
#include "glint/train/multi_view_losses.h"

#include "glint/train/multi_view_kernels.h"
#include "tests/support/check_vjp.h"
#include "tests/support/two_views.h"

using namespace glint;
using namespace glint::test;

namespace {

double bilinear_at(const ImageD& image, double x, double y) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const int i = static_cast<int>(left), j = static_cast<int>(top);
  const double u = x - 0.5 - left, v = y - 0.5 - top;
  return (1 - u) * (1 - v) * image.at(i, j) + u * (1 - v) * image.at(i + 1, j) +
         (1 - u) * v * image.at(i, j + 1) + u * v * image.at(i + 1, j + 1);
}
bool between_centers(const Camera& camera, Vec2d p) {
  return p.x >= 0.5 && p.y >= 0.5 && p.x < camera.width - 0.5 && p.y < camera.height - 0.5;
}

// Pixels that a pixel lands from itself; negative: it is not seen there.
double error_at(const TwoViews& views, const ImageD& depth, const ImageD& other, int x, int y) {
  const Vec3d world =
      views.reference.to_world(depth.at(x, y) * views.reference.ray_in_cam(x + 0.5, y + 0.5));
  const Vec2d seen = views.neighbor.project(views.neighbor.to_cam(world));
  if (!between_centers(views.neighbor, seen)) return -1;
  const double z = bilinear_at(other, seen.x, seen.y);
  const Vec3d moved = views.neighbor.to_world(z * views.neighbor.ray_in_cam(seen.x, seen.y));
  const Vec2d back = views.reference.project(views.reference.to_cam(moved));
  return std::hypot(back.x - x - 0.5, back.y - y - 0.5);
}

struct Reprojection {
  ImageD weight, dL_ddepth;
  FixedArray sums;
  CountedSum sum;

  Reprojection(const TwoViews& views, const ImageD& depth, const ImageD& other)
      : weight(depth.width(), depth.height(), 1),
        dL_ddepth(weight),
        sums(other.num_pixels(), 0),
        sum(sum_kernel(
            depth.size(),
            ReprojectionAt<double>{
                camera_pair<double>(views.reference, views.neighbor),
                depth,
                other,
                0.1,
                1.0,
                weight.ref(),
                dL_ddepth.ref(),
                FixedSums{sums.data()}}
        )) {}
};

// 1 - NCC^2 of the patch about (x, y), by the homography as a matrix; -1: it is not seen whole.
double dissimilarity_at(
    const TwoViews& views, const ImageD& gray, const ImageD& other, Vec3d n, double d, int x, int y
) {
  const auto inverse_intrinsics = [](const Camera& c) {
    return Mat3d{{{1 / c.fx, 0, -c.cx / c.fx}, {0, 1 / c.fy, -c.cy / c.fy}, {0, 0, 1}}};
  };
  const Camera &a = views.reference, &b = views.neighbor;
  const Mat3d rotation = b.rotation_cam_from_world * transpose(a.rotation_cam_from_world);
  const Vec3d t = b.translation_cam_from_world - rotation * a.translation_cam_from_world;
  Mat3d moved = rotation;
  for (int row = 0; row < 3; ++row) moved.rows[row] += (-t[row] / d) * n;
  const Mat3d intrinsics{{{b.fx, 0, b.cx}, {0, b.fy, b.cy}, {0, 0, 1}}};
  const Mat3d homography = intrinsics * moved * inverse_intrinsics(a);
  std::vector<double> p, q;
  for (int j = y - 3; j <= y + 3; ++j)
    for (int i = x - 3; i <= x + 3; ++i) {
      if (i < 0 || j < 0 || i >= a.width || j >= a.height) return -1;
      const Vec3d h = homography * Vec3d{i + 0.5, j + 0.5, 1};
      const Vec2d seen{h.x / h.z, h.y / h.z};
      if (!between_centers(b, seen)) return -1;
      p.push_back(gray.at(i, j));
      q.push_back(bilinear_at(other, seen.x, seen.y));
    }
  double mean_p = 0, mean_q = 0, pp = 0, qq = 0, pq = 0;
  for (std::size_t k = 0; k < p.size(); ++k) mean_p += p[k] / 49, mean_q += q[k] / 49;
  for (std::size_t k = 0; k < p.size(); ++k) {
    pp += (p[k] - mean_p) * (p[k] - mean_p);
    qq += (q[k] - mean_q) * (q[k] - mean_q);
    pq += (p[k] - mean_p) * (q[k] - mean_q);
  }
  return std::clamp(1 - pq * pq / (pp * qq + 1e-8), 0.0, 2.0);
}

struct Patches {
  ImageD dL_dnormal, dL_ddistance;
  CountedSum sum;

  Patches(const TwoViews& views, const ImageD& normal, const ImageD& distance, const ImageD& weight)
      : Patches(views, normal, distance, weight, views.photo(false), views.photo(true)) {}
  Patches(
      const TwoViews& views,
      const ImageD& normal,
      const ImageD& distance,
      const ImageD& weight,
      const Image& gray,
      const Image& other
  )
      : dL_dnormal(normal), dL_ddistance(distance) {
    const PixelSample all;
    sum = sum_kernel(
        distance.size(),
        PatchSimilarityAt<double>{
            camera_pair<double>(views.reference, views.neighbor),
            gray,
            other,
            normal,
            distance,
            weight,
            &all,
            0.9,
            dL_dnormal.ref(),
            dL_ddistance.ref()}
    );
  }
};

struct LossMaps {
  Image dL_ddepth, dL_dother, dL_dnormal, dL_ddistance;
  MultiViewTerms terms;
  explicit LossMaps(ImageSize s)
      : dL_ddepth(s.width, s.height, 1),
        dL_dother(dL_ddepth),
        dL_dnormal(s.width, s.height, 3),
        dL_ddistance(dL_ddepth) {}
};
LossMaps evaluated(
    const TwoViews& views, double noise, MultiViewLosses losses = {}, std::uint32_t seed = 1
) {
  const ImageSize size = views.reference.size();
  LossMaps out(size);
  const Image depth = with_noise(views.depth<float>(false), noise, 1);
  const Image other = with_noise(views.depth<float>(true), noise, 2);
  const Image gray = views.photo(false), other_gray = views.photo(true);
  Image normal, distance;
  views.planes(normal, distance, 3 * noise);
  out.terms = losses.evaluate(
      {views.reference, depth, gray},
      {views.neighbor, other, other_gray},
      normal,
      distance,
      {},
      seed,
      out.dL_ddepth,
      out.dL_dother,
      out.dL_dnormal,
      out.dL_ddistance
  );
  return out;
}

}  // namespace

TEST_CASE("A plane seen by both views has no reprojection error and alike patches") {
  const LossMaps maps = evaluated(TwoViews(), 0);
  CHECK(maps.terms.num_pixels > 150);
  CHECK(maps.terms.num_patches > 60);
  CHECK(maps.terms.geometric < 2e-3);    // what bilinear depth leaves
  CHECK(maps.terms.photometric < 2e-2);  // what bilinear photos leave
}

TEST_CASE("Reprojection errors, weights and gradients of both depth maps are the formula's") {
  const TwoViews views;
  const ImageD depth = with_noise(views.depth<double>(false), 0.03, 1);
  const ImageD other = with_noise(views.depth<double>(true), 0.03, 2);
  const Reprojection result(views, depth, other);
  double sum = 0, count = 0;
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const double error = error_at(views, depth, other, x, y);
      const bool counts = error >= 0 && error < 1;
      CHECK(result.weight.at(x, y) == Approx(counts ? std::exp(-error) : 0.0).margin(1e-12));
      if (!counts) continue;
      sum += std::exp(-error) * error;
      ++count;
    }
  CHECK(count > 100);
  CHECK(result.sum.count == count);
  CHECK(result.sum.sum == Approx(sum).epsilon(1e-10));

  const auto loss = [&](const std::vector<ImageD>& maps) {
    double total = 0;
    for (int j = 0; j < depth.height(); ++j)
      for (int i = 0; i < depth.width(); ++i)
        if (result.weight.at(i, j) > 0)
          total += result.weight.at(i, j) * error_at(views, maps[0], maps[1], i, j);
    return total;
  };
  ImageD dL_dother = other;
  for (std::size_t i = 0; i < other.num_pixels(); ++i)
    dL_dother.data()[i] = static_cast<double>(result.sums[i]) / FixedSums::kScale;
  const GradientError error =
      gradient_error_of(loss, {depth, other}, {result.dL_ddepth, dL_dother});
  INFO("largest difference at " << error.worst_index << " of 2 x " << depth.num_pixels());
  CHECK(error.norm > 1);
  CHECK(error.distance < 1e-6 * error.norm);
}

TEST_CASE("Patch dissimilarities and their gradients are those of the homography") {
  const TwoViews views;
  ImageD normal, distance;
  views.planes(normal, distance, 0.1);
  const ImageD weight = random_map<double>(distance.size(), 1, 0.3f, 1, 4);
  const ImageD gray = in_double(views.photo(false)), other = in_double(views.photo(true));
  const Patches result(views, normal, distance, weight);
  const auto dissimilarity = [&](const ImageD& n, const ImageD& d, int x, int y) {
    const Vec3d here{n.at(x, y, 0), n.at(x, y, 1), n.at(x, y, 2)};
    return dissimilarity_at(views, gray, other, here, d.at(x, y), x, y);
  };
  MaskImage counts(distance.width(), distance.height(), 1);
  double sum = 0, count = 0;
  for (int y = 0; y < distance.height(); ++y)
    for (int x = 0; x < distance.width(); ++x) {
      const double c = dissimilarity(normal, distance, x, y);
      if (c < 0 || c >= 0.9) continue;
      counts.at(x, y) = 1;
      sum += weight.at(x, y) * c;
      ++count;
    }
  CHECK(count > 60);
  CHECK(result.sum.count == count);
  CHECK(result.sum.sum == Approx(sum).epsilon(1e-9));

  const auto loss = [&](const std::vector<ImageD>& maps) {
    double total = 0;
    for (int j = 0; j < distance.height(); ++j)
      for (int i = 0; i < distance.width(); ++i)
        if (counts.at(i, j) != 0) total += weight.at(i, j) * dissimilarity(maps[0], maps[1], i, j);
    return total;
  };
  const GradientError error =
      gradient_error_of(loss, {normal, distance}, {result.dL_dnormal, result.dL_ddistance}, 1e-7);
  INFO("largest difference at " << error.worst_index << " of 4 x " << distance.num_pixels());
  CHECK(error.norm > 1);
  CHECK(error.distance < 1e-5 * error.norm);
}

TEST_CASE("Patches are compared whatever their gain, offset and sign") {
  Rng rng(2);
  PatchSums<double> alike, inverted, flat;
  for (int k = 0; k < kPatchPixels; ++k) {
    const double a = static_cast<double>(rng.uniform(-1, 1));
    alike.add(a, 0.2 * a + 7, {});
    inverted.add(a, 3 - 2 * a, {});
    flat.add(a, 0.5, {});
  }
  CHECK(patch_dissimilarity(alike) == Approx(0).margin(1e-8));
  CHECK(patch_dissimilarity(inverted) == Approx(0).margin(1e-8));
  CHECK(patch_dissimilarity(flat) == Approx(1).margin(1e-8));
}

TEST_CASE("Both terms are means over the pixels that count, and gradients carry the weights") {
  const TwoViews views;
  const LossMaps maps = evaluated(views, 0.03);
  const ImageD depth = in_double(with_noise(views.depth<float>(false), 0.03, 1));
  const ImageD other = in_double(with_noise(views.depth<float>(true), 0.03, 2));
  const Reprojection geometric(views, depth, other);
  CHECK(maps.terms.geometric == Approx(geometric.sum.mean()).epsilon(1e-4));
  const MultiViewWeights weights;
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const double scale = static_cast<double>(weights.geometric) / geometric.sum.count;
    CHECK(
        static_cast<double>(maps.dL_ddepth.data()[i]) ==
        Approx(scale * geometric.dL_ddepth.data()[i]).epsilon(1e-2).margin(1e-6)
    );
    CHECK(
        static_cast<double>(maps.dL_dother.data()[i]) ==
        Approx(scale * static_cast<double>(geometric.sums[i]) / FixedSums::kScale)
            .epsilon(1e-2)
            .margin(1e-6)
    );
  }
  Image normal, distance;
  views.planes(normal, distance, 0.09);
  const Patches patches(views, in_double(normal), in_double(distance), geometric.weight);
  CHECK(maps.terms.photometric == Approx(patches.sum.mean()).epsilon(1e-3));
  const double scale = static_cast<double>(weights.photometric) / patches.sum.count;
  for (std::size_t i = 0; i < normal.values().size(); ++i)
    CHECK(
        static_cast<double>(maps.dL_dnormal.data()[i]) ==
        Approx(scale * patches.dL_dnormal.data()[i]).epsilon(1e-2).margin(1e-5)
    );
}

TEST_CASE("Two evaluations with one object give the same bytes, with any number of threads") {
  const TwoViews views;
  const auto run = [&] { return evaluated(views, 0.03); };
  const LossMaps one = with_threads(1, run);
  for (const int threads : {2, 5}) {
    const LossMaps again = with_threads(threads, run);
    CHECK(same_bytes(one.dL_ddepth, again.dL_ddepth));
    CHECK(same_bytes(one.dL_dother, again.dL_dother));
    CHECK(same_bytes(one.dL_dnormal, again.dL_dnormal));
    CHECK(one.terms.geometric == again.terms.geometric);
  }
}

TEST_CASE("Of many pixels a share of the patches is drawn, the same for a seed") {
  const TwoViews views({96, 72});
  const auto drawn = [&](std::size_t most, std::uint32_t seed) {
    MultiViewLosses losses;
    losses.settings.max_patches = most;
    return evaluated(views, 0, std::move(losses), seed).terms;
  };
  const MultiViewTerms all = drawn(100000, 1);
  const double wanted = all.num_pixels / 4;
  const MultiViewTerms few = drawn(static_cast<std::size_t>(wanted), 1);
  CHECK(few.num_patches == Approx(all.num_patches / 4).epsilon(0.15));
  CHECK(drawn(static_cast<std::size_t>(wanted), 1).photometric == few.photometric);
  CHECK(drawn(static_cast<std::size_t>(wanted), 2).photometric != few.photometric);
}

TEST_CASE("Views that see nothing in common have no loss and no gradient") {
  TwoViews views;
  views.neighbor = look_at({50, 50, 50}, {60, 60, 60}, {0, 0, 1}, views.reference.size(), 60);
  const LossMaps maps = evaluated(views, 0.03);
  CHECK(maps.terms.num_pixels == 0);
  CHECK(maps.terms.geometric == 0);
  for (const float g : maps.dL_ddepth.values()) CHECK(g == 0.0f);
  for (const float g : maps.dL_dnormal.values()) CHECK(g == 0.0f);
}

TEST_CASE("Each step of a reprojection has the gradient of its differences") {
  const TwoViews views;
  const auto pair = camera_pair<double>(views.reference, views.neighbor);
  const Vec3d p{0.3, -0.2, 2.1};
  check_formula(
      [&](Vec3d x) { return pair.neighbor.project(x); },
      [&](Vec3d x, Vec2d g, Vec3d& dL_dp) { pair.neighbor.project_vjp(x, g, dL_dp); },
      p
  );
  check_formula(
      [&](Vec3d x, double z) { return moved_to_depth(pair, x, z); },
      [&](Vec3d x, double z, Vec3d g, Vec3d& dL_dp, double& dL_dz) {
        moved_to_depth_vjp(pair, x, z, g, dL_dp, dL_dz);
      },
      p,
      1.7
  );
  const Vec2d at{3.5, 3.5};
  check_formula(
      [&](Vec2d a) { return pixel_distance(a, at); },
      [&](Vec2d a, double g, Vec2d& dL_da) { pixel_distance_vjp(a, at, g, dL_da); },
      Vec2d{3.2, 4.1}
  );
}

TEST_CASE("The gray of a colour weighs green most") {
  const Image gray = gray_of(map_of<float>(3, 1, 3, {1, 0, 0, 0, 1, 0, 1, 1, 1}));
  CHECK(gray.at(0, 0) == Approx(0.299f));
  CHECK(gray.at(1, 0) == Approx(0.587f));
  CHECK(gray.at(2, 0) == Approx(1.0f));
}

TEST_CASE("Patches with a pixel that does not count, here or there, are not compared") {
  const TwoViews views;
  const Image counted = map_of<float>(3, 1, 1, {1, 0, 1});
  const Image gray = gray_of({Image(3, 1, 3, 0.5f), counted});
  CHECK(gray.at(0, 0) == Approx(0.5f));
  CHECK(gray.at(1, 0) == kNoGray);
  Image normal, distance;
  views.planes(normal, distance, 0);
  const ImageD weight(distance.width(), distance.height(), 1, 1.0);
  const auto patches = [&](const Image& here, const Image& there) {
    return Patches(views, in_double(normal), in_double(distance), weight, here, there);
  };
  const Image here = views.photo(false), there = views.photo(true);
  const Patches all = patches(here, there);
  const int x = here.width() / 2, y = here.height() / 2;
  REQUIRE(all.sum.count > 60);
  Image masked = here;
  masked.at(x, y) = kNoGray;
  const Patches less = patches(masked, there);
  CHECK(less.sum.count < all.sum.count);
  CHECK(less.sum.count >= all.sum.count - kPatchPixels);
  for (int j = y - kPatchRadius; j <= y + kPatchRadius; ++j)
    for (int i = x - kPatchRadius; i <= x + kPatchRadius; ++i)
      CHECK(less.dL_ddistance.at(i, j) == 0.0);
  masked = there;
  masked.at(x, y) = kNoGray;
  const double count = patches(here, masked).sum.count;
  CHECK(count < all.sum.count);
  CHECK(count > 0);
}

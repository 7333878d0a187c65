// SPDX-License-Identifier: MIT
// What two views say about each other's planes, reference pixel by reference pixel
// (multi_view_losses.h). Gradients are written without the loss's weight, which is known only after
// the pixels that count are: AddScaled and AddFixed bring it in.
#pragma once

#include "glint/core/fixed_sum.h"
#include "glint/core/kernel.h"
#include "glint/render/pinhole.h"
#include "glint/train/bilinear.h"
#include "glint/train/patch_ncc.h"
#include "glint/train/pixel_access.h"
#include "glint/train/reprojection.h"

namespace glint {

// Sum over the pixels that count, and their number.
struct CountedSum {
  double sum = 0, count = 0;
  GLINT_HD CountedSum& operator+=(const CountedSum& o) {
    sum += o.sum;
    count += o.count;
    return *this;
  }
  double mean() const { return count == 0 ? 0.0 : sum / count; }
};

// w e of each reference pixel, with e the reprojection error and w = exp(-e) held constant.
template <class T>
struct ReprojectionAt {
  CameraPair<T> pair;
  BasicImageView<T> depth, neighbor_depth;  // [H][W][1] metres, 0: none
  T min_z, max_error;                       // metres, pixels
  BasicImageRef<T> weight;       // [H][W][1] written: w, 0 where the pixel does not count
  BasicImageRef<T> dL_ddepth;    // [H][W][1] written
  FixedSums dL_dneighbor_depth;  // [H][W] added to

  struct Path {
    Vec3<T> in_neighbor, in_reference;
    BilinearCell<T> cell;
    BilinearSample<T> there;
    T error = -1;  // negative: does not count
  };
  GLINT_HD Path path_of(int x, int y) const {
    Path path;
    const T z = depth.at(x, y);
    if (!(z > T(0))) return path;
    path.in_neighbor = pair.to_neighbor(z * pair.reference.ray(x, y));
    if (!(path.in_neighbor.z > min_z)) return path;
    path.cell = bilinear_cell(neighbor_depth.size(), pair.neighbor.project(path.in_neighbor));
    if (!path.cell.inside || !all_have_depth(path.cell)) return path;
    path.there = bilinear(neighbor_depth, path.cell);
    path.in_reference = moved_to_depth(pair, path.in_neighbor, path.there.value);
    if (!(path.in_reference.z > min_z)) return path;
    const T error = pixel_distance(pair.reference.project(path.in_reference), center(x, y));
    if (error < max_error) path.error = error;
    return path;
  }
  GLINT_HD CountedSum operator()(int x, int y) const {
    const Path path = path_of(x, y);
    const bool counts = path.error >= T(0);
    const T w = counts ? exp_fast(-path.error) : T(0);
    weight.at(x, y) = w;
    dL_ddepth.at(x, y) = counts ? back(path, x, y, w) : T(0);
    if (!counts) return {};
    return {static_cast<double>(w * path.error), 1.0};
  }

 private:
  GLINT_HD static Vec2<T> center(int x, int y) { return {T(x) + T(0.5), T(y) + T(0.5)}; }
  GLINT_HD bool all_have_depth(const BilinearCell<T>& cell) const {
    for (int corner = 0; corner < 4; ++corner)
      if (!(neighbor_depth.at(cell.x + corner % 2, cell.y + corner / 2) > T(0))) return false;
    return true;
  }
  // dL/d(depth) of the reference; the neighbour's goes to the four pixels.
  GLINT_HD T back(const Path& path, int x, int y, T dL_derror) const {
    Vec2<T> dL_dlanded{};
    pixel_distance_vjp(
        pair.reference.project(path.in_reference), center(x, y), dL_derror, dL_dlanded
    );
    Vec3<T> dL_din_reference{}, dL_din_neighbor{};
    pair.reference.project_vjp(path.in_reference, dL_dlanded, dL_din_reference);
    T dL_dthere = 0;
    moved_to_depth_vjp(
        pair, path.in_neighbor, path.there.value, dL_din_reference, dL_din_neighbor, dL_dthere
    );
    pair.neighbor.project_vjp(path.in_neighbor, dL_dthere * path.there.slope, dL_din_neighbor);
    for (int corner = 0; corner < 4; ++corner)
      dL_dneighbor_depth.add(
          neighbor_depth.offset(path.cell.x + corner % 2, path.cell.y + corner / 2),
          static_cast<double>(path.cell.weight(corner) * dL_dthere)
      );
    return dot(transpose_times(pair.rotation, dL_din_neighbor), pair.reference.ray(x, y));
  }
};

// A share of the pixels of an image, the same for a seed.
struct PixelSample {
  std::uint32_t seed = 0;
  std::uint32_t below = 0xffffffffu;  // of 2^32: the share; the largest: all pixels

  GLINT_HD bool takes(std::uint32_t pixel) const {
    if (below == 0xffffffffu) return true;
    std::uint32_t h = pixel ^ seed;  // finaliser of MurmurHash3 [Appleby 2011]
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return (h ^ (h >> 16)) < below;
  }
};

// Of a pixel that does not count: what is interpolated from it is negative, too.
inline constexpr float kNoGray = -1e30f;

// w c of each sampled reference pixel with w > 0 and c < max_dissimilarity: c compares the patch
// around it with the neighbour's, found by the homography of the pixel's plane n.p = -d,
// H = K_n (R - t n^T / d) K_r^-1 [Chen24 Eq. 11]: the ray r of a patch pixel is the neighbour's
// point R r + t s, s = -(n.r) / d its inverse depth.
template <class T>
struct PatchSimilarityAt {
  CameraPair<T> pair;
  ImageView gray, neighbor_gray;               // [H][W][1]
  BasicImageView<T> normal, distance, weight;  // [H][W][3], [H][W][1] metres, [H][W][1] w
  const PixelSample* sample;
  T max_dissimilarity;
  BasicImageRef<T> dL_dnormal, dL_ddistance;  // written

  GLINT_HD CountedSum operator()(int x, int y) const {
    Vec3<T> dL_dn{};
    T dL_dd = 0;
    const CountedSum result = at(x, y, dL_dn, dL_dd);
    store3(dL_dnormal, x, y, dL_dn);
    dL_ddistance.at(x, y) = dL_dd;
    return result;
  }

 private:
  GLINT_HD bool counts(int x, int y) const {
    return weight.at(x, y) > T(0) && distance.at(x, y) > T(0) && x >= kPatchRadius &&
           y >= kPatchRadius && x + kPatchRadius < gray.width && y + kPatchRadius < gray.height &&
           sample->takes(static_cast<std::uint32_t>(y * gray.width + x));
  }
  GLINT_HD CountedSum at(int x, int y, Vec3<T>& dL_dn, T& dL_dd) const {
    PatchSums<T> sums;
    if (!counts(x, y)) return {};
    const T d = distance.at(x, y);
    const Vec3<T> m = (T(1) / d) * load3<T>(normal, x, y);
    if (!compare(x, y, m, sums)) return {};
    const T c = patch_dissimilarity(sums), w = weight.at(x, y);
    if (!(c < max_dissimilarity)) return {};
    Vec3<T> dL_dm{};
    patch_dissimilarity_vjp(sums, w, dL_dm);
    dL_dn = (T(1) / d) * dL_dm;
    dL_dd = -dot(dL_dm, m) / d;
    return {static_cast<double>(w * c), 1.0};
  }
  // False: a pixel of the patch is not in the neighbour's image, or does not count in one of them.
  // Deviation: published patches see black beyond it.
  GLINT_HD bool compare(int x, int y, Vec3<T> m, PatchSums<T>& sums) const {
    const T center = T(gray.at(x, y));
    for (int j = y - kPatchRadius; j <= y + kPatchRadius; ++j)
      for (int i = x - kPatchRadius; i <= x + kPatchRadius; ++i) {
        const Vec3<T> ray = pair.reference.ray(i, j);
        const Vec3<T> there = pair.rotation * ray + (-dot(m, ray)) * pair.translation;
        if (!(there.z > T(1e-6f))) return false;
        const auto cell = bilinear_cell(neighbor_gray.size(), pair.neighbor.project(there));
        if (!cell.inside) return false;
        const BilinearSample<T> seen = bilinear<T>(neighbor_gray, cell);
        if (gray.at(i, j) < 0 || seen.value < T(0)) return false;
        Vec3<T> dseen_dthere{};
        pair.neighbor.project_vjp(there, seen.slope, dseen_dthere);
        const T dseen_ds = dot(dseen_dthere, pair.translation);
        sums.add(T(gray.at(i, j)) - center, seen.value - center, (-dseen_ds) * ray);
      }
    return true;
  }
};

// About so many of the pixels that count.
struct SampleOf {
  const CountedSum* counted;
  std::size_t wanted;
  std::uint32_t seed;
  PixelSample* sample;
  GLINT_HD void operator()(std::size_t) const {
    *sample = {seed};
    if (counted->count > static_cast<double>(wanted))
      sample->below =
          static_cast<std::uint32_t>(4294967296.0 * static_cast<double>(wanted) / counted->count);
  }
};

struct AddScaled {
  const float* values;
  const double* scale;
  float* out;
  GLINT_HD void operator()(std::size_t i) const {
    out[i] += static_cast<float>(*scale) * values[i];
  }
};
struct AddFixed {
  FixedSums values;
  const double* scale;
  float* out;
  GLINT_HD void operator()(std::size_t i) const {
    out[i] += static_cast<float>(*scale * values.take(i));
  }
};

using MultiViewKernels =
    KernelList<ReprojectionAt<float>, PatchSimilarityAt<float>, SampleOf, AddScaled, AddFixed>;

}  // namespace glint

// SPDX-License-Identifier: MIT
// A map of features over all directions with mip levels [Ref-GS "Sph-Mip"]: the look-up of a
// direction at a roughness, level by level, each formula with its vjp.
//
// Level 0 has `height` rows (0: north pole, z = 1) of 2 height texels (longitude from x towards y);
// each further level is the mean of 2x2, down to two rows. The centre of texel (i, j) is at
// u = (i + 0.5) / width, v = (j + 0.5) / height; longitude wraps, latitude is clamped.
#pragma once

#include <cstdint>

#include "glint/core/vec.h"

namespace glint {

GLINT_HD float atan2_of(float y, float x) { return atan2f(y, x); }
GLINT_HD double atan2_of(double y, double x) { return atan2(y, x); }
GLINT_HD float acos_of(float x) { return acosf(x); }
GLINT_HD double acos_of(double x) { return acos(x); }
GLINT_HD float floor_of(float x) { return floorf(x); }
GLINT_HD double floor_of(double x) { return floor(x); }

// (u, v) = (phi / 2 pi in [0, 1), acos z / pi) of a unit direction.
template <class T>
GLINT_HD Vec2<T> lat_long(Vec3<T> d) {
  const T turn = atan2_of(d.y, d.x) * T(0.15915494309189535);
  const T u = turn < T(0) ? turn + T(1) : turn;
  return {
      u < T(1) ? u : T(0),  // -0 plus one turn, rounded
      acos_of(min_of(max_of(d.z, T(-1)), T(1))) * T(0.3183098861837907)};
}
// The slopes grow without bound towards the poles; nearer than 1e-3 rad they stay as they are
// there.
inline constexpr double kPoleSine2 = 1e-6;
template <class T>
GLINT_HD void lat_long_vjp(Vec3<T> d, Vec2<T> dL_duv, Vec3<T>& dL_dd) {
  const T sine2 = max_of(d.x * d.x + d.y * d.y, T(kPoleSine2));
  const T along = dL_duv.x * T(0.15915494309189535) / sine2;
  dL_dd.x -= along * d.y;
  dL_dd.y += along * d.x;
  dL_dd.z -= dL_duv.y * T(0.3183098861837907) / sqrt_of(sine2);
}

// The levels of a map in one array, level 0 first, each [rows][2 rows][channels].
struct MapShape {
  int height = 0, channels = 0, levels = 0;

  // Down to two rows: floor(log2(height)) levels, at least one.
  GLINT_HD static int levels_of(int height) {
    int levels = 1;
    while ((height >> (levels + 1)) > 0) ++levels;
    return levels;
  }
  GLINT_HD int rows(int level) const { return height >> level; }
  GLINT_HD std::size_t num_texels(int level) const {
    const auto r = static_cast<std::size_t>(rows(level));
    return 2 * r * r;
  }
  // Where a level begins, in texels; `levels`: how many there are in all.
  GLINT_HD std::size_t first_texel(int level) const {
    std::size_t count = 0;
    for (int l = 0; l < level; ++l) count += num_texels(l);
    return count;
  }
};

// Where a look-up falls among a level's rows or columns: texels `first` and `second` with weights
// 1 - weight, weight; `slope`: d(weight)/d(coordinate), 0 where it is clamped.
template <class T>
struct MapTap {
  int first, second;
  T weight, slope;
};
template <class T>
GLINT_HD MapTap<T> wrapped_tap(T u, int width) {
  const T x = u * T(width) - T(0.5), at = floor_of(x);
  const int first = static_cast<int>(at);
  return {(first + width) % width, (first + 1) % width, x - at, T(width)};
}
template <class T>
GLINT_HD MapTap<T> clamped_tap(T v, int height) {
  const T y = v * T(height) - T(0.5);
  if (y <= T(0)) return {0, 0, T(0), T(0)};
  if (y >= T(height - 1)) return {height - 1, height - 1, T(0), T(0)};
  const T at = floor_of(y);
  const int first = static_cast<int>(at);
  return {first, first + 1 < height ? first + 1 : first, y - at, T(height)};
}

// A look-up at one level.
template <class T>
struct LevelTap {
  MapTap<T> column, row;
  int level;

  GLINT_HD static LevelTap at(const MapShape& shape, int level, Vec2<T> uv) {
    const int rows = shape.rows(level);
    return {wrapped_tap(uv.x, 2 * rows), clamped_tap(uv.y, rows), level};
  }
  GLINT_HD std::size_t texel(const MapShape& shape, int row_index, int column_index) const {
    return shape.first_texel(level) +
           static_cast<std::size_t>(row_index) * static_cast<std::size_t>(2 * shape.rows(level)) +
           static_cast<std::size_t>(column_index);
  }
};

// The four texels of a tap in one channel.
template <class T>
struct TapTexels {
  T v00, v01, v10, v11;  // row, column

  template <class S>
  GLINT_HD static TapTexels load(
      const S* texels, const MapShape& shape, const LevelTap<T>& tap, int channel
  ) {
    const auto value = [&](int row, int column) {
      const std::size_t at = tap.texel(shape, row, column);
      return T(
          texels[at * static_cast<std::size_t>(shape.channels) + static_cast<std::size_t>(channel)]
      );
    };
    return {
        value(tap.row.first, tap.column.first),
        value(tap.row.first, tap.column.second),
        value(tap.row.second, tap.column.first),
        value(tap.row.second, tap.column.second)};
  }
};

template <class T>
GLINT_HD T bilinear(const TapTexels<T>& t, T row, T column) {
  const T top = t.v00 + column * (t.v01 - t.v00), bottom = t.v10 + column * (t.v11 - t.v10);
  return top + row * (bottom - top);
}
// dL/d(row, column weight), added.
template <class T>
GLINT_HD void bilinear_vjp(
    const TapTexels<T>& t, T row, T column, T dL_dvalue, T& dL_drow, T& dL_dcolumn
) {
  const T top = t.v00 + column * (t.v01 - t.v00), bottom = t.v10 + column * (t.v11 - t.v10);
  dL_drow += dL_dvalue * (bottom - top);
  dL_dcolumn += dL_dvalue * ((T(1) - row) * (t.v01 - t.v00) + row * (t.v11 - t.v10));
}

// Roughness to level: level = levels * roughness, at most levels - 1 (of the published map: 9
// roughness, at most 8). Between `first` and the next level by `weight`; `slope`:
// d(level)/d(roughness), 0 where it is clamped.
template <class T>
struct LevelChoice {
  int first;
  T weight, slope;
};
template <class T>
GLINT_HD LevelChoice<T> level_of_roughness(T roughness, int levels) {
  const T level = T(levels) * roughness, last = T(levels - 1);
  if (!(level > T(0))) return {0, T(0), T(0)};
  if (level >= last) return {levels - 1, T(0), T(0)};
  const T at = floor_of(level);
  return {static_cast<int>(at), level - at, T(levels)};
}

// The look-up of one direction. For its gradient with respect to texels see
// spherical_map_kernels.h.
template <class T>
struct MapLookup {
  Vec2<T> uv;
  LevelChoice<T> level;
  LevelTap<T> fine, coarse;  // the same where there is no coarser one

  GLINT_HD static MapLookup of(const MapShape& shape, Vec3<T> direction, T roughness) {
    const Vec2<T> uv = lat_long(direction);
    const LevelChoice<T> level = level_of_roughness(roughness, shape.levels);
    const int next = level.first + 1 < shape.levels ? level.first + 1 : level.first;
    return {uv, level, LevelTap<T>::at(shape, level.first, uv), LevelTap<T>::at(shape, next, uv)};
  }
};
template <class T, class S>
GLINT_HD T map_value(const S* texels, const MapShape& shape, const MapLookup<T>& at, int channel) {
  const auto value = [&](const LevelTap<T>& tap) {
    return bilinear(
        TapTexels<T>::load(texels, shape, tap, channel), tap.row.weight, tap.column.weight
    );
  };
  const T fine = value(at.fine);
  return fine + at.level.weight * (value(at.coarse) - fine);
}
// dL/d(u, v, level) of one channel's value, added.
template <class T, class S>
GLINT_HD void map_value_vjp(
    const S* texels,
    const MapShape& shape,
    const MapLookup<T>& at,
    int channel,
    T dL_dvalue,
    Vec2<T>& dL_duv,
    T& dL_dlevel
) {
  T values[2] = {};
  const LevelTap<T>* taps[2] = {&at.fine, &at.coarse};
  const T weights[2] = {T(1) - at.level.weight, at.level.weight};
  for (int i = 0; i < 2; ++i) {
    const MapTap<T>&row = taps[i]->row, &column = taps[i]->column;
    const auto t = TapTexels<T>::load(texels, shape, *taps[i], channel);
    values[i] = bilinear(t, row.weight, column.weight);
    T dL_drow(0), dL_dcolumn(0);
    bilinear_vjp(t, row.weight, column.weight, weights[i] * dL_dvalue, dL_drow, dL_dcolumn);
    dL_duv.x += dL_dcolumn * column.slope;
    dL_duv.y += dL_drow * row.slope;
  }
  dL_dlevel += dL_dvalue * (values[1] - values[0]);
}

}  // namespace glint

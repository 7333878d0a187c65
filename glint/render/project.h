// SPDX-License-Identifier: MIT
// A surfel on the screen of one camera: its plane map in pixels, exact bounds, camera-facing
// normal, with vjps [Huang24 Sec. 4]. Screen quantities are relative to a reference point (x_ref,
// y_ref), the projected centre where that exists: it keeps float precision for small distant
// surfels.
#pragma once

#include "glint/render/activations.h"
#include "glint/render/blend.h"
#include "glint/render/intersect.h"

namespace glint {

template <class T>
struct CameraOf {
  Mat3<T> rotation;     // camera from world
  Vec3<T> translation;  // metres
  T fx, fy, cx, cy;     // pixels
  T width, height;      // pixels
  T near_plane;         // metres
};

template <class T>
struct SurfelGeometry {
  Vec3<T> mean;
  Vec2<T> scale;
  Vec4<T> rotation;
};

// The surfel in camera space.
template <class T>
struct SurfelInCam {
  Vec3<T> h0, h1, m;  // scaled tangents and centre, metres
  Vec3<T> normal;     // unit, facing the camera
  T facing;           // +1 or -1: sign applied to the surfel's own normal
};
template <class T>
GLINT_HD SurfelInCam<T> surfel_in_cam(const SurfelGeometry<T>& s, const CameraOf<T>& camera) {
  const Mat3<T> r = camera.rotation * rotation_matrix(s.rotation);
  const Vec3<T> m = camera.rotation * s.mean + camera.translation;
  const Vec3<T> n = column(r, 2);
  const T facing = select(dot(n, m) > T(0), T(-1), T(1));
  return {s.scale.x * column(r, 0), s.scale.y * column(r, 1), m, facing * n, facing};
}
template <class T>
GLINT_HD void surfel_in_cam_vjp(
    const SurfelGeometry<T>& s,
    const CameraOf<T>& camera,
    T facing,
    const SurfelInCam<T>& dL_dcam,
    SurfelGeometry<T>& dL_dsurfel
) {
  const Mat3<T> r = rotation_matrix(s.rotation);
  const Vec3<T> ga = transpose_times(camera.rotation, dL_dcam.h0);
  const Vec3<T> gb = transpose_times(camera.rotation, dL_dcam.h1);
  const Vec3<T> gn = facing * transpose_times(camera.rotation, dL_dcam.normal);
  dL_dsurfel.mean += transpose_times(camera.rotation, dL_dcam.m);
  dL_dsurfel.scale.x += dot(ga, column(r, 0));
  dL_dsurfel.scale.y += dot(gb, column(r, 1));
  const Mat3<T> dL_dr = transpose(Mat3<T>{{s.scale.x * ga, s.scale.y * gb, gn}});
  rotation_matrix_vjp(s.rotation, dL_dr, dL_dsurfel.rotation);
}

// zeta of intersect() at pixel offset (X, Y) from the reference point: gx X + gy Y + g0.
template <class T>
struct PixelPlaneMap {
  Vec3<T> gx, gy, g0;
  T det;
};
template <class T>
GLINT_HD Vec3<T> zeta_at(const PixelPlaneMap<T>& map, T x, T y) {
  return {
      fma_of(map.gx.x, x, fma_of(map.gy.x, y, map.g0.x)),
      fma_of(map.gx.y, x, fma_of(map.gy.y, y, map.g0.y)),
      fma_of(map.gx.z, x, fma_of(map.gy.z, y, map.g0.z))};
}

template <class T>
struct ProjectedSurfel {
  T x_ref, y_ref;  // pixels
  PixelPlaneMap<T> map;
  T center_x, center_y;  // low-pass centre, relative to the reference point; far away: no low-pass
  T z_center;            // camera depth of the centre, metres
  Vec3<T> normal;        // facing the camera
  T plane_distance;      // of its plane from the camera centre, metres: -(n.m) >= 0
  T box_min_x, box_max_x, box_min_y, box_max_y;  // pixels, absolute; empty (min > max): invisible
};

// Rows of K H over (u, v, 1), relative to the reference point.
template <class T>
struct ScreenRows {
  Vec3<T> x, y, z;
};
template <class T>
GLINT_HD ScreenRows<T> screen_rows(
    const SurfelInCam<T>& s, const CameraOf<T>& camera, T x_ref, T y_ref
) {
  const Vec3<T> hx{s.h0.x, s.h1.x, s.m.x}, hy{s.h0.y, s.h1.y, s.m.y}, hz{s.h0.z, s.h1.z, s.m.z};
  return {camera.fx * hx + (camera.cx - x_ref) * hz, camera.fy * hy + (camera.cy - y_ref) * hz, hz};
}

// Exact bounding box of the projected ellipse u^2 + v^2 = k2 along one axis, relative to the
// reference point (gaussian_methods: f = (k2, k2, -1)/D). Valid for D < 0 only.
template <class T>
struct ScreenInterval {
  T center, half;
};
template <class T>
GLINT_HD T screen_box_d(Vec3<T> row_z, T k2) {
  return fma_of(k2, fma_of(row_z.x, row_z.x, row_z.y * row_z.y), -(row_z.z * row_z.z));
}
template <class T>
GLINT_HD ScreenInterval<T> screen_interval(Vec3<T> row, Vec3<T> row_z, T k2, T d) {
  const Vec3<T> f{k2 / d, k2 / d, T(-1) / d};
  const T center = dot(hadamard(f, row), row_z);
  return {center, sqrt_of(max_of(center * center - dot(hadamard(f, row), row), T(0)))};
}
// vjp of the two centres together (they share D).
template <class T>
GLINT_HD void screen_center_vjp(
    const ScreenRows<T>& rows, T k2, T dL_dcx, T dL_dcy, ScreenRows<T>& dL_drows
) {
  const T d = screen_box_d(rows.z, k2);
  const Vec3<T> k{k2, k2, T(-1)};
  const Vec3<T> f = (T(1) / d) * k;
  const T cx = dot(hadamard(f, rows.x), rows.z), cy = dot(hadamard(f, rows.y), rows.z);
  const T dL_dd = -(dL_dcx * cx + dL_dcy * cy) / d;
  dL_drows.x += dL_dcx * hadamard(f, rows.z);
  dL_drows.y += dL_dcy * hadamard(f, rows.z);
  dL_drows.z += dL_dcx * hadamard(f, rows.x) + dL_dcy * hadamard(f, rows.y) +
                (T(2) * dL_dd) * hadamard(k, rows.z);
}

// Offset that switches the low-pass off: its rho2 is then larger than any rho3 that counts.
inline constexpr float kNoLowPass = 1e15f;

// The 3-sigma ellipse stays clear of the camera plane: its screen box exists.
template <class T>
GLINT_HD Mask<T> has_screen_box(Vec3<T> row_z) {
  return screen_box_d(row_z, T(kMaxRho)) < T(0);
}

// Reference point and the ray direction through it (camera space, z = 1).
template <class T>
struct ReferencePoint {
  T x, y;
  Vec3<T> direction;
};
template <class T>
GLINT_HD ReferencePoint<T> reference_point(Vec3<T> m, Mask<T> projects, const CameraOf<T>& camera) {
  const T inverse = T(1) / select(projects, m.z, T(1));
  const Vec3<T> direction{
      select(projects, m.x * inverse, T(0)), select(projects, m.y * inverse, T(0)), T(1)};
  return {
      fma_of(camera.fx, direction.x, camera.cx),
      fma_of(camera.fy, direction.y, camera.cy),
      direction};
}

// The plane map restricted to the pixel grid: directions d = d_ref + (X/fx, Y/fy, 0).
template <class T>
GLINT_HD PixelPlaneMap<T> pixel_plane_map(
    const PlaneMap<T>& map, Vec3<T> d_ref, Mask<T> projects, const CameraOf<T>& camera
) {
  const T ix = T(1) / camera.fx, iy = T(1) / camera.fy;
  // At the projected centre u = v = 0 exactly: no cancellation error.
  const T g0x = select(projects, T(0), dot(map.e1, d_ref));
  const T g0y = select(projects, T(0), dot(map.e2, d_ref));
  return {
      {map.e1.x * ix, map.e2.x * ix, map.e3.x * ix},
      {map.e1.y * iy, map.e2.y * iy, map.e3.y * iy},
      {g0x, g0y, dot(map.e3, d_ref)},
      map.det};
}
template <class T>
GLINT_HD PlaneMap<T> pixel_plane_map_vjp(
    const PixelPlaneMap<T>& g, Vec3<T> d_ref, const CameraOf<T>& camera
) {
  const T ix = T(1) / camera.fx, iy = T(1) / camera.fy;
  const auto pull = [&](T gx, T gy, T g0) { return g0 * d_ref + Vec3<T>{gx * ix, gy * iy, T(0)}; };
  return {
      pull(g.gx.x, g.gy.x, g.g0.x),
      pull(g.gx.y, g.gy.y, g.g0.y),
      pull(g.gx.z, g.gy.z, g.g0.z),
      g.det};
}

// Interval of X / Z over X in [x_low, x_high], Z in [z_low, z_high], z_low > 0.
template <class T>
struct RatioInterval {
  T low, high;
};
template <class T>
GLINT_HD RatioInterval<T> ratio_interval(T x_low, T x_high, T z_low, T z_high) {
  const T near = T(1) / z_low, far = T(1) / max_of(z_low, z_high);
  return {min_of(x_low * near, x_low * far), max_of(x_high * near, x_high * far)};
}

// Screen box of everything that can contribute. Where the 3-sigma ellipse stays clear of the camera
// plane: the exact box at the radius where alpha falls below 1/255, and the low-pass disc.
// Otherwise: bounds of the part in front of the near plane, from the ellipse's box in camera space.
template <class T>
GLINT_HD void screen_box(
    const SurfelInCam<T>& s,
    const ScreenRows<T>& rows,
    const CameraOf<T>& camera,
    T max_rho,
    Mask<T> boxed,
    ProjectedSurfel<T>& p
) {
  const T d = screen_box_d(rows.z, max_rho);
  const ScreenInterval<T> x = screen_interval(rows.x, rows.z, max_rho, d);
  const ScreenInterval<T> y = screen_interval(rows.y, rows.z, max_rho, d);
  const T low_pass = sqrt_of(T(0.5f) * max_rho);  // sigma = sqrt(2)/2 pixel
  const T margin(0.01f);                          // pixels; rounding of float positions
  const auto reach = [&](int axis) {
    return T(3) * sqrt_of(fma_of(s.h0[axis], s.h0[axis], s.h1[axis] * s.h1[axis]));
  };
  const T z_high = s.m.z + reach(2);
  const auto cut_x = ratio_interval(s.m.x - reach(0), s.m.x + reach(0), camera.near_plane, z_high);
  const auto cut_y = ratio_interval(s.m.y - reach(1), s.m.y + reach(1), camera.near_plane, z_high);
  const T x_min = p.x_ref + min_of(x.center - x.half, p.center_x - low_pass);
  const T x_max = p.x_ref + max_of(x.center + x.half, p.center_x + low_pass);
  const T y_min = p.y_ref + min_of(y.center - y.half, p.center_y - low_pass);
  const T y_max = p.y_ref + max_of(y.center + y.half, p.center_y + low_pass);
  p.box_min_x = select(boxed, x_min, fma_of(camera.fx, cut_x.low, camera.cx)) - margin;
  p.box_max_x = select(boxed, x_max, fma_of(camera.fx, cut_x.high, camera.cx)) + margin;
  p.box_min_y = select(boxed, y_min, fma_of(camera.fy, cut_y.low, camera.cy)) - margin;
  p.box_max_y = select(boxed, y_max, fma_of(camera.fy, cut_y.high, camera.cy)) + margin;
}

// max_rho: squared radius in sigma beyond which alpha < 1/255, at most kMaxRho (see max_rho_of).
template <class T>
GLINT_HD ProjectedSurfel<T> project_surfel(
    const SurfelGeometry<T>& surfel, const CameraOf<T>& camera, T max_rho
) {
  const SurfelInCam<T> s = surfel_in_cam(surfel, camera);
  const Vec3<T> row_z{s.h0.z, s.h1.z, s.m.z};
  const auto boxed = has_screen_box(row_z);
  // Deviation from the official kernels: a surfel whose centre lies behind the near plane is kept
  // as long as some of it lies in front.
  const T reach = T(3) * sqrt_of(fma_of(s.h0.z, s.h0.z, s.h1.z * s.h1.z));
  const auto in_front = s.m.z + reach > camera.near_plane;
  const auto projects = boxed & (s.m.z > T(0));
  const ReferencePoint<T> ref = reference_point(s.m, projects, camera);
  ProjectedSurfel<T> p;
  p.x_ref = ref.x;
  p.y_ref = ref.y;
  p.map = pixel_plane_map(plane_map(s.h0, s.h1, s.m), ref.direction, projects, camera);
  const ScreenRows<T> rows = screen_rows(s, camera, ref.x, ref.y);
  const T d = screen_box_d(rows.z, T(kMaxRho));
  p.center_x =
      select(projects, screen_interval(rows.x, rows.z, T(kMaxRho), d).center, T(kNoLowPass));
  p.center_y =
      select(projects, screen_interval(rows.y, rows.z, T(kMaxRho), d).center, T(kNoLowPass));
  p.z_center = s.m.z;
  p.normal = s.normal;
  p.plane_distance = -dot(s.normal, s.m);
  screen_box(s, rows, camera, max_rho, projects, p);
  p.box_min_x = select(in_front & (max_rho > T(0)), p.box_min_x, T(1e30f));
  return p;
}

// dL/d(image position of the centre) in NDC, the statistic of densification: through the centre
// only. z: its depth.
template <class T>
GLINT_HD Vec2<T> screen_gradient(Vec3<T> dL_dm, T z, const CameraOf<T>& c) {
  const T depth = max_of(z, c.near_plane);
  return {
      dL_dm.x * depth / c.fx * (T(0.5f) * c.width), dL_dm.y * depth / c.fy * (T(0.5f) * c.height)};
}

// Half the larger side of the 3-sigma ellipse's box on the screen, pixels. Where the ellipse meets
// the camera plane that box does not exist: then of the box of everything that can contribute.
template <class T>
GLINT_HD T screen_radius(const SurfelGeometry<T>& surfel, const CameraOf<T>& camera, T max_rho) {
  const ProjectedSurfel<T> p = project_surfel(surfel, camera, max_rho);
  const SurfelInCam<T> s = surfel_in_cam(surfel, camera);
  const ScreenRows<T> rows = screen_rows(s, camera, p.x_ref, p.y_ref);
  const T d = screen_box_d(rows.z, T(kMaxRho));
  const T of_ellipse = max_of(
      screen_interval(rows.x, rows.z, T(kMaxRho), d).half,
      screen_interval(rows.y, rows.z, T(kMaxRho), d).half
  );
  const T of_box = T(0.5f) * max_of(p.box_max_x - p.box_min_x, p.box_max_y - p.box_min_y);
  return select(has_screen_box(rows.z) & (s.m.z > T(0)), of_ellipse, of_box);
}

// dL/d(projected): map, low-pass centre, z_center, normal and plane_distance are set; the box has
// no gradient.
// dL_dm: dL/d(centre in camera space) as the screen-space statistic of densification counts it:
// through hits within the disc, as the kernels of [Huang24], and with `count_low_pass` through
// those of the low-pass, too, as where the low-pass is part of the footprint [Chen24]. What
// plane_distance says of the centre is in neither.
template <class T>
GLINT_HD void project_surfel_vjp(
    const SurfelGeometry<T>& surfel,
    const CameraOf<T>& camera,
    const ProjectedSurfel<T>& dL_dprojected,
    bool count_low_pass,
    SurfelGeometry<T>& dL_dsurfel,
    Vec3<T>& dL_dm
) {
  const SurfelInCam<T> s = surfel_in_cam(surfel, camera);
  const Vec3<T> row_z{s.h0.z, s.h1.z, s.m.z};
  const auto projects = has_screen_box(row_z) & (s.m.z > T(0));
  const ReferencePoint<T> ref = reference_point(s.m, projects, camera);
  const PlaneMap<T> dL_dmap = pixel_plane_map_vjp(dL_dprojected.map, ref.direction, camera);
  SurfelInCam<T> g{};
  plane_map_vjp(s.h0, s.h1, s.m, dL_dmap, g.h0, g.h1, g.m);
  dL_dm = g.m;

  const ScreenRows<T> rows = screen_rows(s, camera, ref.x, ref.y);
  ScreenRows<T> g_rows{};
  screen_center_vjp(
      rows,
      T(kMaxRho),
      select(projects, dL_dprojected.center_x, T(0)),
      select(projects, dL_dprojected.center_y, T(0)),
      g_rows
  );
  const Vec3<T> hz = (camera.cx - ref.x) * g_rows.x + (camera.cy - ref.y) * g_rows.y + g_rows.z;
  const auto pick = [&](int i) {
    return Vec3<T>{camera.fx * g_rows.x[i], camera.fy * g_rows.y[i], hz[i]};
  };
  // Lanes without a screen box hold meaningless rows: they have no low-pass and no gradient from
  // it.
  const Vec3<T> zero{T(0), T(0), T(0)};
  g.h0 += select<T>(projects, pick(0), zero);
  g.h1 += select<T>(projects, pick(1), zero);
  const Vec3<T> of_low_pass = select<T>(projects, pick(2), zero);
  g.m += of_low_pass;
  if (count_low_pass) dL_dm += of_low_pass;
  g.m.z += dL_dprojected.z_center;
  g.normal = dL_dprojected.normal - dL_dprojected.plane_distance * s.m;
  g.m += -dL_dprojected.plane_distance * s.normal;
  surfel_in_cam_vjp(surfel, camera, s.facing, g, dL_dsurfel);
}

}  // namespace glint

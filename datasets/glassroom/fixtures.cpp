// SPDX-License-Identifier: MIT
#include "datasets/glassroom/fixtures.h"

#include <utility>

namespace glint {

namespace {

void put(Furniture& fixture, TraceMesh mesh, Finish finish, const Pose& pose = {}) {
  transform(mesh, pose);
  scale_uvs(mesh, finish.periods_per_metre);
  fixture.push_back({std::move(mesh), finish.material});
}

void add_curtains(
    Furniture& f, const FixturePalette& fixtures, float half, float width, float high
) {
  for (const float side : {-1.0f, 1.0f})
    put(f,
        curtain_mesh(width, high - 0.02f, 4, 0.07f),
        fixtures.curtain,
        translated({side * (half + 0.5f * width), 0.085f, 0.1f}));
}

}  // namespace

Furniture make_window(const Palette& p, const FixturePalette& fixtures, Rng& rng) {
  const float half = rng.uniform(0.6f, 0.75f), low = rng.uniform(0.3f, 0.5f), high = 2.25f;
  constexpr float kCurtain = 0.34f;
  Furniture f;
  const float row = (high - low) / kWindowRows;
  for (int i = 0; i < kWindowRows; ++i)
    f.push_back(
        {quad_mesh(
             {half, 0.01f, low + row * static_cast<float>(i)}, {-2 * half, 0, 0}, {0, 0, row}
         ),
         fixtures.window_rows[static_cast<std::size_t>(i)]}
    );
  TraceMesh frame;
  for (const float x : {-half - 0.05f, -0.025f, half})
    append(frame, box_mesh({x, 0.001f, low}, {x + 0.05f, 0.06f, high}));
  for (const float z : {low - 0.05f, 0.5f * (low + high), high})
    append(frame, box_mesh({-half - 0.05f, 0.001f, z}, {half + 0.05f, 0.06f, z + 0.05f}));
  append(frame, box_mesh({-half - 0.1f, 0.001f, low - 0.08f}, {half + 0.1f, 0.16f, low - 0.05f}));
  put(f, std::move(frame), p.paint);
  add_curtains(f, fixtures, half, kCurtain, high);
  put(f,
      box_mesh({-half - kCurtain, 0.1f, high + 0.08f}, {half + kCurtain, 0.13f, high + 0.11f}),
      p.brass);
  return f;
}

Furniture make_door(const Palette& p) {
  constexpr float kHalf = 0.44f, kHeight = 2.05f, kFrame = 0.08f;
  TraceMesh leaf = box_mesh({-kHalf, 0.001f, 0}, {kHalf, 0.025f, kHeight}), frame, panels;
  for (const float x : {-0.36f, 0.05f})
    for (const float z : {0.2f, 1.1f})
      append(panels, box_mesh({x, 0.025f, z}, {x + 0.31f, 0.037f, z + 0.75f}));
  for (const float x : {-kHalf - kFrame, kHalf})
    append(frame, box_mesh({x, 0.001f, 0}, {x + kFrame, 0.05f, kHeight}));
  append(
      frame, box_mesh({-kHalf - kFrame, 0.001f, kHeight}, {kHalf + kFrame, 0.05f, kHeight + kFrame})
  );
  Furniture f;
  put(f, std::move(leaf), p.wood);
  put(f, std::move(panels), p.dark_wood);
  put(f, std::move(frame), p.paint);
  put(f, sphere_mesh(0.03f, 16), p.brass, translated({0.37f, 0.06f, 1.0f}));
  return f;
}

Furniture make_picture(const Palette& p, int canvas, float x, float z) {
  constexpr float kRim = 0.03f, kDepth = 0.035f;
  // Seen from the room, u grows to the right: towards -x of the wall's frame.
  TraceMesh picture = quad_mesh({x, 0.03f, kRim - z}, {-2 * x, 0, 0}, {0, 0, 2 * (z - kRim)});
  picture.uvs = {{0.01f, 0.01f}, {0.99f, 0.01f}, {0.99f, 0.99f}, {0.01f, 0.99f}};
  TraceMesh frame;
  for (const float side : {-x - kRim, x})
    append(frame, box_mesh({side, 0.001f, -z}, {side + kRim, kDepth, z}));
  for (const float side : {-z, z - kRim})
    append(frame, box_mesh({-x, 0.001f, side}, {x, kDepth, side + kRim}));
  Furniture f;
  f.push_back({std::move(picture), canvas});
  put(f, std::move(frame), p.dark_wood);
  return f;
}

Furniture make_mirror(const Palette& p, int mirror, float x, float low, float high) {
  constexpr float kRim = 0.05f, kDepth = 0.04f;
  Furniture f;
  f.push_back({quad_mesh({x, 0.025f, low}, {-2 * x, 0, 0}, {0, 0, high - low}), mirror});
  TraceMesh frame;
  for (const float side : {-x - kRim, x})
    append(frame, box_mesh({side, 0.001f, low - kRim}, {side + kRim, kDepth, high + kRim}));
  for (const float side : {low - kRim, high})
    append(frame, box_mesh({-x, 0.001f, side}, {x, kDepth, side + kRim}));
  append(frame, box_mesh({-x, 0.001f, low}, {x, 0.02f, high}));  // its back
  put(f, std::move(frame), p.brass);
  return f;
}

Furniture make_shop_window(const Palette& p, int glass, float x, float height) {
  constexpr float kBeam = kShopWindowBeam, kHalf = 0.5f * kBeam;
  Furniture f;
  f.push_back({quad_mesh({-x, 0, kBeam}, {2 * x, 0, 0}, {0, 0, height - 2 * kBeam}), glass});
  TraceMesh frame;
  for (const float side : {-x - kBeam, x})
    append(frame, box_mesh({side, -kHalf, 0}, {side + kBeam, kHalf, height}));
  for (const float side : {0.0f, height - kBeam})
    append(frame, box_mesh({-x, -kHalf, side}, {x, kHalf, side + kBeam}));
  put(f, std::move(frame), p.black);
  return f;
}

Furniture make_ceiling_light(const Palette& p, const FixturePalette& fixtures, float half) {
  const float outer = half + 0.04f, depth = 0.04f;
  TraceMesh frame;
  append(frame, box_mesh({-outer, -outer, -depth}, {outer, -half, 0}));
  append(frame, box_mesh({-outer, half, -depth}, {outer, outer, 0}));
  append(frame, box_mesh({-outer, -half, -depth}, {-half, half, 0}));
  append(frame, box_mesh({half, -half, -depth}, {outer, half, 0}));
  Furniture f;
  f.push_back(
      {quad_mesh({-half, half, -0.5f * depth}, {2 * half, 0, 0}, {0, -2 * half, 0}),
       fixtures.ceiling_light}
  );
  put(f, std::move(frame), p.metal);
  return f;
}

}  // namespace glint

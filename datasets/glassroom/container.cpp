// SPDX-License-Identifier: MIT
#include "datasets/glassroom/container.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/glassroom/patterns.h"
#include "glint/core/error.h"

namespace glint {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFrameRoughness = 0.25f;

Pose rotated_x90(Vec3f translation) {
  return {.rotation = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}}, .translation = translation};
}

// The whole mesh as one convex piece.
void add_hull(ContainerObject& object, const TraceMesh& part, const Pose& pose = {}) {
  std::vector<Vec3f> points;
  for (const Vec3f vertex : part.vertices) points.push_back(pose.apply(vertex));
  object.hulls.push_back(std::move(points));
}

void add_convex(ContainerObject& object, const TraceMesh& part, const Pose& pose = {}) {
  append(object.mesh, part, pose);
  add_hull(object, part, pose);
}

// A profile that is not convex collides as a stack of truncated cones.
void add_lathe(ContainerObject& object, std::span<const Vec2f> profile, float shift) {
  append(object.mesh, lathe_mesh(profile, 40), translated({0, 0, shift}));
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    if (std::abs(profile[i].y - profile[i + 1].y) > 1e-4f)
      add_hull(object, lathe_mesh(profile.subspan(i, 2), 16), translated({0, 0, shift}));
}

void add_ring(ContainerObject& object, float ring, float tube, const Pose& pose = {}) {
  append(object.mesh, torus_mesh(ring, tube, 48, 20), pose);
  constexpr int kPieces = 14, kSides = 10;
  for (int i = 0; i < kPieces; ++i) {
    std::vector<Vec3f> piece;
    for (int end = 0; end < 2; ++end)
      for (int j = 0; j < kSides; ++j) {
        const float a = 2 * kPi * static_cast<float>(i + end) / kPieces;
        const float b = 2 * kPi * static_cast<float>(j) / kSides;
        const float r = ring + tube * std::cos(b);
        piece.push_back(pose.apply({r * std::cos(a), r * std::sin(a), tube * std::sin(b)}));
      }
    object.hulls.push_back(std::move(piece));
  }
}

ContainerObject ball(float size) {
  ContainerObject object{.name = "ball"};
  add_convex(object, sphere_mesh(0.5f * size, 32));
  return object;
}

ContainerObject block(float size) {
  ContainerObject object{.name = "block"};
  const Vec3f half{0.42f * size, 0.3f * size, 0.36f * size};
  add_convex(object, box_mesh(-half, half));
  return object;
}

ContainerObject cone(float size) {
  ContainerObject object{.name = "cone"};
  add_convex(object, cone_mesh(0.4f * size, size, 40), translated({0, 0, -0.25f * size}));
  return object;
}

ContainerObject ring(float size) {
  ContainerObject object{.name = "ring"};
  add_ring(object, 0.36f * size, 0.14f * size);
  return object;
}

ContainerObject drum(float size) {
  ContainerObject object{.name = "drum"};
  add_convex(
      object, cylinder_mesh(0.34f * size, 0.7f * size, 40), translated({0, 0, -0.35f * size})
  );
  return object;
}

ContainerObject vase(float size) {
  ContainerObject object{.name = "vase"};
  std::vector<Vec2f> profile{{0, 0}};
  for (int i = 0; i <= 12; ++i) {
    const float s = static_cast<float>(i) / 12;
    const float radius = 0.16f + 0.2f * std::sin(kPi * std::pow(s, 0.8f)) + 0.06f * s * s;
    profile.push_back({radius * size, 1.1f * s * size});
  }
  profile.push_back({0, 1.1f * size});
  add_lathe(object, profile, -0.45f * size);
  return object;
}

ContainerObject teapot(float size) {
  ContainerObject object{.name = "teapot"};
  const float r = 0.38f * size, h = 0.6f * size, shift = -0.4f * h;
  std::vector<Vec2f> profile{{0, 0}};
  for (int i = 0; i <= 10; ++i) {
    const float s = static_cast<float>(i) / 10;
    profile.push_back({r * (0.55f + 0.45f * std::sin(kPi * (0.12f + 0.72f * s))), s * h});
  }
  profile.insert(
      profile.end(),
      {{0.5f * r, 1.08f * h}, {0.12f * r, 1.14f * h}, {0.16f * r, 1.28f * h}, {0, 1.3f * h}}
  );
  add_lathe(object, profile, shift);
  const std::array<Vec3f, 3> spout{
      Vec3f{0.75f * r, 0, 0.35f * h + shift},
      {1.25f * r, 0, 0.6f * h + shift},
      {1.5f * r, 0, 0.95f * h + shift}};
  add_convex(object, tube_mesh(spout, std::array<float, 3>{0.2f * r, 0.14f * r, 0.09f * r}, 16));
  add_ring(object, 0.34f * r, 0.08f * r, rotated_x90({-1.1f * r, 0, 0.55f * h + shift}));
  return object;
}

ContainerObject dumbbell(float size) {
  ContainerObject object{.name = "dumbbell"};
  add_convex(object, sphere_mesh(0.25f * size, 28), translated({0, 0, -0.3f * size}));
  add_convex(object, sphere_mesh(0.2f * size, 28), translated({0, 0, 0.3f * size}));
  add_convex(
      object, cylinder_mesh(0.08f * size, 0.6f * size, 20), translated({0, 0, -0.3f * size})
  );
  return object;
}

// Origin to the middle of the bounds: the start places are found by bounding spheres.
void center(ContainerObject& object) {
  const Vec3f middle = bounds_of(object.mesh).center();
  transform(object.mesh, translated(-middle));
  for (std::vector<Vec3f>& hull : object.hulls)
    for (Vec3f& point : hull) point = point - middle;
}

using Maker = ContainerObject (*)(float);
constexpr std::array<Maker, 8> kMakers{teapot, ball, cone, ring, vase, block, drum, dumbbell};

Material object_material(
    TraceScene& scene, const std::string& name, std::size_t index, std::size_t first_color, Rng& rng
) {
  constexpr std::array<std::uint32_t, 8> kColors{
      0xD6452F, 0x2F6FB5, 0xE3B02F, 0x3C9A5F, 0x8E4FA8, 0xE07FA0, 0x2FA8A0, 0xE8E0D0};
  constexpr std::array kKinds{
      PatternKind::kBlocks,
      PatternKind::kPlain,
      PatternKind::kMarble,
      PatternKind::kTiles,
      PatternKind::kWaves};
  // Steps of three visit all eight main colours before one comes again.
  const auto color = [&](std::size_t k) {
    return srgb_hex(kColors[(first_color + 3 * index + k) % kColors.size()]);
  };
  Material material{.name = name, .roughness = rng.uniform(0.25f, 0.5f)};
  if (index == 3) {  // one thing of metal
    material.kind = MaterialKind::kRoughConductor;
    material.albedo = {0.8f, 0.62f, 0.36f};
    return material;
  }
  const bool glossy = index % 2 == 0;
  material.kind = glossy ? MaterialKind::kRoughPlastic : MaterialKind::kDiffuse;
  material.albedo = {1, 1, 1};
  const PatternSpec spec{
      .kind = kKinds[(index + rng.below(2)) % kKinds.size()],
      .colors = {color(0), color(3), color(5)},
      .seed = rng.next_u32()};
  material.texture = add_texture(scene, make_pattern(spec, 256));
  return material;
}

// A material for each tint.
std::array<int, 6> add_glass(TraceScene& scene, const ContainerShape& shape) {
  std::array<int, 6> glass{};
  for (std::size_t i = 0; i < glass.size(); ++i) {
    std::size_t same = 0;
    while (same < i && length2(shape.tints[same] - shape.tints[i]) > 0) ++same;
    glass[i] = same < i ? glass[same]
                        : add_material(
                              scene,
                              {.name = "glass",
                               .kind = MaterialKind::kThinDielectric,
                               .albedo = {1, 1, 1},
                               .ior = shape.glass_ior,
                               .tint = shape.tints[i]}
                          );
  }
  return glass;
}

}  // namespace

ContainerShape random_container(Rng& rng) {
  ContainerShape shape;
  shape.size = {
      0.6f * rng.uniform(2.0f, 2.4f),
      0.4f * rng.uniform(2.2f, 2.6f),
      0.6f * rng.uniform(2.1f, 2.5f)};
  return shape;
}

InnerCase random_inner_case(const ContainerShape& outer, int count, Rng& rng) {
  InnerCase inner;
  inner.shape.size = {
      0.55f * rng.uniform(0.95f, 1.08f),
      0.5f * rng.uniform(0.95f, 1.08f),
      0.72f * rng.uniform(0.9f, 1.1f)};
  inner.shape.beam = 0.018f;
  inner.objects = random_objects(inner.shape, count, rng);
  constexpr float kGap = 0.03f;  // to the outer frame
  const float reach = 0.5f * std::hypot(inner.shape.size.x, inner.shape.size.y);
  const float side = rng.uniform() < 0.5f ? -1.0f : 1.0f;
  const float x = 0.5f * outer.size.x - outer.beam - kGap - reach;
  const float floor = 0.5f * (outer.beam + outer.pane_thickness);
  inner.start =
      yawed(rng.uniform(-0.35f, 0.35f), {side * x, rng.uniform(-0.06f, 0.06f), floor + 0.003f});
  return inner;
}

std::array<Pane, 6> container_panes(const ContainerShape& shape) {
  const Vec3f half = 0.5f * shape.size;
  std::array<Pane, 6> panes{};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      Pane pane{
          .center = {0, 0, half.z},
          .half_size = half - Vec3f{shape.beam, shape.beam, shape.beam},
          .axis = axis};
      const float offset = half[axis] - 0.5f * shape.beam;
      pane.center[axis] += side == 0 ? -offset : offset;
      pane.half_size[axis] = 0.5f * shape.pane_thickness;
      panes[static_cast<std::size_t>(2 * axis + side)] = pane;
    }
  return panes;
}

std::array<Bounds, 12> container_beams(const ContainerShape& shape) {
  const Vec3f half = 0.5f * shape.size;
  std::array<Bounds, 12> beams{};
  std::size_t n = 0;
  // Beams along z run the full height; those along x and y end at them, so none overlap.
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        Bounds& beam = beams[n++];
        const float end = axis == 2 ? half[axis] : half[axis] - shape.beam;
        beam.low[axis] = -end;
        beam.high[axis] = end;
        for (int k : {b, c}) {
          const int side = k == b ? i : j;
          beam.low[k] = side == 0 ? -half[k] : half[k] - shape.beam;
          beam.high[k] = beam.low[k] + shape.beam;
        }
        beam.low.z += half.z;
        beam.high.z += half.z;
      }
  return beams;
}

std::vector<ContainerObject> random_objects(const ContainerShape& shape, int count, Rng& rng) {
  GLINT_CHECK(
      count >= 1 && count <= static_cast<int>(kMakers.size()),
      kUsage,
      "random_objects: {} objects, expected 1 to {}",
      count,
      kMakers.size()
  );
  const float base = 0.36f * std::min({shape.size.x, shape.size.y, shape.size.z});
  const std::size_t first = rng.below(kMakers.size());
  std::vector<ContainerObject> objects;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    // The first one is the centrepiece.
    const float size = base * (i == 0 ? rng.uniform(1.5f, 1.7f) : rng.uniform(0.85f, 1.15f));
    objects.push_back(kMakers[(first + i) % kMakers.size()](size));
    center(objects.back());
    objects.back().mass = rng.uniform(0.6f, 1.4f);
  }
  return objects;
}

void add_container(TraceScene& scene, const ContainerShape& shape, const Pose& pose) {
  const std::array<int, 6> glass = add_glass(scene, shape);
  const int black = add_material(
      scene,
      {.name = "frame",
       .kind = MaterialKind::kRoughPlastic,
       .albedo = {0.008f, 0.008f, 0.008f},
       .roughness = kFrameRoughness}
  );
  TraceMesh frame;
  for (const Bounds& beam : container_beams(shape))
    append(frame, box_mesh(beam.low, beam.high), pose);
  add_mesh(scene, std::move(frame), "frame", black);
  const auto panes = container_panes(shape);
  for (std::size_t i = 0; i < panes.size(); ++i) {
    const Pane& pane = panes[i];
    Vec3f u{}, v{};
    u[(pane.axis + 1) % 3] = 2 * pane.half_size[(pane.axis + 1) % 3];
    v[(pane.axis + 2) % 3] = 2 * pane.half_size[(pane.axis + 2) % 3];
    TraceMesh quad = quad_mesh(pane.center - 0.5f * u - 0.5f * v, u, v);
    transform(quad, pose);
    add_mesh(scene, std::move(quad), "pane", glass[i]);
  }
}

void add_objects(
    TraceScene& scene,
    std::vector<ContainerObject> objects,
    const std::vector<Pose>& poses,
    Rng& rng
) {
  const std::size_t first_color = rng.next_u32() % 64;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ContainerObject& object = objects[i];
    scale_uvs(object.mesh, 2.5f);
    transform(object.mesh, poses[i]);
    const int material =
        add_material(scene, object_material(scene, object.name, i, first_color, rng));
    add_mesh(scene, std::move(object.mesh), object.name, material);
  }
}

}  // namespace glint

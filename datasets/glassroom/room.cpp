// SPDX-License-Identifier: MIT
#include "datasets/glassroom/room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "glint/core/error.h"
#include "glint/core/progress.h"

namespace glint {

namespace {

constexpr float kWallGap = 0.03f;  // furniture stands off the baseboard
constexpr float kItemGap = 0.04f;  // between neighbours
constexpr float kBaseboardHeight = 0.09f, kBaseboardDepth = 0.016f;
constexpr int kPlacementTries = 400;

// Radiance in arbitrary units; the exposure is fitted to the finished room.
constexpr Vec3f kCeilingLight{10.0f, 9.4f, 8.4f};
constexpr Vec3f kLampLight{6.0f, 4.4f, 2.6f};
constexpr std::array<Vec3f, 4> kWindowLight{// rows from the sill up: garden, trees, haze, sky
                                            Vec3f{0.9f, 1.3f, 0.6f},
                                            {1.2f, 1.7f, 1.1f},
                                            {3.2f, 3.5f, 3.7f},
                                            {3.0f, 3.9f, 5.0f}};

class RoomBuilder {
 public:
  RoomBuilder(const RoomProgram& program, std::uint64_t seed)
      : program_(program), rng_(seed, hash_name(program.name)), seed_(seed) {
    room_.size = {rng_.uniform(4.7f, 5.6f), rng_.uniform(4.6f, 5.4f), rng_.uniform(2.6f, 2.85f)};
    room_.container_place = {rng_.uniform(-0.15f, 0.15f), rng_.uniform(-0.15f, 0.15f)};
    make_palette();
  }

  RoomModel build(const AssetSource& assets) {
    if (assets) assets_ = assets(room_.scene);
    add_shell();
    add_ceiling_lights();
    add_rug();
    for (int wall = 0; wall < 4; ++wall) add_openings(wall);
    for (int wall = 0; wall < 4; ++wall) add_wall_furniture(wall);
    for (int wall = 0; wall < 4; ++wall)
      for (int i = 0; i < walls(wall).pictures; ++i) add_picture(wall, i);
    return std::move(room_);
  }

 private:
  const WallProgram& walls(int wall) const {
    return program_.walls[static_cast<std::size_t>(wall)];
  }
  float wall_length(int wall) const { return wall % 2 == 0 ? room_.size.x : room_.size.y; }

  // Local frame of a wall (furniture.h) at `along` metres from its middle.
  Pose wall_pose(int wall, float along) const {
    const float yaw = static_cast<float>(wall) * 0.5f * std::numbers::pi_v<float>;
    const float off = 0.5f * (wall % 2 == 0 ? room_.size.y : room_.size.x);
    const Pose turn = yawed(yaw, {});
    return {.rotation = turn.rotation, .translation = turn.apply({along, -off, 0})};
  }

  std::uint64_t next_seed() {
    return (seed_ << 20) + hash_name(program_.name) % 65536 + ++counter_;
  }

  int textured(
      std::string name,
      PatternSpec spec,
      MaterialKind kind = MaterialKind::kDiffuse,
      float roughness = 0.5f
  ) {
    spec.seed = next_seed();
    return add_material(
        room_.scene,
        {.name = std::move(name),
         .kind = kind,
         .albedo = {1, 1, 1},
         .texture = add_texture(room_.scene, make_pattern(spec)),
         .roughness = roughness}
    );
  }
  int plain(
      std::string name,
      Vec3f color,
      MaterialKind kind = MaterialKind::kDiffuse,
      float roughness = 0.4f
  ) {
    return add_material(
        room_.scene,
        {.name = std::move(name), .kind = kind, .albedo = color, .roughness = roughness}
    );
  }
  int emitter(std::string name, Vec3f radiance) {
    return add_material(
        room_.scene, {.name = std::move(name), .albedo = {0.6f, 0.6f, 0.6f}, .emission = radiance}
    );
  }
  Finish finish(
      std::string name, const PatternSpec& spec, MaterialKind kind = MaterialKind::kDiffuse
  ) {
    return {textured(std::move(name), spec, kind), 1 / spec.period};
  }

  void make_palette() {
    const auto plastic = MaterialKind::kRoughPlastic, conductor = MaterialKind::kRoughConductor;
    palette_.wood = finish("wood", program_.wood);
    palette_.dark_wood = finish("dark wood", program_.dark_wood);
    palette_.fabric = finish("fabric", program_.fabric);
    palette_.cushion = finish("cushion", program_.cushion);
    palette_.books = finish("books", program_.books);
    palette_.paint = {plain("paint", program_.paint), 1};
    palette_.metal = {plain("steel", {0.6f, 0.6f, 0.62f}, conductor, 0.45f), 1};
    palette_.brass = {plain("brass", {0.78f, 0.6f, 0.28f}, conductor, 0.35f), 1};
    palette_.black = {plain("black plastic", {0.015f, 0.015f, 0.017f}, plastic, 0.25f), 1};
    palette_.ceramic = {plain("ceramic", program_.ceramic, plastic, 0.3f), 1};
    palette_.leaf = {plain("leaf", srgb_hex(0x4C7A3A), plastic, 0.5f), 1};
    palette_.pot = {plain("pot", program_.pot), 1};
    palette_.shade = {emitter("lamp shade", kLampLight), 1};
  }

  void add(TraceMesh mesh, const char* name, int material, const Pose& pose = {}) {
    transform(mesh, pose);
    add_mesh(room_.scene, std::move(mesh), name, material);
  }

  void add_shell() {
    const Vec3f s = room_.size, low{-0.5f * s.x, -0.5f * s.y, 0};
    TraceMesh floor = quad_mesh(low, {s.x, 0, 0}, {0, s.y, 0});
    scale_uvs(floor, 1 / program_.floor.period);
    add(std::move(floor), "floor", textured("floor", program_.floor));
    add(quad_mesh({low.x, -low.y, s.z}, {s.x, 0, 0}, {0, -s.y, 0}),
        "ceiling",
        plain("ceiling", srgb_hex(0xEEECE6)));
    const int trim = palette_.paint.material;
    for (int wall = 0; wall < 4; ++wall) {
      const float half = 0.5f * wall_length(wall);
      TraceMesh side = quad_mesh({half, 0, 0}, {-2 * half, 0, 0}, {0, 0, s.z});
      scale_uvs(side, 1 / walls(wall).finish.period);
      add(std::move(side), "wall", textured("wall", walls(wall).finish), wall_pose(wall, 0));
      add(box_mesh({-half, 0, 0}, {half, kBaseboardDepth, kBaseboardHeight}),
          "baseboard",
          trim,
          wall_pose(wall, 0));
      add(box_mesh({-half, 0, s.z - 0.07f}, {half, 0.05f, s.z}), "cornice", trim, wall_pose(wall, 0)
      );
    }
  }

  // Two by two panels in frames just under the ceiling.
  void add_ceiling_lights() {
    constexpr float kHalf = 0.5f, kFrame = 0.04f;
    const int light = emitter("ceiling light", kCeilingLight);
    const float z = room_.size.z;
    for (const float sx : {-0.25f, 0.25f})
      for (const float sy : {-0.25f, 0.25f}) {
        const Pose at = translated({sx * room_.size.x, sy * room_.size.y, 0});
        add(quad_mesh({-kHalf, kHalf, z - 0.02f}, {2 * kHalf, 0, 0}, {0, -2 * kHalf, 0}),
            "ceiling light",
            light,
            at);
        TraceMesh frame;
        const float o = kHalf + kFrame;
        append(frame, box_mesh({-o, -o, z - 0.04f}, {o, -kHalf, z}));
        append(frame, box_mesh({-o, kHalf, z - 0.04f}, {o, o, z}));
        append(frame, box_mesh({-o, -kHalf, z - 0.04f}, {-kHalf, kHalf, z}));
        append(frame, box_mesh({kHalf, -kHalf, z - 0.04f}, {o, kHalf, z}));
        add(std::move(frame), "light frame", palette_.metal.material, at);
      }
  }

  void add_rug() {
    constexpr float kThickness = 0.008f;
    const Vec2f half{1.3f, 1.05f};
    const Vec3f place{room_.container_place.x, room_.container_place.y, 0};
    TraceMesh rug = box_mesh({-half.x, -half.y, 0.0005f}, {half.x, half.y, kThickness});
    for (std::size_t i = 0; i < rug.uvs.size(); ++i)
      rug.uvs[i] = {
          0.5f + 0.499f * rug.vertices[i].x / half.x, 0.5f + 0.499f * rug.vertices[i].y / half.y};
    add(std::move(rug), "rug", textured("rug", program_.rug), translated(place));
    room_.support_height = kThickness;
  }

  bool is_free(const Bounds& bounds) const {
    if (!room_.bounds().contains(bounds)) return false;
    return std::none_of(room_.items.begin(), room_.items.end(), [&](const PlacedItem& item) {
      return item.bounds.overlaps(bounds.grown(kItemGap));
    });
  }

  // A free place along the wall for something with these local bounds; nothing when there is none.
  bool find_place(int wall, const Bounds& local, Pose& pose, Bounds& world) {
    const float reach = 0.5f * (wall_length(wall) - local.size().x) - kWallGap;
    if (reach <= 0) return false;
    for (int attempt = 0; attempt < kPlacementTries; ++attempt) {
      pose = wall_pose(wall, rng_.uniform(-reach, reach) - local.center().x);
      world = {};
      world.include(pose.apply(local.low));
      world.include(pose.apply(local.high));
      if (is_free(world)) return true;
    }
    return false;
  }

  void add_openings(int wall) {
    for (int i = 0; i < walls(wall).windows; ++i) add_window(wall);
    for (int i = 0; i < walls(wall).doors; ++i) add_door(wall);
  }

  // Reserves the place of something fixed to the wall; false when the wall is full.
  bool reserve(int wall, const char* kind, const Bounds& local, Pose& pose) {
    Bounds world;
    if (!find_place(wall, local, pose, world)) {
      log::info(fmt::format("{}: no room for a {} on wall {}", program_.name, kind, wall));
      return false;
    }
    room_.items.push_back({kind, wall, world});
    return true;
  }

  // Panes that glow in rows, mullions, a sill, and curtains at both sides.
  void add_window(int wall) {
    const float half = rng_.uniform(0.55f, 0.75f), low = rng_.uniform(0.3f, 0.5f), high = 2.25f;
    constexpr float kCurtain = 0.34f;
    Pose pose;
    const Bounds local{
        .low = {-half - kCurtain, 0.001f, 0.1f}, .high = {half + kCurtain, 0.2f, high + 0.12f}};
    if (!reserve(wall, "window", local, pose)) return;
    const float row = (high - low) / static_cast<float>(kWindowLight.size());
    for (std::size_t i = 0; i < kWindowLight.size(); ++i)
      add(quad_mesh(
              {half, 0.01f, low + row * static_cast<float>(i)}, {-2 * half, 0, 0}, {0, 0, row}
          ),
          "window pane",
          emitter("window", kWindowLight[i]),
          pose);
    TraceMesh frame;
    for (const float x : {-half - 0.05f, -0.025f, half})
      append(frame, box_mesh({x, 0, low}, {x + 0.05f, 0.06f, high}));
    for (const float z : {low - 0.05f, 0.5f * (low + high), high})
      append(frame, box_mesh({-half - 0.05f, 0, z}, {half + 0.05f, 0.06f, z + 0.05f}));
    append(frame, box_mesh({-half - 0.1f, 0, low - 0.08f}, {half + 0.1f, 0.16f, low - 0.05f}));
    add(std::move(frame), "window frame", palette_.paint.material, pose);
    const int cloth = plain("curtain", program_.curtain);
    for (const float side : {-1.0f, 1.0f})
      add(curtain_mesh(kCurtain, high - 0.02f, 4, 0.07f),
          "curtain",
          cloth,
          compose(pose, translated({side * (half + 0.5f * kCurtain), 0.085f, 0.1f})));
    add(box_mesh({-half - kCurtain, 0.1f, high + 0.08f}, {half + kCurtain, 0.13f, high + 0.11f}),
        "curtain rod",
        palette_.brass.material,
        pose);
  }

  void add_door(int wall) {
    constexpr float kHalf = 0.44f, kHeight = 2.05f;
    Pose pose;
    const Bounds local{
        .low = {-kHalf - 0.08f, 0.001f, 0}, .high = {kHalf + 0.08f, 0.1f, kHeight + 0.08f}};
    if (!reserve(wall, "door", local, pose)) return;
    TraceMesh leaf = box_mesh({-kHalf, 0, 0}, {kHalf, 0.025f, kHeight}), frame, panels;
    for (const float x : {-0.36f, 0.05f})
      for (const float z : {0.2f, 1.1f})
        append(panels, box_mesh({x, 0.025f, z}, {x + 0.31f, 0.037f, z + 0.75f}));
    for (const float x : {-kHalf - 0.08f, kHalf})
      append(frame, box_mesh({x, 0, 0}, {x + 0.08f, 0.05f, kHeight}));
    append(frame, box_mesh({-kHalf - 0.08f, 0, kHeight}, {kHalf + 0.08f, 0.05f, kHeight + 0.08f}));
    scale_uvs(leaf, palette_.wood.periods_per_metre);
    scale_uvs(panels, palette_.wood.periods_per_metre);
    add(std::move(leaf), "door", palette_.wood.material, pose);
    add(std::move(panels), "door panels", palette_.dark_wood.material, pose);
    add(std::move(frame), "door frame", palette_.paint.material, pose);
    add(sphere_mesh(0.03f, 16),
        "door knob",
        palette_.brass.material,
        compose(pose, translated({0.37f, 0.06f, 1.0f})));
  }

  Furniture furniture_of(FurnitureKind kind) {
    const auto asset = std::find_if(assets_.begin(), assets_.end(), [&](const FurnitureAsset& a) {
      return a.kind == kind;
    });
    return asset != assets_.end() ? asset->furniture : make_furniture(kind, palette_, rng_);
  }

  void add_wall_furniture(int wall) {
    for (const FurnitureKind kind : walls(wall).furniture) {
      Furniture furniture = furniture_of(kind);
      Bounds local = bounds_of(furniture);
      // The back stands off the wall: moved so that its rearmost point is at kWallGap.
      const Vec3f stand_off{0, kWallGap - local.low.y, 0};
      local.low += stand_off;
      local.high += stand_off;
      Pose pose;
      if (!reserve(wall, furniture_name(kind).data(), local, pose)) continue;
      for (FurniturePart& part : furniture)
        add(std::move(part.mesh),
            furniture_name(kind).data(),
            part.material,
            compose(pose, translated(stand_off)));
    }
  }

  void add_picture(int wall, int index) {
    constexpr std::array kKinds{
        PatternKind::kLandscape, PatternKind::kCircles, PatternKind::kBlocks, PatternKind::kWaves};
    constexpr std::array<std::uint32_t, 9> kInks{
        0xC8553D, 0x2D5D7B, 0xE0B23C, 0x588B4E, 0x8E4162, 0x1B3A4B, 0xD98E4A, 0x6C9A8B, 0x5A3E85};
    const float half_width = rng_.uniform(0.25f, 0.5f), half_height = rng_.uniform(0.22f, 0.38f);
    const float z = rng_.uniform(1.4f, 1.75f), x = half_width;
    Pose pose;
    const Bounds local{
        .low = {-x - 0.03f, 0.001f, z - half_height}, .high = {x + 0.03f, 0.035f, z + half_height}};
    if (!reserve(wall, "picture", local, pose)) return;
    PatternSpec spec{.kind = kKinds[static_cast<std::size_t>(wall + index) % kKinds.size()]};
    const std::uint32_t first = rng_.below(kInks.size());
    for (std::uint32_t i = 0; i < 3; ++i)
      spec.colors[i] = srgb_hex(kInks[(first + 2 * i) % kInks.size()]);
    // Seen from the room, the picture's u grows to the right, that is towards -x of the wall's
    // frame.
    TraceMesh canvas = quad_mesh(
        {x, 0.03f, z - half_height + 0.03f}, {-2 * x, 0, 0}, {0, 0, 2 * half_height - 0.06f}
    );
    canvas.uvs = {{0.01f, 0.01f}, {0.99f, 0.01f}, {0.99f, 0.99f}, {0.01f, 0.99f}};
    add(std::move(canvas), "picture", textured("picture", spec), pose);
    TraceMesh frame;
    for (const float side : {-x - 0.03f, x})
      append(
          frame, box_mesh({side, 0.001f, z - half_height}, {side + 0.03f, 0.035f, z + half_height})
      );
    for (const float side : {z - half_height, z + half_height - 0.03f})
      append(frame, box_mesh({-x, 0.001f, side}, {x, 0.035f, side + 0.03f}));
    add(std::move(frame), "picture frame", palette_.dark_wood.material, pose);
  }

  const RoomProgram& program_;
  Rng rng_;
  std::uint64_t seed_, counter_ = 0;
  RoomModel room_;
  Palette palette_;
  std::vector<FurnitureAsset> assets_;
};

}  // namespace

RoomModel build_room(const RoomProgram& program, std::uint64_t seed, const AssetSource& assets) {
  return RoomBuilder(program, seed).build(assets);
}

}  // namespace glint

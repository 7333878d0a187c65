// SPDX-License-Identifier: MIT
#include "datasets/glassroom/room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "datasets/glassroom/fixtures.h"
#include "glint/core/error.h"

namespace glint {

namespace {

constexpr float kWallGap = 0.03f;    // furniture stands off the baseboard
constexpr float kItemGap = 0.04f;    // between neighbours
constexpr float kCornerGap = 0.08f;  // from the corners of the room
constexpr float kBaseboardHeight = 0.09f, kBaseboardDepth = 0.016f;
constexpr int kWallTries = 300, kPictureTries = 200;
constexpr Vec3f kSilver{0.93f, 0.94f, 0.93f};  // share that a mirror gives back
// Of the shop window: from the container's middle, its half width and its height, metres.
constexpr float kShopWindowAway = 1.15f, kShopWindowHalf = 1.5f, kShopWindowHeight = 2.0f;

constexpr Vec3f kLampLight{6.0f, 4.4f, 2.6f};  // as in fixtures.h

// Something that needs a place at a wall, in the wall's frame.
struct Piece {
  std::string kind;
  Furniture furniture;
  Bounds local;
};

class RoomBuilder {
 public:
  RoomBuilder(const RoomProgram& program, std::uint64_t seed)
      : program_(program), rng_(seed, hash_name(program.name)), seed_(seed) {
    room_.size = {rng_.uniform(4.9f, 5.6f), rng_.uniform(4.8f, 5.4f), rng_.uniform(2.6f, 2.85f)};
    room_.container_place = {rng_.uniform(-0.15f, 0.15f), rng_.uniform(-0.15f, 0.15f)};
    room_.size.y += program.extra_depth;
    room_.container_place.x += program.case_shift.x;
    room_.container_place.y += program.case_shift.y;
    make_palette();
  }

  RoomModel build() {
    add_shell();
    add_ceiling_lights();
    add_rug();
    if (program_.shop_window) add_shop_window();
    for (int wall = 0; wall < 4; ++wall) furnish(wall);
    for (int wall = 0; wall < 4; ++wall)
      for (int i = 0; i < program(wall).pictures; ++i) hang_picture(wall, i);
    return std::move(room_);
  }

 private:
  const WallProgram& program(int wall) const {
    return program_.walls[static_cast<std::size_t>(wall)];
  }
  float wall_length(int wall) const { return wall % 2 == 0 ? room_.size.x : room_.size.y; }

  // Local frame of a wall (furniture.h) at `along` metres from its middle.
  Pose wall_pose(int wall, float along, float up = 0) const {
    const float yaw = static_cast<float>(wall) * 0.5f * std::numbers::pi_v<float>;
    const float off = 0.5f * (wall % 2 == 0 ? room_.size.y : room_.size.x);
    const Pose turn = yawed(yaw, {});
    return {.rotation = turn.rotation, .translation = turn.apply({along, -off, up})};
  }

  int textured(std::string name, PatternSpec spec) {
    spec.seed = (seed_ << 20) + hash_name(program_.name) % 65536 + ++num_patterns_;
    const int texture = add_texture(room_.scene, make_pattern(spec));
    return add_material(
        room_.scene, {.name = std::move(name), .albedo = {1, 1, 1}, .texture = texture}
    );
  }
  Finish finish(std::string name, const PatternSpec& spec) {
    return {textured(std::move(name), spec), 1 / spec.period};
  }
  Finish plain(
      std::string name,
      Vec3f color,
      MaterialKind kind = MaterialKind::kDiffuse,
      float roughness = 0.5f
  ) {
    return {
        add_material(
            room_.scene,
            {.name = std::move(name), .kind = kind, .albedo = color, .roughness = roughness}
        ),
        1};
  }
  int emitter(std::string name, Vec3f radiance) {
    return add_material(
        room_.scene, {.name = std::move(name), .albedo = {0.6f, 0.6f, 0.6f}, .emission = radiance}
    );
  }

  void make_palette() {
    const auto plastic = MaterialKind::kRoughPlastic, conductor = MaterialKind::kRoughConductor;
    palette_.wood = finish("wood", program_.wood);
    palette_.dark_wood = finish("dark wood", program_.dark_wood);
    palette_.fabric = finish("fabric", program_.fabric);
    palette_.cushion = finish("cushion", program_.cushion);
    palette_.books = finish("books", program_.books);
    palette_.paint = plain("paint", program_.paint);
    palette_.metal = plain("steel", {0.6f, 0.6f, 0.62f}, conductor, 0.45f);
    palette_.brass = plain("brass", {0.78f, 0.6f, 0.28f}, conductor, 0.35f);
    palette_.black = plain("black plastic", {0.015f, 0.015f, 0.017f}, plastic, 0.25f);
    palette_.ceramic = plain("ceramic", program_.ceramic, plastic, 0.3f);
    palette_.leaf = plain("leaf", srgb_hex(0x4C7A3A), plastic, 0.5f);
    palette_.pot = plain("pot", program_.pot);
    palette_.shade = {emitter("lamp shade", kLampLight), 1};
    fixtures_.curtain = plain("curtain", program_.curtain);
    fixtures_.ceiling_light = emitter("ceiling light", kCeilingLight);
    for (std::size_t i = 0; i < kWindowLight.size(); ++i)
      fixtures_.window_rows[i] = emitter("window", kWindowLight[i]);
  }

  void add(TraceMesh mesh, const std::string& name, int material, const Pose& pose = {}) {
    transform(mesh, pose);
    add_mesh(room_.scene, std::move(mesh), name, material);
  }
  void add(Furniture furniture, const std::string& name, const Pose& pose) {
    for (FurniturePart& part : furniture) add(std::move(part.mesh), name, part.material, pose);
  }

  void add_shell() {
    const Vec3f s = room_.size, low{-0.5f * s.x, -0.5f * s.y, 0};
    TraceMesh floor = quad_mesh(low, {s.x, 0, 0}, {0, s.y, 0});
    scale_uvs(floor, 1 / program_.floor.period);
    add(std::move(floor), "floor", textured("floor", program_.floor));
    TraceMesh ceiling = quad_mesh({low.x, -low.y, s.z}, {s.x, 0, 0}, {0, -s.y, 0});
    add(std::move(ceiling), "ceiling", plain("ceiling", srgb_hex(0xEEECE6)).material);
    for (int wall = 0; wall < 4; ++wall) add_wall(wall, 0.5f * wall_length(wall), s.z);
  }

  void add_wall(int wall, float half, float height) {
    TraceMesh side = quad_mesh({half, 0, 0}, {-2 * half, 0, 0}, {0, 0, height});
    scale_uvs(side, 1 / program(wall).finish.period);
    const Pose pose = wall_pose(wall, 0);
    const int trim = palette_.paint.material;
    add(std::move(side), "wall", textured("wall", program(wall).finish), pose);
    add(box_mesh({-half, 0, 0}, {half, kBaseboardDepth, kBaseboardHeight}), "baseboard", trim, pose
    );
    add(box_mesh({-half, 0, height - 0.07f}, {half, 0.05f, height}), "cornice", trim, pose);
  }

  void add_ceiling_lights() {
    for (const float x : {-0.25f, 0.25f})
      for (const float y : {-0.25f, 0.25f})
        add(make_ceiling_light(palette_, fixtures_, 0.5f),
            "ceiling light",
            translated({x * room_.size.x, y * room_.size.y, room_.size.z}));
  }

  void add_rug() {
    constexpr float kThickness = 0.008f;
    const Vec2f half{1.3f, 1.05f};
    TraceMesh rug = box_mesh({-half.x, -half.y, 0.0005f}, {half.x, half.y, kThickness});
    for (std::size_t i = 0; i < rug.uvs.size(); ++i) {
      const Vec3f v = rug.vertices[i];
      rug.uvs[i] = {0.5f + 0.499f * v.x / half.x, 0.5f + 0.499f * v.y / half.y};
    }
    const Vec2f place = room_.container_place;
    add(std::move(rug), "rug", textured("rug", program_.rug), translated({place.x, place.y, 0}));
    room_.support_height = kThickness;
  }

  // Before the furniture, which keeps clear of it.
  void add_shop_window() {
    const int glass = add_material(
        room_.scene,
        {.name = "shop window",
         .kind = MaterialKind::kThinDielectric,
         .albedo = {1, 1, 1},
         .ior = 1.52f,
         .tint = {0.975f, 0.985f, 0.98f}}
    );
    Furniture window = make_shop_window(palette_, glass, kShopWindowHalf, kShopWindowHeight);
    const Vec2f at = room_.container_place;
    const Pose pose = translated({at.x, at.y - kShopWindowAway, 0});
    room_.items.push_back({"shop window", -1, placed(bounds_of(window), pose)});
    add(std::move(window), "shop window", pose);
  }

  Furniture wall_mirror() {
    const int silver = add_material(
        room_.scene, {.name = "mirror", .kind = MaterialKind::kMirror, .albedo = kSilver}
    );
    return make_mirror(palette_, silver, 1.7f, 0.18f, 2.25f);
  }

  bool is_free(const Bounds& bounds) const {
    if (!room_.bounds().contains(bounds)) return false;
    return std::none_of(room_.items.begin(), room_.items.end(), [&](const PlacedItem& item) {
      return item.bounds.overlaps(bounds.grown(kItemGap));
    });
  }

  static Bounds placed(const Bounds& local, const Pose& pose) {
    Bounds world;
    world.include(pose.apply(local.low));
    world.include(pose.apply(local.high));
    return world;
  }

  // Moved along y so that its rearmost point is `gap` off the wall.
  static Piece make_piece(std::string kind, Furniture furniture, float gap) {
    const Vec3f shift{0, gap - bounds_of(furniture).low.y, 0};
    for (FurniturePart& part : furniture) transform(part.mesh, translated(shift));
    const Bounds local = bounds_of(furniture);
    return {std::move(kind), std::move(furniture), local};
  }

  std::vector<Piece> wall_pieces(int wall) {
    std::vector<Piece> pieces;
    for (int i = 0; i < program(wall).windows; ++i)
      pieces.push_back(make_piece("window", make_window(palette_, fixtures_, rng_), 0.001f));
    for (int i = 0; i < program(wall).doors; ++i)
      pieces.push_back(make_piece("door", make_door(palette_), 0.001f));
    for (int i = 0; i < program(wall).mirrors; ++i)
      pieces.push_back(make_piece("mirror", wall_mirror(), 0.001f));
    for (const FurnitureKind kind : program(wall).furniture)
      pieces.push_back(make_piece(
          std::string(furniture_name(kind)), make_furniture(kind, palette_, rng_), kWallGap
      ));
    return pieces;
  }

  // All pieces side by side in random order with random gaps; retried until the corners are free.
  void furnish(int wall) {
    std::vector<Piece> pieces = wall_pieces(wall);
    float spare = wall_length(wall) - 2 * kCornerGap;
    for (const Piece& piece : pieces) spare -= piece.local.size().x + 2 * kItemGap;
    GLINT_CHECK(spare >= 0, kEnvironment, "{}: wall {} is too short", program_.name, wall);
    const std::size_t before = room_.items.size();
    for (int attempt = 0; attempt < kWallTries; ++attempt) {
      if (arrange(wall, pieces, spare)) return;
      room_.items.resize(before);
    }
    GLINT_CHECK(
        false, kEnvironment, "{}: the furniture of wall {} does not fit", program_.name, wall
    );
  }

  bool arrange(int wall, std::vector<Piece>& pieces, float spare) {
    for (std::size_t i = pieces.size(); i > 1; --i)
      std::swap(pieces[i - 1], pieces[rng_.below(static_cast<std::uint32_t>(i))]);
    // Sorted random cuts share the spare length among the gaps.
    std::vector<float> cuts(pieces.size());
    for (float& cut : cuts) cut = rng_.uniform(0, spare);
    std::sort(cuts.begin(), cuts.end());
    std::vector<Pose> poses;
    float along = kCornerGap - 0.5f * wall_length(wall);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Bounds& local = pieces[i].local;
      poses.push_back(wall_pose(wall, along + cuts[i] + kItemGap - local.low.x));
      const Bounds world = placed(local, poses.back());
      if (!is_free(world)) return false;
      room_.items.push_back({pieces[i].kind, wall, world});
      along += local.size().x + 2 * kItemGap;
    }
    for (std::size_t i = 0; i < pieces.size(); ++i)
      add(std::move(pieces[i].furniture), pieces[i].kind, poses[i]);
    return true;
  }

  // On a free stretch of wall; left out where there is none.
  void hang_picture(int wall, int index) {
    const float half_width = rng_.uniform(0.25f, 0.5f), half_height = rng_.uniform(0.22f, 0.38f);
    const float reach = 0.5f * wall_length(wall) - half_width - kCornerGap;
    for (int attempt = 0; attempt < kPictureTries; ++attempt) {
      const Pose pose = wall_pose(wall, rng_.uniform(-reach, reach), rng_.uniform(1.4f, 1.75f));
      const Bounds local{
          .low = {-half_width - 0.03f, 0.001f, -half_height},
          .high = {half_width + 0.03f, 0.035f, half_height}};
      const Bounds world = placed(local, pose);
      if (!is_free(world)) continue;
      room_.items.push_back({"picture", wall, world});
      const int canvas = textured("picture", painting(wall + index));
      return add(make_picture(palette_, canvas, half_width, half_height), "picture", pose);
    }
  }

  PatternSpec painting(int index) {
    constexpr std::array kKinds{
        PatternKind::kLandscape, PatternKind::kCircles, PatternKind::kBlocks, PatternKind::kWaves};
    constexpr std::array<std::uint32_t, 9> kInks{
        0xC8553D, 0x2D5D7B, 0xE0B23C, 0x588B4E, 0x8E4162, 0x1B3A4B, 0xD98E4A, 0x6C9A8B, 0x5A3E85};
    PatternSpec spec{.kind = kKinds[static_cast<std::size_t>(index) % kKinds.size()]};
    const std::uint32_t first = rng_.below(kInks.size());
    for (std::uint32_t i = 0; i < 3; ++i)
      spec.colors[i] = srgb_hex(kInks[(first + 2 * i) % kInks.size()]);
    return spec;
  }

  const RoomProgram& program_;
  Rng rng_;
  std::uint64_t seed_, num_patterns_ = 0;
  RoomModel room_;
  Palette palette_;
  FixturePalette fixtures_;
};

}  // namespace

RoomModel build_room(const RoomProgram& program, std::uint64_t seed) {
  return RoomBuilder(program, seed).build();
}

}  // namespace glint

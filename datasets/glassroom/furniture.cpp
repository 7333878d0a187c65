// SPDX-License-Identifier: MIT
#include "datasets/glassroom/furniture.h"

#include <array>
#include <cmath>
#include <numbers>

namespace glint {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

void put(Furniture& furniture, TraceMesh mesh, Finish finish, const Pose& pose = {}) {
  transform(mesh, pose);
  scale_uvs(mesh, finish.periods_per_metre);
  furniture.push_back({std::move(mesh), finish.material});
}

void put_box(Furniture& furniture, Vec3f low, Vec3f high, Finish finish) {
  put(furniture, box_mesh(low, high), finish);
}

// Four square legs under the rectangle [x0, x1] x [y0, y1].
void put_legs(Furniture& f, Vec2f low, Vec2f high, float height, float width, Finish finish) {
  for (const float x : {low.x, high.x - width})
    for (const float y : {low.y, high.y - width})
      put_box(f, {x, y, 0}, {x + width, y + width, height}, finish);
}

Furniture make_seat(const Palette& p, Rng& rng, float width, int cushions) {
  Furniture f;
  const float depth = rng.uniform(0.82f, 0.92f), arm = 0.18f, x = 0.5f * width, leg = 0.12f;
  put_legs(f, {-x + 0.05f, 0.05f}, {x - 0.05f, depth - 0.05f}, leg, 0.05f, p.dark_wood);
  put(f, cushion_mesh({-x, 0.02f, leg}, {x, depth, 0.28f}, 0.03f), p.fabric);
  put(f, cushion_mesh({-x, 0.02f, 0.28f}, {x, 0.24f, 0.82f}, 0.06f), p.fabric);
  for (const float side : {-x, x - arm})
    put(f, cushion_mesh({side, 0.2f, 0.28f}, {side + arm, depth, 0.6f}, 0.05f), p.fabric);
  const float seat = (width - 2 * arm) / static_cast<float>(cushions);
  for (int i = 0; i < cushions; ++i) {
    const float left = -x + arm + static_cast<float>(i) * seat;
    put(f,
        cushion_mesh(
            {left + 0.01f, 0.24f, 0.28f}, {left + seat - 0.01f, depth - 0.02f, 0.45f}, 0.04f
        ),
        p.fabric);
    const Pose lean{
        .rotation = {{{1, 0, 0}, {0, 0.966f, 0.259f}, {0, -0.259f, 0.966f}}},
        .translation = {left + 0.5f * seat, 0.28f, 0.47f}};
    put(f, cushion_mesh({-0.22f, 0, 0}, {0.22f, 0.13f, 0.38f}, 0.05f), p.cushion, lean);
  }
  return f;
}

// A row of books standing on z = 0 from x = low to x = high; each takes one column of the texture.
void put_books(Furniture& f, float low, float high, float y, float z, const Palette& p, Rng& rng) {
  TraceMesh books;
  float x = low;
  while (x < high - 0.05f) {
    const float thickness = rng.uniform(0.022f, 0.05f), height = rng.uniform(0.19f, 0.27f);
    const float depth = rng.uniform(0.15f, 0.2f);
    if (rng.uniform() < 0.08f) {  // a gap
      x += 0.08f;
      continue;
    }
    TraceMesh book = box_mesh({x, y, z}, {x + thickness, y + depth, z + height});
    const float column = (static_cast<float>(rng.below(16)) + 0.1f) / 16;
    for (std::size_t i = 0; i < book.uvs.size(); ++i) {
      const Vec3f v = book.vertices[i];
      book.uvs[i] = {column + 0.05f * (v.x - x) / thickness, (v.z - z) / height * 0.98f + 0.01f};
    }
    append(books, book);
    x += thickness + 0.002f;
  }
  if (!books.faces.empty()) f.push_back({std::move(books), p.books.material});
}

Furniture make_bookshelf(const Palette& p, Rng& rng) {
  Furniture f;
  const float width = rng.uniform(0.9f, 1.25f), height = rng.uniform(1.85f, 2.1f), depth = 0.3f;
  const float x = 0.5f * width, board = 0.025f;
  const Finish body = rng.uniform() < 0.5f ? p.wood : p.dark_wood;
  put_box(f, {-x, 0, 0}, {-x + board, depth, height}, body);
  put_box(f, {x - board, 0, 0}, {x, depth, height}, body);
  put_box(f, {-x + board, 0, 0.06f}, {x - board, 0.012f, height}, body);
  constexpr int kShelves = 6;
  const float gap = (height - 0.06f - board) / (kShelves - 1);
  for (int i = 0; i < kShelves; ++i) {
    const float z = 0.06f + gap * static_cast<float>(i);
    put_box(f, {-x + board, 0.012f, z}, {x - board, depth, z + board}, body);
    if (i + 1 == kShelves) break;
    const float end = x - board - rng.uniform(0.02f, 0.35f);
    put_books(f, -x + board + 0.01f, end, 0.03f, z + board, p, rng);
    if (end < x - 0.22f)
      put(f, sphere_mesh(0.07f, 20), p.ceramic, translated({x - 0.13f, 0.16f, z + board + 0.07f}));
  }
  return f;
}

TraceMesh vase_mesh(float height, Rng& rng) {
  const float belly = height * rng.uniform(0.28f, 0.4f), neck = belly * rng.uniform(0.3f, 0.5f);
  std::vector<Vec2f> profile{{0, 0}};
  for (int i = 0; i <= 14; ++i) {
    const float s = static_cast<float>(i) / 14;
    const float swell = std::sin(kPi * std::pow(s, 0.75f));
    profile.push_back({neck * (0.9f + 0.35f * s * s) + (belly - neck) * swell, s * height});
  }
  profile.push_back({0, height});
  return lathe_mesh(profile, 28);
}

Furniture make_sideboard(const Palette& p, Rng& rng) {
  Furniture f;
  const float width = rng.uniform(1.2f, 1.6f), depth = 0.42f, height = rng.uniform(0.74f, 0.84f);
  const float x = 0.5f * width, leg = 0.12f;
  const bool painted = rng.uniform() < 0.4f;
  const Finish body = painted ? p.paint : p.wood;
  put_legs(f, {-x + 0.04f, 0.04f}, {x - 0.04f, depth - 0.04f}, leg, 0.04f, p.dark_wood);
  put_box(f, {-x, 0, leg}, {x, depth - 0.02f, height - 0.03f}, body);
  put_box(f, {-x - 0.015f, 0, height - 0.03f}, {x + 0.015f, depth, height}, p.dark_wood);
  constexpr int kDoors = 3;
  const float door = width / kDoors;
  for (int i = 0; i < kDoors; ++i) {
    const float left = -x + door * static_cast<float>(i);
    put_box(
        f,
        {left + 0.015f, depth - 0.02f, leg + 0.02f},
        {left + door - 0.015f, depth, height - 0.05f},
        body
    );
    put(f,
        sphere_mesh(0.016f, 12),
        p.brass,
        translated({left + door - 0.07f, depth + 0.012f, 0.5f * (leg + height)}));
  }
  put(f,
      vase_mesh(rng.uniform(0.25f, 0.38f), rng),
      p.ceramic,
      translated({-0.3f * width, 0.2f, height}));
  put_books(f, 0.05f, 0.35f * width, 0.1f, height, p, rng);
  return f;
}

Furniture make_wardrobe(const Palette& p, Rng& rng) {
  Furniture f;
  const float width = rng.uniform(0.95f, 1.2f), depth = 0.55f, height = rng.uniform(1.95f, 2.1f);
  const float x = 0.5f * width;
  put_box(f, {-x, 0, 0.06f}, {x, depth - 0.02f, height - 0.05f}, p.wood);
  put_box(f, {-x + 0.03f, 0.02f, 0}, {x - 0.03f, depth - 0.06f, 0.06f}, p.dark_wood);
  put_box(f, {-x - 0.02f, 0, height - 0.05f}, {x + 0.02f, depth + 0.02f, height}, p.dark_wood);
  for (const float side : {-1.0f, 1.0f}) {
    const float a = side < 0 ? -x + 0.015f : 0.008f, b = side < 0 ? -0.008f : x - 0.015f;
    put_box(f, {a, depth - 0.02f, 0.1f}, {b, depth, height - 0.08f}, p.wood);
    for (const float z : {0.2f, 1.1f})
      put_box(f, {a + 0.07f, depth, z}, {b - 0.07f, depth + 0.012f, z + 0.75f}, p.paint);
    put(f,
        cylinder_mesh(0.01f, 0.16f, 12),
        p.brass,
        translated({0.05f * side, depth + 0.03f, 0.95f}));
  }
  return f;
}

Furniture make_desk(const Palette& p, Rng& rng) {
  Furniture f;
  const float width = rng.uniform(1.2f, 1.5f), depth = 0.62f, height = 0.74f, x = 0.5f * width;
  put_box(f, {-x, 0, height - 0.035f}, {x, depth, height}, p.wood);
  put_legs(f, {-x + 0.03f, 0.03f}, {x - 0.03f, depth - 0.03f}, height - 0.035f, 0.05f, p.dark_wood);
  put_box(f, {x - 0.42f, 0.04f, 0.45f}, {x - 0.09f, depth - 0.05f, height - 0.035f}, p.wood);
  put(f, sphere_mesh(0.014f, 12), p.brass, translated({x - 0.25f, depth - 0.04f, 0.58f}));
  // Chair, pushed half under the top.
  const float seat = 0.44f, cx = -0.15f * width, near = depth - 0.12f, far = near + 0.44f;
  put_legs(f, {cx - 0.21f, near}, {cx + 0.21f, far}, seat, 0.035f, p.dark_wood);
  put(f, cushion_mesh({cx - 0.22f, near, seat}, {cx + 0.22f, far, seat + 0.06f}, 0.02f), p.cushion);
  for (const float side : {-0.21f, 0.175f})
    put_box(
        f, {cx + side, far - 0.035f, seat + 0.06f}, {cx + side + 0.035f, far, 0.92f}, p.dark_wood
    );
  for (const float z : {0.62f, 0.72f, 0.82f})
    put_box(f, {cx - 0.175f, far - 0.03f, z}, {cx + 0.175f, far - 0.01f, z + 0.06f}, p.dark_wood);
  // Desk lamp and a stack of books.
  put(f, cylinder_mesh(0.07f, 0.02f, 20), p.black, translated({-x + 0.2f, 0.2f, height}));
  put(f, cylinder_mesh(0.01f, 0.32f, 10), p.black, translated({-x + 0.2f, 0.2f, height + 0.02f}));
  put(f, cone_mesh(0.1f, 0.13f, 20), p.brass, translated({-x + 0.2f, 0.2f, height + 0.3f}));
  put_books(f, x - 0.5f, x - 0.1f, 0.05f, height, p, rng);
  return f;
}

Furniture make_media_unit(const Palette& p, Rng& rng) {
  Furniture f;
  const float width = rng.uniform(1.5f, 1.8f), depth = 0.4f, height = 0.48f, x = 0.5f * width;
  put_box(f, {-x, 0, 0.06f}, {x, depth, 0.1f}, p.dark_wood);
  put_box(f, {-x, 0, height - 0.04f}, {x, depth, height}, p.dark_wood);
  put_legs(f, {-x + 0.04f, 0.04f}, {x - 0.04f, depth - 0.04f}, 0.06f, 0.05f, p.metal);
  for (const float at : {-x, -0.33f * x, 0.33f * x, x - 0.03f})
    put_box(f, {at, 0, 0.1f}, {at + 0.03f, depth - 0.01f, height - 0.04f}, p.dark_wood);
  put_books(f, -x + 0.06f, -0.4f * x, 0.1f, 0.1f, p, rng);
  put_box(f, {0.4f * x, 0.02f, 0.1f}, {0.9f * x, depth - 0.03f, 0.32f}, p.paint);
  const float screen = 0.38f * width;
  put_box(
      f, {-screen, 0.16f, height + 0.06f}, {screen, 0.2f, height + 0.06f + 1.1f * screen}, p.black
  );
  put_box(f, {-0.2f, 0.1f, height}, {0.2f, 0.28f, height + 0.015f}, p.metal);
  put_box(f, {-0.04f, 0.15f, height + 0.015f}, {0.04f, 0.19f, height + 0.1f}, p.metal);
  return f;
}

// One leaf: a folded blade from the base along a bent line.
TraceMesh leaf_mesh(float length, float width, float rise) {
  TraceMesh leaf;
  constexpr int kSteps = 6;
  std::array<Vec3f, kSteps + 1> spine{};
  for (int i = 0; i <= kSteps; ++i) {
    const float s = static_cast<float>(i) / kSteps;
    spine[static_cast<std::size_t>(i)] = {length * s, 0, rise * (1.6f * s - 1.1f * s * s) * length};
  }
  for (std::size_t i = 0; i + 1 < spine.size(); ++i) {
    const auto half = [&](std::size_t k) {
      return 0.5f * width * std::sin(kPi * (0.08f + 0.92f * static_cast<float>(k) / kSteps));
    };
    const Vec3f along = spine[i + 1] - spine[i];
    for (const float side : {-1.0f, 1.0f}) {
      const Vec3f rim0{0, side * half(i), 0.3f * half(i)},
          rim1{0, side * half(i + 1), 0.3f * half(i + 1)};
      const Vec3f across = 0.5f * (rim0 + rim1);
      if (side > 0)
        append(leaf, quad_mesh(spine[i], along, across));
      else
        append(leaf, quad_mesh(spine[i], across, along));
    }
  }
  return leaf;
}

Furniture make_plant(const Palette& p, Rng& rng) {
  Furniture f;
  const Vec3f center{0, 0.32f, 0};
  const float pot = rng.uniform(0.3f, 0.4f);
  put(f,
      lathe_mesh(
          std::array<Vec2f, 5>{
              Vec2f{0, 0}, {0.13f, 0}, {0.18f, pot}, {0.16f, pot}, {0, pot - 0.03f}},
          28
      ),
      p.pot,
      translated(center));
  TraceMesh leaves, stems;
  const int count = 15 + static_cast<int>(rng.below(8));
  for (int i = 0; i < count; ++i) {
    const float yaw = 2.4f * static_cast<float>(i), height = rng.uniform(0.1f, 0.85f);
    const float length = rng.uniform(0.2f, 0.28f), reach = 0.02f + 0.02f * height;
    const Pose pose = yawed(yaw, center + Vec3f{0, 0, pot + height});
    append(
        leaves,
        leaf_mesh(length, rng.uniform(0.08f, 0.13f), rng.uniform(0.4f, 1.0f)),
        compose(pose, translated({reach, 0, 0}))
    );
    const std::array<Vec3f, 3> path{
        Vec3f{0, 0, pot - 0.05f}, {0.3f * reach, 0, pot + 0.5f * height}, {reach, 0, pot + height}};
    append(
        stems, tube_mesh(path, std::array<float, 3>{0.009f, 0.007f, 0.005f}, 6), yawed(yaw, center)
    );
  }
  put(f, std::move(leaves), p.leaf);
  put(f, std::move(stems), p.wood);
  return f;
}

Furniture make_floor_lamp(const Palette& p, Rng& rng) {
  Furniture f;
  const Vec3f center{0, 0.24f, 0};
  const float height = rng.uniform(1.25f, 1.45f);
  put(f, cylinder_mesh(0.14f, 0.025f, 28), p.metal, translated(center));
  put(f, cylinder_mesh(0.014f, height, 12), p.metal, translated(center + Vec3f{0, 0, 0.025f}));
  put(f,
      lathe_mesh(std::array<Vec2f, 2>{Vec2f{0.19f, 0}, {0.13f, 0.26f}}, 28),
      p.shade,
      translated(center + Vec3f{0, 0, height - 0.1f}));
  return f;
}

Furniture make_stool(const Palette& p, Rng& rng) {
  Furniture f;
  const float half = rng.uniform(0.18f, 0.22f), height = rng.uniform(0.42f, 0.5f);
  put_legs(f, {-half, 0.03f}, {half, 0.03f + 2 * half}, height, 0.04f, p.dark_wood);
  put(f,
      cushion_mesh(
          {-half - 0.02f, 0.01f, height}, {half + 0.02f, 0.05f + 2 * half, height + 0.06f}, 0.02f
      ),
      p.cushion);
  return f;
}

}  // namespace

std::string_view furniture_name(FurnitureKind kind) {
  constexpr std::array<std::string_view, 10> kNames{
      "sofa",
      "armchair",
      "bookshelf",
      "sideboard",
      "wardrobe",
      "desk",
      "media_unit",
      "plant",
      "floor_lamp",
      "stool"};
  return kNames[static_cast<std::size_t>(kind)];
}

Furniture make_furniture(FurnitureKind kind, const Palette& palette, Rng& rng) {
  switch (kind) {
    case FurnitureKind::kSofa:
      return make_seat(palette, rng, rng.uniform(1.75f, 2.05f), 3);
    case FurnitureKind::kArmchair:
      return make_seat(palette, rng, rng.uniform(0.88f, 0.96f), 1);
    case FurnitureKind::kBookshelf:
      return make_bookshelf(palette, rng);
    case FurnitureKind::kSideboard:
      return make_sideboard(palette, rng);
    case FurnitureKind::kWardrobe:
      return make_wardrobe(palette, rng);
    case FurnitureKind::kDesk:
      return make_desk(palette, rng);
    case FurnitureKind::kMediaUnit:
      return make_media_unit(palette, rng);
    case FurnitureKind::kPlant:
      return make_plant(palette, rng);
    case FurnitureKind::kFloorLamp:
      return make_floor_lamp(palette, rng);
    case FurnitureKind::kStool:
      break;
  }
  return make_stool(palette, rng);
}

Bounds bounds_of(const Furniture& furniture) {
  Bounds bounds;
  for (const FurniturePart& part : furniture)
    for (const Vec3f vertex : part.mesh.vertices) bounds.include(vertex);
  return bounds;
}

}  // namespace glint

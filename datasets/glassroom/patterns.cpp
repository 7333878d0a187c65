// SPDX-License-Identifier: MIT
#include "datasets/glassroom/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/parallel.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

float fract(float x) { return x - std::floor(x); }
float mix(float a, float b, float t) { return a + (b - a) * t; }
Vec3f mix(Vec3f a, Vec3f b, float t) { return (1 - t) * a + t * b; }
// 0 below `low`, 1 above `high`, smooth between.
float step_between(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}
// 1 in the inside of a unit cell, 0 within `joint` of its rim.
float inside_cell(float x, float joint) {
  const float distance = 0.5f - std::abs(fract(x) - 0.5f);
  return step_between(0.5f * joint, joint, distance);
}
int wrap(int i, int n) { return ((i % n) + n) % n; }

// Fine grain stretched along u: the look of cut wood.
float wood_grain(float u, float v, std::uint64_t seed) {
  const float warp = 0.6f * fractal_noise(u, v, 3, 3, seed + 11);
  const float rings = std::sin(2 * kPi * (6 * v + 2 * warp + 2 * fractal_noise(u, v, 2, 2, seed)));
  const float fibre = fractal_noise(u, fract(12 * v), 8, 3, seed + 5);
  return std::clamp(0.5f + 0.25f * rings + 0.5f * (fibre - 0.5f), 0.0f, 1.0f);
}

Vec3f plain(const PatternSpec& s, float u, float v) {
  const float mottle = fractal_noise(u, v, 4, 5, s.seed);
  return mix(s.colors[0], s.colors[1], 0.6f * mottle);
}

Vec3f planks(const PatternSpec& s, float u, float v) {
  constexpr int kRows = 10;
  const int row = static_cast<int>(v * kRows);
  const float shifted = fract(u + cell_value(row, 0, s.seed));
  const int half = shifted < 0.5f ? 0 : 1;
  const float tone = cell_value(row, 1 + half, s.seed);
  const float grain = wood_grain(shifted, fract(v + tone), s.seed);
  const float board = inside_cell(v * kRows, 0.035f) * inside_cell(2 * shifted, 0.006f);
  const Vec3f wood =
      mix(s.colors[0], s.colors[1], std::clamp(0.65f * tone + 0.5f * grain, 0.0f, 1.0f));
  return mix(s.colors[2], wood, board);
}

Vec3f parquet(const PatternSpec& s, float u, float v) {
  constexpr int kBlocks = 4, kStrips = 5;
  const int bx = static_cast<int>(u * kBlocks), by = static_cast<int>(v * kBlocks);
  const bool along_u = ((bx + by) & 1) == 0;
  const float across = fract((along_u ? v : u) * kBlocks) * kStrips;
  const int strip = static_cast<int>(across);
  const float tone = cell_value(bx * kStrips + strip, by, s.seed);
  const float grain =
      wood_grain(fract((along_u ? u : v) + tone), fract((along_u ? v : u) + tone), s.seed);
  const float joint = inside_cell(across, 0.07f) * inside_cell(u * kBlocks, 0.015f) *
                      inside_cell(v * kBlocks, 0.015f);
  const Vec3f wood =
      mix(s.colors[0], s.colors[1], std::clamp(0.7f * tone + 0.4f * grain, 0.0f, 1.0f));
  return mix(s.colors[2], wood, joint);
}

Vec3f tiles(const PatternSpec& s, float u, float v) {
  constexpr int kTiles = 4;
  const int x = static_cast<int>(u * kTiles), y = static_cast<int>(v * kTiles);
  const float tone = 0.85f + 0.2f * cell_value(x, y, s.seed);
  const float stain = 0.9f + 0.2f * fractal_noise(u, v, 8, 4, s.seed);
  const Vec3f tile = (tone * stain) * s.colors[static_cast<std::size_t>((x + y) & 1)];
  return mix(s.colors[2], tile, inside_cell(u * kTiles, 0.025f) * inside_cell(v * kTiles, 0.025f));
}

Vec3f bricks(const PatternSpec& s, float u, float v) {
  constexpr int kRows = 12, kColumns = 4;
  const int row = static_cast<int>(v * kRows);
  const float along = u * kColumns + ((row & 1) ? 0.5f : 0.0f);
  const int column = wrap(static_cast<int>(std::floor(along)), kColumns);
  const float tone = cell_value(column, row, s.seed);
  const float rough = fractal_noise(u, v, 24, 4, s.seed);
  const Vec3f brick = (0.7f + 0.6f * rough) * mix(s.colors[0], s.colors[1], tone);
  const float joint = inside_cell(v * kRows, 0.13f) * inside_cell(along, 0.04f);
  return mix((0.85f + 0.3f * rough) * s.colors[2], brick, joint);
}

Vec3f wallpaper(const PatternSpec& s, float u, float v) {
  constexpr int kColumns = 4, kRows = 4;
  const float stripe = step_between(0.4f, 0.44f, std::abs(fract(u * kColumns) - 0.5f));
  const float shift = (static_cast<int>(u * kColumns) & 1) ? 0.5f : 0.0f;
  const float x = fract(u * kColumns) - 0.5f, y = fract(v * kRows + shift) - 0.5f;
  const float radius = std::hypot(x, y), angle = std::atan2(y, x);
  const float petals = 0.24f + 0.08f * std::cos(6 * angle);
  const float rosette = step_between(0.02f, -0.02f, radius - petals) *
                        (0.5f + 0.5f * step_between(0.06f, 0.1f, radius));
  const float paper = 0.94f + 0.12f * fractal_noise(u, v, 32, 3, s.seed);
  return paper * mix(mix(s.colors[0], s.colors[1], stripe), s.colors[2], rosette);
}

Vec3f carpet(const PatternSpec& s, float u, float v) {
  const float tufts = fractal_noise(u, v, 64, 3, s.seed);
  const float worn = fractal_noise(u, v, 3, 4, s.seed + 3);
  const float lattice = std::abs(std::sin(4 * kPi * (u + v)) * std::sin(4 * kPi * (u - v)));
  const Vec3f base = mix(s.colors[0], s.colors[1], step_between(0.25f, 0.6f, lattice));
  return ((0.6f + 0.6f * tufts) * (0.85f + 0.3f * worn)) * base;
}

Vec3f marble(const PatternSpec& s, float u, float v) {
  constexpr int kSlabs = 2;
  const int x = static_cast<int>(u * kSlabs), y = static_cast<int>(v * kSlabs);
  const std::uint64_t slab = s.seed + static_cast<std::uint64_t>(7 * x + 3 * y);
  const float turbulence = fractal_noise(u, v, 5, 5, slab);
  const float vein = std::abs(std::sin(kPi * (3 * u + 2 * v + 5 * turbulence)));
  const float cloud = fractal_noise(u, v, 4, 4, slab + 1);
  const Vec3f stone = mix(s.colors[1], s.colors[0], std::pow(vein, 0.35f));
  const float joint = inside_cell(u * kSlabs, 0.008f) * inside_cell(v * kSlabs, 0.008f);
  return mix(s.colors[2], (0.85f + 0.3f * cloud) * stone, joint);
}

Vec3f wood(const PatternSpec& s, float u, float v) {
  return mix(s.colors[0], s.colors[1], wood_grain(v, u, s.seed));
}

Vec3f fabric(const PatternSpec& s, float u, float v) {
  constexpr int kThreads = 96;
  const float weave =
      0.5f + 0.25f * (std::sin(2 * kPi * kThreads * u) + std::sin(2 * kPi * kThreads * v));
  const float check = (fract(4 * u) < 0.2f ? 0.5f : 0.0f) + (fract(4 * v) < 0.2f ? 0.5f : 0.0f);
  const float worn = fractal_noise(u, v, 4, 4, s.seed);
  return (0.75f + 0.2f * weave + 0.25f * worn) * mix(s.colors[0], s.colors[1], check);
}

Vec3f rug(const PatternSpec& s, float u, float v) {
  const float rim = std::min({u, v, 1 - u, 1 - v});
  const float tufts = 0.8f + 0.4f * fractal_noise(u, v, 96, 2, s.seed);
  const float zigzag = std::abs(fract(14 * (u + v)) - 0.5f) + std::abs(fract(14 * (u - v)) - 0.5f);
  if (rim < 0.02f) return tufts * s.colors[1];
  if (rim < 0.1f) return tufts * (zigzag > 0.5f ? s.colors[2] : s.colors[1]);
  if (rim < 0.12f) return tufts * s.colors[2];
  // A calm middle, so that what stands on the rug is seen: one large medallion on a faint lattice.
  const float x = 1.3f * (u - 0.5f), y = v - 0.5f;
  const float radius = std::hypot(x, y) * (1 + 0.06f * std::cos(8 * std::atan2(y, x)));
  const bool heart = radius < 0.12f || (radius > 0.24f && radius < 0.28f);
  if (radius < 0.34f) return tufts * (heart ? mix(s.colors[1], s.colors[2], 0.5f) : s.colors[1]);
  const bool lattice = std::abs(fract(6 * (u + 0.7f * v)) - 0.5f) < 0.06f ||
                       std::abs(fract(6 * (u - 0.7f * v)) - 0.5f) < 0.06f;
  return tufts * (lattice ? mix(s.colors[0], s.colors[2], 0.5f) : s.colors[0]);
}

Vec3f book_spines(const PatternSpec& s, float u, float v) {
  const int book = static_cast<int>(u * 16);
  const auto tone = [&](int k) { return cell_value(book, k, s.seed); };
  const Vec3f base =
      mix(s.colors[static_cast<std::size_t>(3 * tone(0))], Vec3f{1, 1, 1}, 0.25f * tone(1));
  const Vec3f binding = (0.35f + 0.75f * tone(2)) * base;
  const bool band = std::abs(v - 0.12f) < 0.02f || std::abs(v - 0.88f) < 0.02f;
  const bool label =
      v > 0.55f && v < 0.55f + 0.2f * tone(3) && std::abs(fract(16 * u) - 0.5f) < 0.32f;
  return band || label ? mix(binding, Vec3f{0.75f, 0.62f, 0.35f}, 0.8f) : binding;
}

Vec3f landscape(const PatternSpec& s, float u, float v) {
  const float far_hills = 0.52f + 0.16f * fractal_noise(u, 0.3f, 4, 4, s.seed);
  const float near_hills = 0.3f + 0.16f * fractal_noise(u, 0.6f, 3, 5, s.seed + 1);
  const float sun = std::hypot(u - 0.3f - 0.4f * cell_value(0, 0, s.seed), v - 0.8f);
  const float brush = 0.85f + 0.3f * fractal_noise(u, v, 24, 3, s.seed + 2);
  if (v < near_hills) return (brush * (0.5f + v)) * s.colors[1];
  if (v < far_hills) return brush * mix(s.colors[1], s.colors[0], 0.6f);
  if (sun < 0.07f) return {0.95f, 0.85f, 0.55f};
  return brush *
         mix(mix(s.colors[2], Vec3f{1, 1, 1}, 0.4f), s.colors[0], step_between(0.5f, 1.0f, v));
}

// Rectangles with black bars, split at seeded lines.
Vec3f blocks(const PatternSpec& s, float u, float v) {
  const float x = u * 3 + 0.5f * (cell_value(static_cast<int>(v * 3), 7, s.seed) - 0.5f), y = v * 3;
  if (inside_cell(x, 0.09f) < 0.5f || inside_cell(y, 0.09f) < 0.5f) return {0.01f, 0.01f, 0.01f};
  const float tone = cell_value(static_cast<int>(std::floor(x)), static_cast<int>(y), s.seed);
  if (tone > 0.6f) return {0.8f, 0.77f, 0.68f};
  return s.colors[static_cast<std::size_t>(5 * tone)];
}

Vec3f circles(const PatternSpec& s, float u, float v) {
  Vec3f color = mix(s.colors[0], Vec3f{0.85f, 0.82f, 0.75f}, 0.6f);
  for (int i = 0; i < 7; ++i) {
    const float radius = 0.08f + 0.2f * cell_value(i, 0, s.seed);
    const float distance = std::hypot(u - cell_value(i, 1, s.seed), v - cell_value(i, 2, s.seed));
    const bool hollow = cell_value(i, 3, s.seed) < 0.4f && distance < 0.7f * radius;
    if (distance < radius && !hollow) color = s.colors[static_cast<std::size_t>(i % 3)];
  }
  return color;
}

Vec3f waves(const PatternSpec& s, float u, float v) {
  const float bent = v + 0.12f * std::sin(2 * kPi * u + 6 * fractal_noise(u, v, 2, 3, s.seed));
  const auto band = static_cast<int>(std::floor(9 * bent));
  return (0.6f + 0.5f * fract(9 * bent)) * s.colors[static_cast<std::size_t>(wrap(band, 3))];
}

using Painter = Vec3f (*)(const PatternSpec&, float, float);

Painter painter_of(PatternKind kind) {
  switch (kind) {
    case PatternKind::kPlanks:
      return planks;
    case PatternKind::kParquet:
      return parquet;
    case PatternKind::kTiles:
      return tiles;
    case PatternKind::kBricks:
      return bricks;
    case PatternKind::kWallpaper:
      return wallpaper;
    case PatternKind::kCarpet:
      return carpet;
    case PatternKind::kMarble:
      return marble;
    case PatternKind::kWood:
      return wood;
    case PatternKind::kFabric:
      return fabric;
    case PatternKind::kRug:
      return rug;
    case PatternKind::kBookSpines:
      return book_spines;
    case PatternKind::kLandscape:
      return landscape;
    case PatternKind::kBlocks:
      return blocks;
    case PatternKind::kCircles:
      return circles;
    case PatternKind::kWaves:
      return waves;
    case PatternKind::kPlain:
      break;
  }
  return plain;
}

}  // namespace

float cell_value(int x, int y, std::uint64_t seed) {
  // Finaliser of SplitMix64 over the mixed cell index.
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ull * (static_cast<std::uint64_t>(x) + 1) +
                    0xD1B54A32D192ED03ull * (static_cast<std::uint64_t>(y) + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
}

float tile_noise(float u, float v, int period, std::uint64_t seed) {
  const float x = u * static_cast<float>(period), y = v * static_cast<float>(period);
  const float fx = std::floor(x), fy = std::floor(y);
  const int x0 = wrap(static_cast<int>(fx), period), x1 = wrap(x0 + 1, period);
  const int y0 = wrap(static_cast<int>(fy), period), y1 = wrap(y0 + 1, period);
  const float a = step_between(0, 1, x - fx), b = step_between(0, 1, y - fy);
  return mix(
      mix(cell_value(x0, y0, seed), cell_value(x1, y0, seed), a),
      mix(cell_value(x0, y1, seed), cell_value(x1, y1, seed), a),
      b
  );
}

float fractal_noise(float u, float v, int period, int octaves, std::uint64_t seed) {
  float sum = 0, weight = 0.5f, total = 0;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * tile_noise(u, v, period << i, seed + static_cast<std::uint64_t>(i));
    total += weight;
    weight *= 0.5f;
  }
  return sum / total;
}

Image make_pattern(const PatternSpec& spec, int size) {
  const Painter paint = painter_of(spec.kind);
  Image image(size, size, 3);
  const float step = 1 / static_cast<float>(size);
  parallel_for(static_cast<std::size_t>(size), 16, [&](std::size_t row) {
    for (int x = 0; x < size; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) * step,
                  v = (static_cast<float>(row) + 0.5f) * step;
      const Vec3f color = paint(spec, u, v);
      for (int c = 0; c < 3; ++c)
        image.at(x, static_cast<int>(row), c) = std::clamp(color[c], 0.0f, 0.95f);
    }
  });
  return image;
}

Vec3f srgb_hex(std::uint32_t code) {
  const auto channel = [&](unsigned shift) {
    return srgb_decode(static_cast<float>((code >> shift) & 0xFFu) / 255.0f);
  };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace glint

// SPDX-License-Identifier: MIT
// Procedural textures: linear RGB images over the unit square [0, 1)^2, rows along v. Surface
// patterns repeat without a seam in both directions; pictures do not need to. Pure functions of
// their spec.
#pragma once

#include <array>
#include <cstdint>

#include "glint/core/image.h"
#include "glint/core/vec.h"

namespace glint {

// Noise on the torus: smooth in [0, 1], periodic with `period` lattice cells over the unit square.
float tile_noise(float u, float v, int period, std::uint64_t seed);
// Sum of `octaves` noises, each with twice the period and half the weight of the one before; [0,
// 1].
float fractal_noise(float u, float v, int period, int octaves, std::uint64_t seed);
// Uniform in [0, 1) from two integers: the tone of plank (x, y).
float cell_value(int x, int y, std::uint64_t seed);

enum class PatternKind {
  kPlain,       // painted surface, faint mottling
  kPlanks,      // floor boards along u
  kParquet,     // basket weave of strips
  kTiles,       // square tiles in two colours with grout
  kBricks,      // running bond with mortar
  kWallpaper,   // stripes and rosettes
  kCarpet,      // tufts over a soft lattice
  kMarble,      // veined slabs
  kWood,        // furniture wood, grain along v
  kFabric,      // woven cloth with a check
  kRug,         // bordered carpet with medallions, one period is the whole rug
  kBookSpines,  // 16 columns, one binding each
  kLandscape,   // pictures
  kBlocks,
  kCircles,
  kWaves,
};

struct PatternSpec {
  PatternKind kind = PatternKind::kPlain;
  std::array<Vec3f, 3> colors{};  // linear; main, second, accent (mortar, grout, motif)
  float period = 1;               // metres that one period covers on a surface
  std::uint64_t seed = 0;
};

Image make_pattern(const PatternSpec& spec, int size = 512);

// Linear colour of an sRGB hex code such as 0xA0522D.
Vec3f srgb_hex(std::uint32_t code);

}  // namespace glint

// SPDX-License-Identifier: MIT
// In place of the Embree tree: a lean build traces rays on the GPU only.
#include "glint/core/error.h"
#include "glint/render/trace_bvh.h"

namespace glint {

namespace {

[[noreturn]] void fail() {
  throw Error(
      ExitCode::kEnvironment,
      "tracing rays on the CPU needs Embree, which this lean build does without; use --device cuda "
      "or the full build (cmake --preset release)"
  );
}

}  // namespace

std::vector<std::uint32_t> morton_slots(std::span<const float>) { fail(); }

struct SurfelBvh::Impl {};

SurfelBvh::SurfelBvh() = default;
SurfelBvh::~SurfelBvh() = default;
void SurfelBvh::update(const std::vector<TracedSurfel>&, bool, bool) { fail(); }
std::size_t SurfelBvh::nearest(Vec3f, Vec3f, NearestHits&) const { fail(); }
std::span<const SurfelCluster> SurfelBvh::clusters() const { return {}; }

}  // namespace glint

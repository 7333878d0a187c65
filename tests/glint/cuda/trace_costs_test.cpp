// SPDX-License-Identifier: MIT
// What rays cost on the GPU's tracer, counted on the host.
#include <catch2/catch.hpp>

#include "tests/glint/cuda/trace_scenes.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {
constexpr ImageSize kSize{32, 18};
}

TEST_CASE("A ray's counted hits are those it composites, of discs it tested") {
  const RoomScene room(2000);
  const Rays rays = room_rays(kSize);
  const TraceCall call{room.arrays.view(), rays, {}};
  TraceOutput out = empty_output(kSize);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  std::vector<WalkCounts> counts(kSize.num_pixels());
  pipeline.forward(device_call(call, out), counts.data());
  std::size_t hits = 0;
  for (const WalkCounts& c : counts) {
    hits += c.hits;
    CHECK(c.discs >= c.hits);
    CHECK(c.nodes > 0);
    CHECK(c.searches > 0);
  }
  CHECK(hits > kSize.num_pixels());
  CHECK(hits == pipeline.num_hits());
}

TEST_CASE("Surfels that count nowhere cost a ray next to nothing") {
  RoomScene room(2000);
  const Rays rays = room_rays(kSize);
  const MeanCounts before = mean_counts(room.arrays.view(), rays);
  room.add_dead(2000);
  const MeanCounts after = mean_counts(room.arrays.view(), rays);
  CHECK(after.hits == before.hits);
  CHECK(after.nodes < 1.02 * before.nodes);
  CHECK(after.discs < 1.02 * before.discs);
}

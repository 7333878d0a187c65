// SPDX-License-Identifier: MIT
// What a ray of the GPU's tracer costs, counted by its kernels on the host:
//   trace_counters                                        scenes made here
//   trace_counters surfels.ply x y z  x y z [width height]  a trained set; camera and its target
#include <fmt/format.h>

#include <cstdlib>

#include "glint/core/rng.h"
#include "glint/scene/ply.h"
#include "tests/glint/cuda/trace_scenes.h"

using namespace glint;
using namespace glint::test;

namespace {

void print_row(const std::string& name, std::size_t surfels, const MeanCounts& mean) {
  fmt::print(
      "| {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} |\n",
      name,
      surfels,
      mean.nodes,
      mean.discs,
      mean.hits,
      mean.searches
  );
  std::fflush(stdout);
}
void print_head() {
  fmt::print(
      "| scene | surfels | nodes | discs | hits | searches |\n|---|---:|---:|---:|---:|---:|\n"
  );
}

void count_made_scenes() {
  constexpr ImageSize kSize{120, 68};
  const Rays camera = room_rays(kSize), scattered = scattered_rays(kSize);
  const auto row = [&](const std::string& name, const RoomScene& scene) {
    const TraceInput input = scene.arrays.view();
    print_row(name + ", camera", input.count, mean_counts(input, camera));
    print_row(name + ", scattered", input.count, mean_counts(input, scattered));
  };
  RoomScene scene(50'000);
  row("room", scene);
  RoomScene large = scene;
  large.add_large(300);
  row("+ large surfels", large);
  RoomScene outlier = scene;
  outlier.add_outlier();
  row("+ one at 1000 m", outlier);
  RoomScene dead = scene;
  dead.add_dead(20'000);
  row("+ dead surfels", dead);
}

void count_trained(int argc, char** argv) {
  const SurfelCloud cloud = read_surfel_ply(argv[1]);
  const auto number = [&](int i) { return std::atof(argv[i]); };
  const ImageSize size =
      argc > 9 ? ImageSize{std::atoi(argv[8]), std::atoi(argv[9])} : ImageSize{120, 68};
  Rays rays;
  camera_rays(
      look_at(
          {number(2), number(3), number(4)}, {number(5), number(6), number(7)}, {0, 0, 1}, size, 70
      ),
      rays
  );
  ActivatedSurfels activated;
  activate_geometry(cloud, activated);
  const TraceInput input = trace_input(cloud, activated, 3);
  print_row(argv[1], input.count, mean_counts(input, rays));
}

}  // namespace

int main(int argc, char** argv) {
  print_head();
  if (argc < 8)
    count_made_scenes();
  else
    count_trained(argc, argv);
}

// SPDX-License-Identifier: MIT
// Gaussians of other programs, with and without a channel that is asked for.
#include <cmath>

#include "glint/scene/gaussian_ply.h"
#include "glint/scene/ply.h"
#include "tests/fuzz/fuzz_target.h"

namespace glint::fuzz {
namespace {

void check_surfels(const GaussianPly& read, std::size_t channels) {
  const SurfelCloud& cloud = read.cloud;
  if (cloud.num_extra() != channels) throw Finding("channels that nobody asked for");
  for (const float q : cloud.rotations)
    if (!std::isfinite(q)) throw Finding("a rotation that is not finite");
  for (const float scale : cloud.log_scales)
    if (!std::isfinite(scale)) throw Finding("a scale that is not finite");
}

bool read(std::string_view bytes) {
  const fs::path file = input_file(bytes, "input.ply"), again = input_folder() / "again.ply";
  accepts([&] {
    std::vector<std::string> ignored;
    check_surfels(read_gaussian_ply(file, {"transparency"}, ignored), 1);
  });
  return accepts([&] {
    std::vector<std::string> ignored;
    const GaussianPly found = read_gaussian_ply(file, {}, ignored);
    check_surfels(found, 0);
    write_surfel_ply(again, found.cloud);
    if (read_surfel_ply(again).size() != found.cloud.size())
      throw Finding("surfels that are others when they are written again");
  });
}

// Two Gaussians of degree 0 with these scales and further fields, as text.
std::string text_ply(const std::string& fields, const std::string& values) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 2\n";
  for (const char* name :
       {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "rot_0", "rot_1", "rot_2", "rot_3"})
    text += fmt::format("property float {}\n", name);
  text += fields + "end_header\n";
  for (const char* place : {"0 0 2", "0.5 0 2"})
    text += fmt::format("{} 0.1 0.2 0.3 1 1 0 0 0 {}\n", place, values);
  return text;
}

std::vector<FuzzInput> seeds() {
  const std::string two = "property float scale_0\nproperty float scale_1\n";
  std::string ellipsoids = text_ply(two + "property float scale_2\n", "-3 -9 -4");
  ellipsoids.replace(ellipsoids.rfind("-4"), 2, "-5");
  return {
      {"surfels", text_ply(two, "-3 -4")},
      {"ellipsoids", ellipsoids},
      {"official", text_ply(two + "property float transmission_coeff\n", "-3 -4 0.5")}};
}

}  // namespace

GLINT_REGISTER(FuzzTarget, {"gaussian_ply", read, seeds})

}  // namespace glint::fuzz

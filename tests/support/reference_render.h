// SPDX-License-Identifier: MIT
// An independent renderer to check rasterize() against: double precision, every surfel at every
// pixel, no tiles, boxes or culling. It intersects world-space rays with the surfels' planes
// instead of using the projected matrix of [Huang24], and shares no code with glint/render but the
// contract in rasterize.h. Differentiate it by central differences (gradcheck.h).
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include "glint/render/rasterize.h"

namespace glint::test {

// RasterInput in double precision, owned. Shapes as there.
struct ReferenceInput {
  std::size_t count = 0;
  int channels = 0;
  std::vector<double> means, scales, rotations, opacities, features;
  ImageView near_limit;
};
ReferenceInput reference_input(const RasterInput& input);

// A surfel as the camera sees it.
struct ReferenceSurfel {
  std::size_t index = 0;               // in the input
  Vec3d mean, axis_u, axis_v, normal;  // world; unit axes, normal = u x v
  double scale_u = 0, scale_v = 0;
  double opacity = 0;
  double center_depth = 0;            // camera z of the mean
  Vec3d normal_in_cam;                // flipped towards the camera
  double plane_distance = 0;          // of the camera centre from the plane
  bool has_low_pass = false;          // the 3-sigma ellipse lies in front of the camera plane
  Vec2d box_center, box_half_extent;  // of that ellipse on the image, pixels; if has_low_pass
  double camera_plane_margin = 0;     // 1 - (z extent / center depth)^2: sign decides has_low_pass
};
ReferenceSurfel reference_surfel(
    const ReferenceInput& input, std::size_t index, const Camera& camera
);

// Where the ray through image point `point` (pixels) meets a surfel.
struct ReferenceHit {
  double u = 0, v = 0;  // sigmas; infinite for a parallel plane
  double t = 0;         // camera depth of the intersection
  double rho3 = std::numeric_limits<double>::infinity();
  double rho2 = std::numeric_limits<double>::infinity();
  bool low_pass() const { return rho2 < rho3; }
};
ReferenceHit reference_hit(const ReferenceSurfel& surfel, const Camera& camera, Vec2d point);

// How far a pixel is from changing its value by jumping, as relative distances: 0 at the jump. A
// float implementation may fall on the other side of a cut-off that is nearer than its rounding.
struct Cutoffs {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  double accept = kNone;  // a surfel starts or stops to count: rho 9, alpha 1/255, near, limit
  double branch = kNone;  // rho2 against rho3: depth jumps, the alpha has a kink
  double transmittance = kNone;  // 1e-4: the last contributor
  double order = kNone;          // two successive contributors change places
  double median = kNone;         // transmittance 0.5: depth_median only
  double clamp = kNone;          // alpha 0.99: a kink, matters to gradients only
  // What a jump of any map but the median, or of the median, is away.
  double nearest_jump() const;
  double nearest_jump_or_median() const;
  double nearest_of_all() const;  // also kinks
};

struct ReferencePixel {
  std::vector<double> features;
  double alpha = 0, depth_sum = 0, depth_median = 0, distortion = 0, plane_distance = 0;
  Vec3d normal;
  std::vector<std::pair<std::size_t, double>> weights;  // (surfel, w), front to back
  std::vector<double> depths;                           // z of each of them
  std::vector<std::size_t> owners;                      // surfels that count while T > 0.5
  Cutoffs cutoffs;
};

// A surfel's footprint moved over the screen: its alpha at a pixel is what it was `by` pixels
// before; depth and normal stay.
struct FootprintShift {
  std::size_t surfel = static_cast<std::size_t>(-1);
  Vec2d by{0, 0};
};

// The surfels of one input seen by one camera, ready to be asked for pixels.
class ReferenceRenderer {
 public:
  ReferenceRenderer(
      const ReferenceInput& input, const Camera& camera, const RasterSettings& settings
  );
  ReferencePixel pixel(int x, int y, const FootprintShift& shift = {}) const;

 private:
  struct Contribution;
  bool contribution(
      const ReferenceSurfel& surfel, int x, int y, Vec2d shift, Contribution& out, Cutoffs& c
  ) const;

  ReferenceInput input_;
  Camera camera_;
  RasterSettings settings_;
  std::vector<ReferenceSurfel> surfels_;  // by centre depth, ties by index
};

struct ReferenceOutput {
  int width = 0, height = 0;
  std::vector<ReferencePixel> pixels;  // [H][W]
  std::vector<double> visibility;      // [N]
  std::vector<double> owned_pixels;    // [N]
  const ReferencePixel& at(int x, int y) const {
    return pixels
        [static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x)];
  }
};
ReferenceOutput reference_render(
    const ReferenceInput& input, const Camera& camera, const RasterSettings& settings
);

// sum over maps of dL_doutput . output of pixel i.
double reference_loss(const ReferencePixel& pixel, std::size_t i, const RasterOutputGradient& g);
// sum over maps and pixels of dL_doutput . output: the scalar whose gradient backward() returns.
double reference_loss(const ReferenceOutput& output, const RasterOutputGradient& dL_doutput);

}  // namespace glint::test

// SPDX-License-Identifier: MIT
// A set of 2D Gaussians ("surfels"), structure of arrays, raw (pre-activation) parameters.
// Activations: scale = exp(log_scale), opacity = sigmoid(opacity_logit), rotation = q / |q|,
// extra channels (transparency, specularity) = sigmoid(logit), or what their set says of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "glint/core/arrays.h"
#include "glint/core/vec.h"

namespace glint {

inline constexpr int kShCoefficients = 16;  // degree 3
// 1 / (2 sqrt(pi)), the constant basis function: what a surfel's sh_dc is multiplied by.
inline constexpr float kSh0 = 0.28209479177387814f;

// From a raw value x of an extra channel to what is rendered.
enum class Activation : std::uint8_t {
  kSigmoid,   // 1 / (1 + e^-x)
  kTanh,      // tanh x
  kCappedExp  // e^min(x, 5) / 5: albedo [Ref-GS]
};

// The raw value of a sigmoid.
GLINT_HD float logit(float probability) { return logf(probability / (1.0f - probability)); }

// One parameter array of a cloud: `width` floats a surfel.
struct SurfelCloud {
  FloatArray means;                           // [N][3] metres, world
  FloatArray log_scales;                      // [N][2]
  FloatArray rotations;                       // [N][4] quaternion w x y z, not normalised
  FloatArray opacity_logits;                  // [N][1]
  FloatArray sh_dc;                           // [N][3] coefficient 0 of R, G, B
  FloatArray sh_rest;                         // [N][15][3] coefficients 1..15, colour fastest
  FloatArray extra_logits;                    // [N][extra_names.size()]
  std::vector<std::string> extra_names;       // e.g. "transparency", "specular"
  std::vector<Activation> extra_activations;  // of each; empty: all sigmoid. Not in files

  std::size_t size() const { return opacity_logits.size(); }
  std::size_t num_extra() const { return extra_names.size(); }
  void resize(std::size_t count);  // new rows are zero

  // Calls f(name, array, width) for every parameter array, always in the same order: the one list
  // that optimiser, densification, files and tests walk over.
  template <class F>
  void for_each_array(F&& f) {
    for_each(*this, f);
  }
  template <class F>
  void for_each_array(F&& f) const {
    for_each(*this, f);
  }

 private:
  template <class Self, class F>
  static void for_each(Self& self, F& f) {
    f("means", self.means, std::size_t{3});
    f("log_scales", self.log_scales, std::size_t{2});
    f("rotations", self.rotations, std::size_t{4});
    f("opacity_logits", self.opacity_logits, std::size_t{1});
    f("sh_dc", self.sh_dc, std::size_t{3});
    f("sh_rest", self.sh_rest, std::size_t{45});
    f("extra_logits", self.extra_logits, self.extra_names.size());
  }
};

// Coloured points as structure from motion gives them.
struct PointCloud {
  std::vector<Vec3f> positions;  // metres, world
  std::vector<Vec3f> colors;     // [0, 1]; same length as positions
  std::vector<Vec3f> normals;    // unit, or empty
};

// A channel that a set has beside its colour, in (0, 1) unless it has another activation.
struct ExtraChannel {
  std::string name;
  float initial;  // activated
  float rate;     // learning rate of its logit
  Activation activation = Activation::kSigmoid;
  float spread = 0;  // standard deviation of the initial raw values around `initial`'s
};

struct InitialSurfels {
  float opacity = 0.1f;
  float scale = 1;  // of the distance to neighbours
  std::vector<ExtraChannel> extra;
  std::uint64_t seed = 0;  // random rotations
};

// Surfels at the points: isotropic scale = root mean squared distance to the 3 nearest neighbours
// times `scale`, random rotation, SH degree 0 from the colour. Errors (kBadReference): fewer than 4
// points.
SurfelCloud surfels_from_points(const PointCloud& points, const InitialSurfels& options);

// Gives a cloud that was read from a file the activations of these channels. Errors
// (kBadPrediction, naming the file): it has other channels.
void set_activations(
    const std::vector<ExtraChannel>& extra, const std::string& file, SurfelCloud& cloud
);

// Root mean squared distance of each point to its 3 nearest neighbours, floor 1e-4 (metres).
std::vector<float> neighbor_distances(std::span<const Vec3f> points);

}  // namespace glint
